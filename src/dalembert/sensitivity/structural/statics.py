"""Gradients of statics, linear or not, with the factors of the analysis (8.25–8.35).

Second derivatives: the adjoint of ``r(U, p) = P(p)`` gives ``∇Θ = p̄ + (∂r/∂p)ᵀ w + (∂P/∂p)ᵀ (…)``
with ``w`` from one solve (8.27). Along a direction ``d`` of the parameters, with the change ``U̇``
from one direct solution (8.26), ``w`` changes by ``Kᵀ ẇ = ū̇ − K̇ᵀ w``, and ``K̇ᵀ w`` and the
changes of the transposed products are evaluated by the elements.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from dalembert.model.assembled.evaluation.columns import Pulls
from dalembert.model.assembled.measures import State, Weights
from dalembert.results.structural.measured_states import Formula
from dalembert.results.structural.result import StructuralResult
from dalembert.sensitivity.engine import RowEngine
from dalembert.sensitivity.samples import Sample, weights_change

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
        heated.forces(hot.configuration(u)[:, None], share * force_weights)
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


class SecondStatics(StaticsTangent):
    """``H d`` of one sampled response.

    Parameters
    ----------
    sample : Sample
    direction : (np,) ``d``
    """

    def __init__(self, sample: Sample, direction: np.ndarray):
        super().__init__(sample.motion)  # type: ignore[arg-type]
        self.sample, self.direction = sample, direction
        self.formula = Formula(self.result, sample.measure.sx)

    def product(self) -> np.ndarray:
        """(np,) product by one direct and one adjoint solution for each load case."""
        changes = [self._change(k) for k in range(self.sample.weights.size)]
        rates = np.array([self.formula.rate(k, change) for k, change in enumerate(changes)])
        dweights, product = weights_change(self.sample, rates), np.zeros(self.p.size)
        for k, change in enumerate(changes):
            weight, dweight = float(self.sample.weights[k]), float(dweights[k])
            if weight or dweight:
                bars = self.formula.weights(k, weight)
                turned = self.formula.turn(k, change, weight)
                dbars = _sum(turned, self.formula.weights(k, dweight))
                product += self._pull_change(k, bars, dbars, change)
        return product

    def _change(self, case: int) -> State:
        du, forces, factor = self.push(case, self.direction)
        return State(du, forces, self.direction, factor)

    def _pull_change(self, case: int, bars: Weights, dbars: Weights, change: State) -> np.ndarray:
        """Change of ``pull`` for changes ``dbars`` of the weights and ``change`` of the state."""
        loads, stiffness, held = self._loads(case), self.stiffness(case), self.model.prescribed
        u, p, d = self.result.displacements[:, case], self.p, self.direction
        reactions, applied = self.split(bars.forces)
        u_bar = bars.u + stiffness.T @ reactions
        multiplier = self.multiplier(case, u_bar, np.zeros(1))
        u_bar = u_bar - stiffness.T @ multiplier
        du_bar, p_bar = self.assembly.turn(u, p, reactions - multiplier, change.u, d)
        hot, there = loads.configuration, loads.configuration.configuration(u)
        du_there = np.zeros_like(u) if hot.linear else change.u
        du_hot, p_hot = hot.assembly.turn(there, p, reactions - multiplier, du_there, d)
        du_bar, p_bar = du_bar + (0.0 if hot.linear else 1.0) * du_hot, p_bar + p_hot
        dreactions, dapplied = self.split(dbars.forces)
        du_bar = dbars.u + stiffness.T @ dreactions + du_bar
        dmultiplier = self.multiplier(case, du_bar, np.zeros(1))
        du_bar = du_bar - stiffness.T @ dmultiplier
        return (
            dbars.p
            + p_bar
            + self.assembly.pull(u, p, dreactions - dmultiplier)
            + hot.pull(u, p, dreactions - dmultiplier)
            + loads.turn(p, applied + multiplier, d)
            + loads.pull(p, dapplied + dmultiplier)
            + held.turn(p, u_bar[self.held], d)
            + held.pull(p, du_bar[self.held])
        )


def _sum(a: Weights, b: Weights) -> Weights:
    return Weights(a.u + b.u, a.forces + b.forces, a.p + b.p)


class TwiceStaticsEngine(StaticsEngine):
    """Gradient engine of statics with second derivatives."""

    def hessian_product(self, direction: np.ndarray) -> np.ndarray:
        return np.array([SecondStatics(s, direction).product() for s in self.samples])
