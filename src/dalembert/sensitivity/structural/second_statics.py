"""Second derivatives of statics, with the factors of the analysis.

The adjoint of ``r(U, p) = P(p)`` gives ``∇Θ = p̄ + (∂r/∂p)ᵀ w + (∂P/∂p)ᵀ (…)`` with ``w`` from one
solve (8.27). Along a direction ``d`` of the parameters, with the change ``U̇`` from one direct
solution (8.26), ``w`` changes by ``Kᵀ ẇ = ū̇ − K̇ᵀ w``, and ``K̇ᵀ w`` and the changes of the
transposed products are evaluated by the elements.
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
        hot, there = loads.configuration, loads.configuration.place(u)
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
