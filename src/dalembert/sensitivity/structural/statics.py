"""Gradients of statics, linear or not, with the factors of the analysis (8.25–8.35)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from dalembert.results.structural.result import StructuralResult
from dalembert.sensitivity.engine import RowEngine
from dalembert.sensitivity.samples import Sample
from dalembert.structures.evaluation.columns import Pulls
from dalembert.structures.measuring.measures import Weights

ENTRIES = 4_000_000
"""Numbers of elements, times responses, that are gathered at once."""


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

    def multiplier(self, case: int, u_bar: np.ndarray, factor_bar: np.ndarray) -> np.ndarray:
        """(n, rows) ``K_ff⁻ᵀ`` of weights of the displacements."""
        found, factor = np.zeros_like(u_bar), self.result.record[case].factor
        if self.free.size:
            found[self.free] = factor.solve(np.ascontiguousarray(u_bar[self.free]), "T")
        return found

    def pulled(self, case: int, seen: Sequence[Weights]) -> np.ndarray:
        """(np, rows) weights of the parameters, all in all, for many responses by one solution."""
        loads, stiffness, share = self._loads(case), self.stiffness(case), self.share(case)
        seen_u, forces, p_bar = (
            np.stack([getattr(one, name) for one in seen], axis=1) for name in ("u", "forces", "p")
        )
        reactions, applied = self.split(forces)
        u_bar = seen_u + stiffness.T @ reactions
        u, hot = self.result.displacements[:, case], loads.configuration
        factor_bar = np.array([one.load_factor for one in seen]) + applied.T @ loads.values(self.p)
        factor_bar += u_bar[self.held].T @ self.model.prescribed.values(self.p)
        factor_bar += reactions.T @ hot.forces(u, self.p)
        multiplier = self.multiplier(case, u_bar, factor_bar)
        u_bar = u_bar - stiffness.T @ multiplier  # free entries vanish: equilibrium takes care
        internal, heated = (Pulls(a, self.p, len(seen)) for a in (self.assembly, hot.assembly))
        held_by = (reactions - multiplier)[:, None, :]
        internal.forces(u[:, None], held_by)
        heated.forces(hot.configuration(u)[:, None], share * held_by)
        prescribed = self.model.prescribed
        given = [
            loads.pull(self.p, one) + prescribed.pull(self.p, held)
            for one, held in zip((applied + multiplier).T, u_bar[self.held].T, strict=True)
        ]
        return p_bar + internal.total + heated.total + share * np.stack(given, axis=1)

    def pushed(self, case: int, dp: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        """Changes of displacements, forces and load factor by ``D_i P − D_i K U``."""
        u, stiffness = self.result.displacements[:, case], self.stiffness(case)
        share, loads = self.share(case), self._loads(case)
        held = np.zeros_like(u)
        held[self.held] = share * self.model.prescribed.push(self.p, dp)
        applied = share * loads.push(self.p, dp)
        hot = loads.configuration
        internal = self.assembly.push(u, self.p, dp) + share * hot.push(u, self.p, dp)
        moved, dfactor = self.moved(case, applied - internal - stiffness @ held)
        du = held + moved
        forces = applied
        if dfactor:
            forces = forces + dfactor * loads.values(self.p)
            internal += dfactor * hot.forces(u, self.p)
        forces[self.held] = (internal + stiffness @ du - forces)[self.held]
        return du, forces, dfactor

    def split(self, forces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of forces: those of reactions, and those of applied ones."""
        reactions, applied = np.zeros_like(forces), np.zeros_like(forces)
        reactions[self.held], applied[self.free] = forces[self.held], forces[self.free]
        return reactions, applied - reactions  # what acts on a support, its reaction does not see

    def _loads(self, case: int):
        return self.model.loads[self.result.cases[case]]


class StaticsGradient(StaticsTangent):
    """Rows of the gradient for one sampled response.

    With the tangent stiffness ``K`` at the solution, and weights of displacements, forces and
    parameters that the response sees, ``dΘ = ūᵀ dU + ωᵀ dP + p̄ᵀ dp``.
    """

    def __init__(self, sample: Sample, shared: dict | None = None):
        super().__init__(sample.motion)
        self.sample = sample
        self._changes = {} if shared is None else shared

    def cases(self) -> Iterator[tuple[int, float, Weights]]:
        """Number, weight of the sample, and what the measure weighs there."""
        for k in np.flatnonzero(self.sample.weights):
            seen = self.result.weights(self.sample.measure.sx, int(k))
            yield int(k), float(self.sample.weights[k]), seen

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        """(columns,) derivatives by one back-substitution per parameter and load case (8.26)."""
        gradient = np.zeros(len(columns))
        for k, weight, seen in self.cases():
            state = self.state(k)
            for i, column in enumerate(columns):
                du, dforces, dfactor = self._change(k, column, state)
                change = seen.u @ du + seen.forces @ dforces + seen.load_factor * dfactor
                gradient[i] += weight * (change + seen.p[column])
        return gradient

    def state(self, case: int) -> tuple:
        """What tells a state from others."""
        return self.result.cases[case], self.result.displacements[:, case].tobytes()

    def _change(self, case: int, column: int, state: tuple) -> tuple:
        """``pushed`` by one parameter, once for all responses that look at this state."""
        key = (*state, column)
        if key not in self._changes:
            direction = np.zeros(self.p.size)
            direction[column] = 1.0
            self._changes[key] = self.pushed(case, direction)
        return self._changes[key]


class StaticsEngine(RowEngine):
    """All rows with the factors of the analysis; one solution for all of a state (8.27)."""

    row = StaticsGradient

    def adjoint(self) -> np.ndarray:
        rows: list[StaticsGradient] = self._rows()
        found = np.zeros((len(rows), rows[0].p.size))
        looks: dict[tuple, list[tuple[int, int, float, Weights]]] = {}
        for r, row in enumerate(rows):
            for k, weight, seen in row.cases():
                looks.setdefault(row.state(k), []).append((r, k, weight, seen))
        entries = sum(b.degrees.size for b in rows[0].assembly.blocks)
        most = max(1, ENTRIES // max(entries, 1))
        for several in looks.values():
            for begin in range(0, len(several), most):
                part = several[begin : begin + most]
                numbers, cases, weights, all_seen = zip(*part, strict=True)
                pulled = rows[numbers[0]].pulled(cases[0], all_seen).T
                np.add.at(found, list(numbers), np.array(weights)[:, None] * pulled)
        return found
