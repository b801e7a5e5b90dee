"""Second derivatives of statics, with the factors of the analysis.

The adjoint of ``r(U, p) = P(p)`` gives ``∇Θ = p̄ + (∂r/∂p)ᵀ w + (∂P/∂p)ᵀ (…)`` with ``w`` from one
solve (8.27). Along a direction ``d`` of the parameters, with the change ``U̇`` from one direct
solution (8.26), ``w`` changes by ``Kᵀ ẇ = ū̇ − K̇ᵀ w``, and ``K̇ᵀ w`` and the changes of the
transposed products come from the elements at once.
"""

from __future__ import annotations

import numpy as np

from dalembert.results.structural.measured_states import Formula
from dalembert.sensitivity.samples import Sample, weights_change
from dalembert.sensitivity.structural.statics import StaticsEngine, StaticsTangent
from dalembert.structures.measuring.measures import State, Weights


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
        """(np,) by one direct and one adjoint solution for each load case."""
        changes = [self._change(k) for k in range(self.sample.weights.size)]
        rates = np.array([self.formula.rate(k, change) for k, change in enumerate(changes)])
        turned, found = weights_change(self.sample, rates), np.zeros(self.p.size)
        for k, change in enumerate(changes):
            weight, more = float(self.sample.weights[k]), float(turned[k])
            if weight or more:
                seen = self.formula.weights(k, weight)
                moved = self.formula.turn(k, change, weight)
                found += self._turned(k, seen, _sum(moved, self.formula.weights(k, more)), change)
        return found

    def _change(self, case: int) -> State:
        du, forces, factor = self.pushed(case, self.direction)
        return State(du, forces, self.direction, factor)

    def _turned(self, case: int, seen: Weights, moved: Weights, change: State) -> np.ndarray:
        """Change of ``pulled`` when what is seen changes by ``moved``, the state by ``change``."""
        loads, stiffness, held = self._loads(case), self.stiffness(case), self.model.prescribed
        u, p, d = self.result.displacements[:, case], self.p, self.direction
        reactions, applied = self.split(seen.forces)
        u_bar = seen.u + stiffness.T @ reactions
        multiplier = self.multiplier(case, u_bar, np.zeros(1))
        u_bar = u_bar - stiffness.T @ multiplier
        softer, p_bar = self.assembly.turn(u, p, reactions - multiplier, change.u, d)
        hot, there = loads.configuration, loads.configuration.configuration(u)
        moved_there = np.zeros_like(u) if hot.linear else change.u
        stiffer, more_p = hot.assembly.turn(there, p, reactions - multiplier, moved_there, d)
        softer, p_bar = softer + (0.0 if hot.linear else 1.0) * stiffer, p_bar + more_p
        reactions, more = self.split(moved.forces)
        u_turn = moved.u + stiffness.T @ reactions + softer
        turned = self.multiplier(case, u_turn, np.zeros(1))
        u_turn = u_turn - stiffness.T @ turned
        return (
            moved.p
            + p_bar
            + self.assembly.pull(u, p, reactions - turned)
            + hot.pull(u, p, reactions - turned)
            + loads.turn(p, applied + multiplier, d)
            + loads.pull(p, more + turned)
            + held.turn(p, u_bar[self.held], d)
            + held.pull(p, u_turn[self.held])
        )


def _sum(one: Weights, other: Weights) -> Weights:
    return Weights(one.u + other.u, one.forces + other.forces, one.p + other.p)


class TwiceStaticsEngine(StaticsEngine):
    """Statics with second derivatives."""

    def hessian_product(self, direction: np.ndarray) -> np.ndarray:
        return np.array([SecondStatics(s, direction).product() for s in self.samples])
