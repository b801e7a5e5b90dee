"""Gradients of statics, linear or not, with the factors of the analysis (8.25–8.35)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, cast

import numpy as np

from dalembert.results.structural.result import StructuralResult
from dalembert.sensitivity.engine import RowEngine
from dalembert.sensitivity.samples import Sample
from dalembert.structures.measures import Weights


class StaticsTangent:
    """How a result of statics follows the parameters, and what weights of it weigh them."""

    def __init__(self, result: StructuralResult):
        self.result = result
        self.model, self.p = result.model, result.parameters
        self.assembly = self.model.assembly
        self.free, self.held = self.assembly.free, self.assembly.prescribed

    def share(self, case: int) -> float:
        """Part of loads and prescribed displacements that acts."""
        return 1.0

    def stiffness(self, case: int) -> Any:
        """Stiffness of all displacements at the solution."""
        return self.result.record[case].stiffness

    def moved(self, case: int, rest: np.ndarray) -> tuple[np.ndarray, float]:
        """Change (n,) of the displacements that balances a force (n,), and of the load factor."""
        found = np.zeros_like(rest)
        if self.free.size:
            found[self.free] = self.result.record[case].factor.solve(rest[self.free])
        return found, 0.0

    def multiplier(self, case: int, u_bar: np.ndarray, factor_bar: float) -> np.ndarray:
        """(n,) ``K_ff⁻ᵀ`` of weights of the displacements; K is symmetric."""
        return self.moved(case, u_bar)[0]

    def pulled(self, case: int, seen: Weights) -> np.ndarray:
        """(np,) weights of the parameters, all in all."""
        loads, stiffness, share = self._loads(case), self.stiffness(case), self.share(case)
        reactions, applied = np.zeros_like(seen.forces), np.zeros_like(seen.forces)
        reactions[self.held] = seen.forces[self.held]
        applied[self.free] = seen.forces[self.free]
        applied -= reactions  # what acts on a support itself, its reaction does not see
        u_bar = seen.u + stiffness @ reactions
        factor_bar = seen.load_factor + applied @ loads.values(self.p)
        factor_bar += u_bar[self.held] @ self.model.prescribed.values(self.p)
        multiplier = self.multiplier(case, u_bar, factor_bar)
        u_bar = u_bar - stiffness @ multiplier  # free entries vanish: equilibrium takes care
        u = self.result.displacements[:, case]
        return (
            seen.p
            + self.assembly.pull(u, self.p, reactions - multiplier)
            + share * loads.pull(self.p, applied + multiplier)
            + share * self.model.prescribed.pull(self.p, u_bar[self.held])
        )

    def pushed(self, case: int, dp: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        """Changes of displacements, forces and load factor by ``D_i P − D_i K U``."""
        u, stiffness = self.result.displacements[:, case], self.stiffness(case)
        share, loads = self.share(case), self._loads(case)
        held = np.zeros_like(u)
        held[self.held] = share * self.model.prescribed.push(self.p, dp)
        applied = share * loads.push(self.p, dp)
        internal = self.assembly.push(u, self.p, dp)
        moved, dfactor = self.moved(case, applied - internal - stiffness @ held)
        du = held + moved
        forces = applied + (dfactor * loads.values(self.p) if dfactor else 0.0)
        forces[self.held] = (internal + stiffness @ du - forces)[self.held]
        return du, forces, dfactor

    def _loads(self, case: int):
        return self.model.loads[self.result.cases[case]]


class StaticsGradient(StaticsTangent):
    """Rows of the gradient for one sampled response.

    With the tangent stiffness ``K`` at the solution, and weights of displacements, forces and
    parameters that the response sees, ``dΘ = ūᵀ dU + ωᵀ dP + p̄ᵀ dp``.
    """

    def __init__(self, sample: Sample, shared: dict | None = None):
        super().__init__(cast(StructuralResult, sample.motion))
        self.sample = sample
        self._changes = {} if shared is None else shared

    def _cases(self) -> Iterator[tuple[int, float, Weights]]:
        """Number, weight of the sample, and what the measure weighs there."""
        for k in np.flatnonzero(self.sample.weights):
            seen = self.result.weights(self.sample.measure.sx, int(k))
            yield int(k), float(self.sample.weights[k]), seen

    def adjoint(self) -> np.ndarray:
        """(np,) gradient by one solve per response and load case (8.27)."""
        gradient = np.zeros(self.p.size)
        for k, weight, seen in self._cases():
            gradient += weight * self.pulled(k, seen)
        return gradient

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        """(columns,) derivatives by one back-substitution per parameter and load case (8.26)."""
        gradient = np.zeros(len(columns))
        for k, weight, seen in self._cases():
            state = self.result.cases[k], self.result.displacements[:, k].tobytes()
            for i, column in enumerate(columns):
                du, dforces, dfactor = self._change(k, column, state)
                change = seen.u @ du + seen.forces @ dforces + seen.load_factor * dfactor
                gradient[i] += weight * (change + seen.p[column])
        return gradient

    def _change(self, case: int, column: int, state: tuple) -> tuple:
        """``pushed`` by one parameter, once for all responses that look at this state."""
        key = (*state, column)
        if key not in self._changes:
            direction = np.zeros(self.p.size)
            direction[column] = 1.0
            self._changes[key] = self.pushed(case, direction)
        return self._changes[key]


class StaticsEngine(RowEngine):
    """All rows with the factors of the analysis."""

    row = StaticsGradient
