"""Contact-free equations of a step and of its corrections, with sparse derivatives.

linear:     (M − h θ D − h² θ² K)(v⁺ − v) + Cᵀ Λ = h F,     C (σ v⁺ + (1−σ) v) = −Φ_t
step:       M (v⁺ − v) + C̄ᵀ Λ = h F̄,     C̄ (v⁺ + v)/2 = −Φ̄_t − Φ(y)/h   with means over the path
position:   M δ + Cᵀ λ = 0,     C δ = −Φ
speeds:     M c + Cᵀ λ = 0,     C (v + c) = −Φ_t
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np
import scipy

from dalembert.analysis.nonsmooth.path_forces import path_forces
from dalembert.analysis.nonsmooth.smooth_motion import constrained_fraction, smooth_motion
from dalembert.analysis.nonsmooth.step_forces import (
    StepForces,
    states_moved_by_speeds,
    step_forces,
)
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.model import Model
from dalembert.sensitivity.nonsmooth.slope_function import SlopeFunction
from dalembert.sensitivity.nonsmooth.triplets import Sparse
from dalembert.symbolic.once import once


class SmoothMap:
    """Equations ``G(z, q)`` without contacts, and the state ``F(z, q)`` that follows.

    Parameters
    ----------
    e : equations of the model
    h : symbol of the step
    z, equations, following : SX
    """

    def __init__(self, e: Equations, h: ca.SX, z: ca.SX, equations: ca.SX, following: ca.SX):
        q, inputs = ca.vertcat(e.y, e.v, e.t, e.p), [z, e.y, e.v, e.t, e.p, h]
        self._equations = SlopeFunction("equations", inputs, equations, [z, q])
        self._following = SlopeFunction("following", inputs, following, [z, q])

    def __call__(
        self,
        z: np.ndarray,
        y: np.ndarray,
        v: np.ndarray,
        t: float | np.ndarray,
        p: np.ndarray,
        h: float | np.ndarray,
    ) -> tuple[np.ndarray, list, np.ndarray, list]:
        """``G`` with ``G_z`` and ``G_q``, ``F`` with ``F_z`` and ``F_q``; of several steps with
        columns of arguments."""
        arguments, count = (z, y, v, t, p, h), None if z.ndim == 1 else z.shape[1]
        value, slopes = self._equations(*arguments, count=count)
        return value, slopes, *self._following(*arguments, count=count)


class StepEquations:
    """Equations of one model, built when used.

    Parameters
    ----------
    e : equations of the model
    theta : parameter of the θ-method
    takes_means : whether steps have means over their path
    """

    def __init__(self, e: Equations, theta: float, takes_means: bool):
        self.e, self.theta, self._takes_means = e, theta, takes_means
        self.h, self._lead = ca.SX.sym("h"), ca.SX.sym("lead")
        self.speeds = ca.SX.sym("speeds", e.v.numel())
        self.multiplier = ca.SX.sym("multiplier", e.constraint_count)
        self.z = ca.vertcat(self.speeds, self.multiplier)

    @cached_property
    def _joints(self) -> ca.Function:
        """``(t, y, p) → C, Φ_t, Φ``."""
        e = self.e
        by_time = ca.substitute(e.velocity_constraints, e.v, ca.SX.zeros(e.speed_count))
        return ca.Function("joints", [e.t, e.y, e.p], [e.jacobian, by_time, e.constraints])

    @cached_property
    def step(self) -> SmoothMap:
        """From the start of a step to its end, before corrections."""
        e, h, after = self.e, self.h, self.speeds
        if not self._takes_means:
            turning = self._forces.turning.tolist()
            mean = self.theta * after + (1 - self.theta) * e.v
            return self._linear(mean[turning]) if turning else self.linear
        means = path_forces(e, h, (e.v + after) / 2)
        momentum, states = self._linear_parts()
        if not e.states:
            mass = ca.Function("mass", [e.y, e.p], [e.mass])
            middle = mass(e.manifold.going(e.y, h * e.v / 2), e.p)
            momentum = ca.mtimes(middle, after - e.v) - h * means.force
        momentum = momentum + ca.mtimes(means.joints.T, self.multiplier)
        rates = ca.mtimes(means.joints, (e.v + after) / 2) + means.still + e.constraints / h
        return self._map(momentum, rates, states)

    @cached_property
    def linear(self) -> SmoothMap:
        """The step without impulses, with forces linearised about its start and joints at one
        position."""
        return self._linear()

    def _linear(self, mean: ca.SX | None = None) -> SmoothMap:
        """The linearised step with gyroscopic forces of the mean speeds ``mean``, by default those
        without impulses."""
        momentum, states = self._linear_parts(mean)
        e, h, after, part = self.e, self.h, self.speeds, constrained_fraction(self.theta)
        between = e.manifold.going(e.y, part * h * e.v)
        jacobian, by_time, _ = self._joints(e.t + part * h, between, e.p)
        rates = ca.mtimes(jacobian, part * after + (1 - part) * e.v) + by_time
        return self._map(momentum + ca.mtimes(jacobian.T, self.multiplier), rates, states)

    @cached_property
    def _forces(self) -> StepForces:
        return step_forces(self.e, self._lead)

    def _linear_parts(self, mean: ca.SX | None = None) -> tuple[ca.SX, ca.SX]:
        """Momentum balance with linearised forces, without joints, and the change of the states."""
        e, h, theta, after, forces = self.e, self.h, self.theta, self.speeds, self._forces
        inputs = [e.t, e.y, e.v, e.p, self._lead]
        smooth = ca.Function("smooth", [*inputs, forces.mean], [e.mass, *forces.all])
        middle = e.manifold.going(e.y, theta * h * e.v)
        arguments = e.t + theta * h, middle, e.v, e.p, theta * h
        if mean is None:
            mean = ca.Function("predicted", inputs, [forces.predicted])(*arguments)
        mass, force, damping, stiffness, rates, gain = smooth(*arguments, mean)
        matrix = mass - h * theta * damping - (h * theta) ** 2 * stiffness
        change = h * rates + ca.mtimes(gain, after - e.v)
        return ca.mtimes(matrix, after - e.v) - h * force, change

    def _map(self, momentum: ca.SX, rates: ca.SX, states: ca.SX) -> SmoothMap:
        """The map with a momentum balance, rates of the joints, and a change of the states."""
        e, h, theta, after = self.e, self.h, self.theta, self.speeds
        positions = e.manifold.going(e.y, h * (theta * after + (1 - theta) * e.v))
        positions[list(e.states)] += states
        following = ca.vertcat(positions, after)
        return SmoothMap(e, h, self.z, ca.vertcat(momentum, rates), following)

    @cached_property
    def position(self) -> SmoothMap:
        """One iteration towards closed joints."""
        e, shift = self.e, self.speeds
        jacobian, _, open_by = self._joints(e.t, e.y, e.p)
        momentum = ca.mtimes(e.mass, shift) + ca.mtimes(jacobian.T, self.multiplier)
        equations = ca.vertcat(momentum, ca.mtimes(jacobian, shift) + open_by)
        following = ca.vertcat(e.manifold.going(e.y, shift), e.v)
        return SmoothMap(e, self.h, self.z, equations, following)

    @cached_property
    def consistent(self) -> SmoothMap:
        """Projection to the nearest speeds that satisfy the joints."""
        e, change = self.e, self.speeds
        jacobian, by_time, _ = self._joints(e.t, e.y, e.p)
        momentum = ca.mtimes(e.mass, change) + ca.mtimes(jacobian.T, self.multiplier)
        rates = ca.mtimes(jacobian, e.v + change) + by_time
        following = ca.vertcat(e.y, e.v + change)
        return SmoothMap(e, self.h, self.z, ca.vertcat(momentum, rates), following)

    @cached_property
    def rates(self) -> SlopeFunction:
        """``(t, y, v, p) → ẏ``, ``A v`` of positions and ``f`` of states of first order."""
        manifold, e = self.e.manifold, self.e
        zero = ca.SX.zeros(manifold.delta.numel())
        lift = ca.substitute(ca.jacobian(manifold.moved, manifold.delta), manifold.delta, zero)
        rates = ca.densify(ca.mtimes(ca.substitute(lift, manifold.y, e.y), e.v))
        rates[list(e.states)] = e.pose_rate[list(e.states)]
        return SlopeFunction("rates", [e.t, e.y, e.v, e.p], rates, [])

    @cached_property
    def reach(self) -> Sparse:
        """(n_y, n) ones where a speed is the rate of a coordinate, or moves a state."""
        e = self.e
        positions = ca.jacobian_sparsity(e.manifold.moved, e.manifold.delta)
        rows, columns = (list(part) for part in positions.get_triplet())
        of_states = states_moved_by_speeds(e)
        own, speeds = of_states.get_triplet()
        rows += [e.states[k] for k in own]
        columns += speeds
        shape = e.coordinate_count, e.speed_count
        return scipy.sparse.csr_array((np.ones(len(rows)), (rows, columns)), shape=shape)

    def states_of_speeds(self, count: int) -> Sparse:
        """(K n, K n_x) ones where a speed moves a state of first order, of several steps."""
        own = self.reach[list(self.e.states)].T
        return scipy.sparse.kron(scipy.sparse.eye_array(count), own, "csr")


@once
def step_equations(model: Model, theta: float) -> StepEquations:
    """Equations of a model, for a parameter of the θ-method."""
    return StepEquations(model.equations, theta, smooth_motion(model).takes_means(theta))
