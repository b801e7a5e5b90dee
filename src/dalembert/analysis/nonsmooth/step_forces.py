"""Forces of a step by the θ-method, with the states of first order eliminated."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gyroscopic import mean_forces
from dalembert.model.graph.equations import Equations


@dataclass(frozen=True, eq=False)
class StepForces:
    """Forces at the middle of a step, and the change of the states over it.

    With ``x⁺ − x = h (f + θ f_x (x⁺ − x) + θ f_v (v⁺ − v) + θ² h f_y A (v⁺ − v))``, the states are

        x⁺ = x + h N⁻¹ f + G (v⁺ − v),      N = I − θ h f_x,      G = N⁻¹ (θ h f_v + θ² h² f_y A)

    and enter the forces, ``F + F_x θ (x⁺ − x)``, as ``θ h F_x N⁻¹ f`` and as the damping ``F_x G``.

    Attributes
    ----------
    driving : ``F + θ h F_x N⁻¹ f`` (n,) SX
    damping : ``∂F/∂v + F_x G``
    stiffness : ``(∂F/∂y) A``
    rates : ``N⁻¹ f`` (n_x,)
    gain : ``G`` (n_x, n)
    turning, mean, predicted : numbers of the speeds with gyroscopic forces, the symbol of their
        means over the step, on which ``driving`` and ``damping`` depend, and these means without
        impulses (``MeanForces``)
    """

    driving: ca.SX
    damping: ca.SX
    stiffness: ca.SX
    rates: ca.SX
    gain: ca.SX
    turning: np.ndarray
    mean: ca.SX
    predicted: ca.SX

    @property
    def all(self) -> list[ca.SX]:
        """All forces and rates, in this order."""
        return [self.driving, self.damping, self.stiffness, self.rates, self.gain]

    def with_mean(self, mean: ca.SX) -> StepForces:
        """The forces with some mean speeds (k,)."""
        if not self.turning.size:
            return self
        parts = [ca.substitute(part, self.mean, mean) for part in (self.driving, self.damping)]
        return replace(self, driving=parts[0], damping=parts[1], mean=mean)


def step_forces(e: Equations, lead: ca.SX) -> StepForces:
    """Forces of a model.

    Parameters
    ----------
    e : equations of the model
    lead : symbol of ``θ h``
    """
    means = mean_forces(e, lead)
    driving, damping = means.driving, means.damping
    turning = means.rows, means.mean, means.predicted
    force, states = ca.densify(e.force - e.bias), list(e.states)
    if not states:
        stiffness, none = e.by_displacement(force), (ca.SX(0, 1), ca.SX(0, e.speed_count))
        return StepForces(driving, damping, stiffness, none[0], none[1], *turning)
    x, f, lift = e.y[states], ca.densify(e.pose_rate[states]), position_lift(e)

    def by_displacement(expression: ca.SX) -> ca.SX:
        return ca.sparsify(ca.mtimes(ca.jacobian(expression, e.y), lift))

    implicit = ca.SX.eye(len(states)) - lead * ca.jacobian(f, x)
    slopes = lead * ca.jacobian(f, e.v) + lead**2 * by_displacement(f)
    solution = ca.solve(implicit, ca.densify(ca.horzcat(f, slopes)))
    rates, gain = solution[:, 0], ca.sparsify(solution[:, 1:])
    by_states = ca.sparsify(ca.jacobian(driving, x))
    return StepForces(
        driving + lead * ca.mtimes(by_states, rates),
        ca.sparsify(damping + ca.mtimes(by_states, gain)),
        by_displacement(force),
        rates,
        gain,
        *turning,
    )


def position_lift(e: Equations) -> ca.SX:
    """``A(y)`` with zero rows for states, which displacements leave unchanged."""
    lift = ca.SX(e.lift)
    if e.states:
        lift[list(e.states), :] = 0
    return ca.sparsify(lift)


def states_moved_by_speeds(e: Equations) -> ca.Sparsity:
    """(n_x, n) pattern of the states whose rates depend on a speed, directly or by other states."""
    states = list(e.states)
    rates = ca.densify(e.pose_rate[states])
    reach = ca.jacobian_sparsity(rates, e.v)
    among = ca.jacobian_sparsity(rates, e.y[states])
    for _ in states:
        wider = reach + ca.mtimes(ca.DM(among, 1.0), ca.DM(reach, 1.0)).sparsity()
        if wider.nnz() == reach.nnz():
            break
        reach = wider
    return reach
