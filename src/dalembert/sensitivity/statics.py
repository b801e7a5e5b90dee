"""Gradients of statics, linear or not, with the factors of the analysis (8.25–8.35)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import cast

import numpy as np

from dalembert.results.structural import StructuralResult
from dalembert.sensitivity.engine import Engine
from dalembert.sensitivity.samples import Sample
from dalembert.structures.measures import Weights


class StaticsGradient:
    """Rows of the gradient for one sampled response.

    With the tangent stiffness ``K`` at the solution, and weights of displacements, forces and
    parameters that the response sees, ``dΘ = ūᵀ dU + ωᵀ dP + p̄ᵀ dp``.
    """

    def __init__(self, sample: Sample):
        self.sample = sample
        self.result = cast(StructuralResult, sample.motion)
        self.model, self.p = self.result.model, self.result.parameters
        self.assembly = self.model.assembly
        self.free, self.held = self.assembly.free, self.assembly.prescribed

    def _cases(self) -> Iterator[tuple[int, float, Weights]]:
        """Number, weight of the sample, and what the measure weighs there."""
        for k in np.flatnonzero(self.sample.weights):
            seen = self.result.weights(self.sample.measure.sx, int(k))
            yield int(k), float(self.sample.weights[k]), seen

    def _solved(self, case: int, rhs: np.ndarray) -> np.ndarray:
        """``K_ff⁻¹`` on the free displacements; K is symmetric, so its transpose too."""
        found = np.zeros_like(rhs)
        if self.free.size:
            found[self.free] = self.result.record[case].factor.solve(rhs[self.free])
        return found

    def adjoint(self) -> np.ndarray:
        """(np,) gradient by one solve per response and load case (8.27)."""
        gradient = np.zeros(self.p.size)
        for k, weight, seen in self._cases():
            gradient += weight * self._pulled(k, seen)
        return gradient

    def _pulled(self, case: int, seen: Weights) -> np.ndarray:
        loads, stiffness = self._loads(case), self.result.record[case].stiffness
        reactions, applied = np.zeros_like(seen.forces), np.zeros_like(seen.forces)
        reactions[self.held] = seen.forces[self.held]
        applied[self.free] = seen.forces[self.free]
        u_bar = seen.u + stiffness @ reactions
        multiplier = self._solved(case, u_bar)
        u_bar = u_bar - stiffness @ multiplier  # free entries vanish: equilibrium takes care
        forces = reactions - multiplier
        u = self.result.displacements[:, case]
        return (
            seen.p
            + self.assembly.pull(u, self.p, forces)
            + loads.pull(self.p, applied + multiplier)
            + self.model.prescribed.pull(self.p, u_bar[self.held])
        )

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        """(columns,) derivatives by one back-substitution per parameter and load case (8.26)."""
        gradient = np.zeros(len(columns))
        for k, weight, seen in self._cases():
            for i, column in enumerate(columns):
                direction = np.zeros(self.p.size)
                direction[column] = 1.0
                du, dforces = self._pushed(k, direction)
                change = seen.u @ du + seen.forces @ dforces + seen.p[column]
                gradient[i] += weight * change
        return gradient

    def _pushed(self, case: int, dp: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Changes of displacements and forces: the pseudo load is ``D_i P − D_i K U``."""
        u, stiffness = self.result.displacements[:, case], self.result.record[case].stiffness
        held = np.zeros_like(u)
        held[self.held] = self.model.prescribed.push(self.p, dp)
        applied = self._loads(case).push(self.p, dp)
        internal = self.assembly.push(u, self.p, dp)
        du = held + self._solved(case, applied - internal - stiffness @ held)
        forces = applied.copy()
        forces[self.held] = (internal + stiffness @ du)[self.held]
        return du, forces

    def _loads(self, case: int):
        return self.model.loads[self.result.cases[case]]


class StaticsEngine(Engine):
    """One row after the other, all with the factors of the analysis."""

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        return np.array([StaticsGradient(sample).direct(columns) for sample in self.samples])

    def adjoint(self) -> np.ndarray:
        return np.array([StaticsGradient(sample).adjoint() for sample in self.samples])
