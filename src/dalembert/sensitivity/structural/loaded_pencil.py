"""Derivatives of the matrices of an eigenvalue problem, including preloaded states."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from dalembert.analysis.structural.pencil import Loaded, Pencil, Term
from dalembert.sensitivity.structural.statics import StaticsTangent
from dalembert.structures.measuring.measures import Weights


class PencilTangent:
    """Derivatives of ``A`` and ``B`` by the parameters.

    Parameters
    ----------
    pencil : Pencil
    """

    def __init__(self, pencil: Pencil):
        self.pencil, self.along = pencil, cache(self._along)
        terms = (*pencil.left, *pencil.right)
        self.parameter_count = terms[0].state.p.size
        loaded = {id(t.state): t.state for t in terms if t.state.result is not None}
        self.statics = {
            key: StaticsTangent(state.result)  # type: ignore[arg-type]
            for key, state in loaded.items()
        }

    def pull(self, a: np.ndarray, b: np.ndarray, phi: np.ndarray) -> np.ndarray:
        """(np,) weights of the parameters in ``Σ_k aₖᵀ A φₖ + bₖᵀ B φₖ``, all arrays (n, m)."""
        gradient = np.zeros(self.parameter_count)
        displacements = {key: np.zeros(phi.shape[0]) for key in self.statics}
        for terms, columns in ((self.pencil.left, a), (self.pencil.right, b)):
            for term in terms:
                for weight, shape in zip(columns.T, phi.T, strict=True):
                    u_bar, p_bar = term.pull(weight, shape)
                    gradient += p_bar
                    if id(term.state) in displacements:
                        displacements[id(term.state)] += u_bar
        for key, u_bar in displacements.items():
            weights = Weights(u_bar, np.zeros_like(u_bar), np.zeros(gradient.size))
            gradient += self.statics[key].pull(0, [weights])[:, 0]
        return gradient

    def _along(self, column: int) -> PencilChange:
        """Change along one parameter, by its number."""
        dp = np.eye(1, self.parameter_count, column).ravel()
        displacements = {key: statics.push(0, dp)[0] for key, statics in self.statics.items()}
        return PencilChange(self.pencil, dp, displacements)


@dataclass(frozen=True)
class PencilChange:
    """Changes of ``A`` and ``B`` along a direction of the parameters.

    Attributes
    ----------
    dp : (np,) the direction
    displacements : state → (n,) change of its displacements
    """

    pencil: Pencil
    dp: np.ndarray
    displacements: dict[int, np.ndarray]

    def of(self, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """``dA Φ`` and ``dB Φ`` for shapes (n, m)."""
        return self._sum(self.pencil.left, phi), self._sum(self.pencil.right, phi)

    def _sum(self, terms, phi: np.ndarray) -> np.ndarray:
        columns = np.zeros_like(phi)
        for term in terms:
            du = self._displacement(term)
            for k, shape in enumerate(phi.T):
                columns[:, k] += term.push(shape, du, self.dp)
        return columns

    def _displacement(self, term: Term) -> np.ndarray:
        state: Loaded = term.state
        return self.displacements.get(id(state), np.zeros(len(state.model.degrees)))
