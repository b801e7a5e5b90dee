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

MAX_ENTRIES = 4_000_000
"""Upper limit of gathered element entries, times responses."""


class StaticsTangent:
    """Tangent and adjoint of a result of statics by the parameters."""

    def __init__(self, result: StructuralResult):
        self.result = result
        self.model, self.p = result.model, result.parameters
        self.assembly = self.model.assembly
        self.free, self.held = self.assembly.free, self.assembly.prescribed

    def share(self, case: int) -> float:
        """Acting fraction of loads and prescribed displacements [-]."""
        return 1.0

    def stiffness(self, case: int) -> Any:
        """Stiffness of all displacements at the solution."""
        return self.result.record[case].stiffness

    def response(self, case: int, forces: np.ndarray) -> tuple[np.ndarray, float]:
        """Change (n,) of the displacements that balances forces (n,), and of the load factor."""
        du = np.zeros_like(forces)
        if self.free.size:
            du[self.free] = self.result.record[case].factor.solve(forces[self.free])
        return du, 0.0

    def multiplier(self, case: int, u_bar: np.ndarray, factor_bar: np.ndarray) -> np.ndarray:
        """(n, rows) adjoint variables ``K_ff⁻ᵀ ū`` of weights of the displacements."""
        w, factor = np.zeros_like(u_bar), self.result.record[case].factor
        if self.free.size:
            w[self.free] = factor.solve(np.ascontiguousarray(u_bar[self.free]), "T")
        return w

    def pull(self, case: int, weights: Sequence[Weights]) -> np.ndarray:
        """(np, rows) total weights of the parameters for many responses by one solution."""
        loads, stiffness, share = self._loads(case), self.stiffness(case), self.share(case)
        u_weights, forces, p_bar = (
            np.stack([getattr(w, name) for w in weights], axis=1) for name in ("u", "forces", "p")
        )
        reactions, applied = self.split(forces)
        u_bar = u_weights + stiffness.T @ reactions
        u, hot = self.result.displacements[:, case], loads.configuration
        factor_bar = np.array([w.load_factor for w in weights]) + applied.T @ loads.values(self.p)
        factor_bar += u_bar[self.held].T @ self.model.prescribed.values(self.p)
        factor_bar += reactions.T @ hot.forces(u, self.p)
        multiplier = self.multiplier(case, u_bar, factor_bar)
        u_bar = u_bar - stiffness.T @ multiplier  # free entries vanish by equilibrium
        internal, heated = (Pulls(a, self.p, len(weights)) for a in (self.assembly, hot.assembly))
        force_weights = (reactions - multiplier)[:, None, :]
        internal.forces(u[:, None], force_weights)
        heated.forces(hot.place(u)[:, None], share * force_weights)
        prescribed = self.model.prescribed
        external = [
            loads.pull(self.p, force) + prescribed.pull(self.p, held)
            for force, held in zip((applied + multiplier).T, u_bar[self.held].T, strict=True)
        ]
        return p_bar + internal.total + heated.total + share * np.stack(external, axis=1)

    def push(self, case: int, dp: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        """Changes of displacements, forces and load factor by ``D_i P − D_i K U``."""
        u, stiffness = self.result.displacements[:, case], self.stiffness(case)
        share, loads = self.share(case), self._loads(case)
        held = np.zeros_like(u)
        held[self.held] = share * self.model.prescribed.push(self.p, dp)
        applied = share * loads.push(self.p, dp)
        hot = loads.configuration
        internal = self.assembly.push(u, self.p, dp) + share * hot.push(u, self.p, dp)
        free, dfactor = self.response(case, applied - internal - stiffness @ held)
        du = held + free
        forces = applied
        if dfactor:
            forces = forces + dfactor * loads.values(self.p)
            internal += dfactor * hot.forces(u, self.p)
        forces[self.held] = (internal + stiffness @ du - forces)[self.held]
        return du, forces, dfactor

    def split(self, forces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of forces, split into weights of reactions and of applied forces."""
        reactions, applied = np.zeros_like(forces), np.zeros_like(forces)
        reactions[self.held], applied[self.free] = forces[self.held], forces[self.free]
        return reactions, applied - reactions  # loads on supports are subtracted

    def _loads(self, case: int):
        return self.model.loads[self.result.cases[case]]


class StaticsGradient(StaticsTangent):
    """Row of the gradient for one sampled response.

    With the tangent stiffness ``K`` at the solution, and weights of displacements, forces and
    parameters in the response, ``dΘ = ūᵀ dU + ωᵀ dP + p̄ᵀ dp``.
    """

    def __init__(self, sample: Sample, shared: dict | None = None):
        super().__init__(sample.motion)
        self.sample = sample
        self._changes = {} if shared is None else shared

    def cases(self) -> Iterator[tuple[int, float, Weights]]:
        """Number and weight of each sample, and the weights in its measure."""
        for k in np.flatnonzero(self.sample.weights):
            weights = self.result.weights(self.sample.measure.sx, int(k))
            yield int(k), float(self.sample.weights[k]), weights

    def direct(self, columns: Sequence[int]) -> np.ndarray:
        """(columns,) derivatives by one back-substitution per parameter and load case (8.26)."""
        gradient = np.zeros(len(columns))
        for k, weight, bars in self.cases():
            state = self.state(k)
            for i, column in enumerate(columns):
                du, dforces, dfactor = self._change(k, column, state)
                change = bars.u @ du + bars.forces @ dforces + bars.load_factor * dfactor
                gradient[i] += weight * (change + bars.p[column])
        return gradient

    def state(self, case: int) -> tuple:
        """Key of a state."""
        return self.result.cases[case], self.result.displacements[:, case].tobytes()

    def _change(self, case: int, column: int, state: tuple) -> tuple:
        """``push`` along one parameter, shared by all responses at this state."""
        key = (*state, column)
        if key not in self._changes:
            direction = np.zeros(self.p.size)
            direction[column] = 1.0
            self._changes[key] = self.push(case, direction)
        return self._changes[key]


class StaticsEngine(RowEngine):
    """Gradient engine of statics: factors of the analysis, one solution per state (8.27)."""

    row = StaticsGradient

    def adjoint(self) -> np.ndarray:
        rows: list[StaticsGradient] = self._rows()
        gradients = np.zeros((len(rows), rows[0].p.size))
        by_state: dict[tuple, list[tuple[int, int, float, Weights]]] = {}
        for r, row in enumerate(rows):
            for k, weight, bars in row.cases():
                by_state.setdefault(row.state(k), []).append((r, k, weight, bars))
        entries = sum(b.degrees.size for b in rows[0].assembly.blocks)
        limit = max(1, MAX_ENTRIES // max(entries, 1))
        for samples in by_state.values():
            for begin in range(0, len(samples), limit):
                part = samples[begin : begin + limit]
                numbers, cases, weights, all_bars = zip(*part, strict=True)
                p_bar = rows[numbers[0]].pull(cases[0], all_bars).T
                np.add.at(gradients, list(numbers), np.array(weights)[:, None] * p_bar)
        return gradients
