"""Weighted sum of quantities."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.design.quantity import CaseResponse, Quantity


class Weighted(Quantity):
    """``Σ w_k q_k``.

    Parameters
    ----------
    parts : quantities
    weights : one for each part
    label : name
    """

    def __init__(
        self, parts: Sequence[Quantity], weights: Sequence[float] | np.ndarray, label: str
    ):
        self.parts, self.weights, self.label = list(parts), np.asarray(weights), label

    @property
    def terms(self) -> list[CaseResponse]:
        return [term for part in self.parts for term in part.terms]

    def varying(self, names: Sequence[str]) -> Weighted:
        return Weighted([part.varying(names) for part in self.parts], self.weights, self.label)

    def _split(self, values: np.ndarray) -> list[np.ndarray]:
        return np.split(values, np.cumsum([len(part.terms) for part in self.parts])[:-1])

    def value(self, values: np.ndarray) -> float:
        split = zip(self.weights, self.parts, self._split(values), strict=True)
        return float(sum(w * part.value(v) for w, part, v in split))

    def slope(self, values: np.ndarray) -> np.ndarray:
        split = zip(self.weights, self.parts, self._split(values), strict=True)
        return np.concatenate([w * part.slope(v) for w, part, v in split])
