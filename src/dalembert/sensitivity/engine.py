"""Gradient engines, one for each kind of result; ``registry`` lists them by analysis.

A new analysis needs an engine with ``direct`` and ``adjoint``, and a row in the registry. Labels,
units, certificates and the command line follow from these.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.sensitivity.samples import Sample


class Engine:
    """Gradients of sampled responses of one result with respect to its parameters.

    Parameters
    ----------
    samples : responses of the same result
    """

    def __init__(self, samples: Sequence[Sample]):
        self.samples = list(samples)

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        """(responses, columns) derivatives by one tangent solution per parameter."""
        raise NotImplementedError

    def adjoint(self) -> np.ndarray:
        """(responses, np) gradients by one adjoint solution per response."""
        raise NotImplementedError

    def of_samples(self, columns: Sequence[int]) -> list[np.ndarray]:
        """(K, columns) derivatives ``∂m_k/∂p`` of the samples themselves, for each response."""
        derivatives = []
        for sample in self.samples:
            unit = np.eye(sample.weights.size)
            single = [replace(sample, weights=row) for row in unit]
            rows = type(self)(single).direct(columns)
            derivatives.append(rows.reshape(len(single), len(columns)))
        return derivatives

    def parameter_gradients(self, rows: Sequence[np.ndarray]) -> np.ndarray:
        """(responses, np) gradients from derivatives (n,) by the full parameter vector."""
        motion = self.samples[0].motion
        return motion.model.parameter_gradients(motion.parameters, np.array(rows))

    def hessian_product(self, direction: np.ndarray) -> np.ndarray:
        """(responses, np) change of the adjoint gradient along a direction of the parameters.

        Raises
        ------
        UnsupportedError
            Second derivatives of this analysis are not available.
        """
        kind = type(self.samples[0].motion.analysis).__name__
        raise UnsupportedError(
            f"second derivatives of {kind} are not available; take differences of gradients"
        )

    def rate(self, sample: Sample, k: int = -1) -> float:
        """``ṁ`` of the measure of a sample along the motion, at its ``k``-th instant."""
        raise NotImplementedError


class CombinedEngine(Engine):
    """Linear combinations of responses.

    Parameters
    ----------
    engine : engine of the terms
    combine : (responses, terms) weights
    """

    def __init__(self, engine: Engine, combine: np.ndarray):
        super().__init__(engine.samples)
        self.engine, self.combine = engine, combine

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        return np.asarray(self.combine @ self.engine.direct(columns))

    def adjoint(self) -> np.ndarray:
        return np.asarray(self.combine @ self.engine.adjoint())

    def hessian_product(self, direction: np.ndarray) -> np.ndarray:
        return np.asarray(self.combine @ self.engine.hessian_product(direction))


class RowEngine(Engine):
    """Engine that handles each response by an object with ``direct(columns)`` and ``adjoint()``.

    The class ``row`` is constructed from a sample and a dictionary for results shared by all rows.
    """

    row: ClassVar[type]

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        return np.array([row.direct(columns) for row in self._rows()])

    def adjoint(self) -> np.ndarray:
        return self.parameter_gradients([row.adjoint() for row in self._rows()])

    def _rows(self) -> list[Any]:
        shared: dict = {}
        return [self.row(sample, shared) for sample in self.samples]
