"""The contact-free part of a time step: forces, inertia and joints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.mobility import WHOLE, Coupling, Mobility
from dalembert.analysis.nonsmooth.path_forces import path_forces
from dalembert.analysis.nonsmooth.step_forces import position_lift, step_forces
from dalembert.elements.blocks.sampled import Sampled
from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.mean_force import NODES, WEIGHTS
from dalembert.model.graph.assembly.assembly import ROUNDING
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel, Matrix, Patterned
from dalembert.symbolic.once import once


@dataclass(frozen=True, eq=False)
class StateChange:
    """Change of the states of first order over a step, ``x⁺ = x + h N⁻¹ f + G (v⁺ − v)``.

    Attributes
    ----------
    numbers : coordinates that are states
    free, gain : ``h N⁻¹ f`` (n_x,), ``G`` (n_x, n)
    """

    numbers: list[int]
    free: np.ndarray
    gain: Matrix

    def added(self, position: np.ndarray, change: np.ndarray) -> np.ndarray:
        """The position with the states at the end, for a change of speeds."""
        if self.numbers:
            position = position.copy()
            position[self.numbers] += self.free + self.gain @ change
        return position


@dataclass(frozen=True, eq=False)
class FreeMotion:
    """Motion of a step without impulses, in which it is linear.

    Attributes
    ----------
    speeds, multiplier : speeds at the end, and multipliers times ``h``
    mobility : Mobility
    """

    speeds: np.ndarray
    multiplier: np.ndarray
    mobility: Mobility

    def after(self, momentum: np.ndarray) -> FreeMotion:
        """The motion with a momentum at the start."""
        change, reactions = self.mobility(momentum)
        return FreeMotion(self.speeds + change, self.multiplier + reactions, self.mobility)


@dataclass(frozen=True, eq=False)
class SmoothStep:
    """Start of a step, and its motion with forces linearised and joints at one position.

    Attributes
    ----------
    t, h, y, v, p : start, length, state and parameters
    force, mass : at the middle of the step
    mean : (k,) mean speeds with which gyroscopic forces are computed
    joint_rates : (m,) rates of the joints by the impulses
    free : the motion without impulses
    states : change of the states of first order
    """

    t: float
    h: float
    y: np.ndarray
    v: np.ndarray
    p: np.ndarray
    force: np.ndarray
    mass: Matrix
    mean: np.ndarray
    joint_rates: np.ndarray
    free: FreeMotion
    states: StateChange


class SmoothMotion:
    """Functions of a model for steps by the θ-method,

        (M − h θ D − h² θ² K)(v⁺ − v) = h F − Cᵀ Λ,      C (σ v⁺ + (1−σ) v) = −Φ_t

    with ``F = f − d``, ``D = ∂F/∂v``, ``K = (∂F/∂y) A`` at ``y ⊕ θ h v``, ``v``; for linear forces
    this is the θ-method itself. Gyroscopic forces of free bodies do no work (``MeanForces``); the
    step is repeated with the mean speeds of its solution.
    ``C`` and ``Φ_t`` are taken at ``y ⊕ σ h v``, ``σ = max(θ, 1/2)``:
    with constraints on the speeds at the end alone the centripetal forces within the step are lost.
    States of first order are eliminated (``step_forces``). Steps by the midpoint rule with joints,
    or with forces that couple bodies, are repeated with means over their path (``path_forces``):
    with linearised forces, thin beams gain energy without bounds.

    Parameters
    ----------
    model : Model

    Attributes
    ----------
    forces, lead : formulas of the forces, and the symbol of ``θ h`` in them
    turning : (k,) numbers of the speeds with gyroscopic forces
    coupling : independent groups of speeds
    exchanges_energy : whether forces or joints dissipate energy or supply it
    prescribes : whether joints prescribe speeds that depend on time
    """

    def __init__(self, model: Model):
        e = model.equations
        lead = ca.SX.sym("lead")
        forces = step_forces(e, lead)
        unknown = ca.vertcat(e.a, e.multiplier, e.dropped)
        if ca.depends_on(ca.vertcat(forces.driving, forces.rates), unknown):
            raise UnsupportedError(
                "a force depends on reactions or accelerations (e.g. friction in a joint), which "
                "solve_nonsmooth cannot evaluate before the step; use solve_dynamics"
            )
        if any(isinstance(element, Sampled) for element in model.parts.elements.values()):
            raise UnsupportedError(
                "blocks are sampled, which solve_nonsmooth does not do; use solve_dynamics, or "
                "blocks of continuous time"
            )
        self.forces, self.lead, self._equations = forces, lead, e
        inputs_at_position = [e.t, e.y, e.p]
        still = ca.substitute(e.velocity_constraints, e.v, ca.SX.zeros(e.speed_count))
        inputs = [e.t, e.y, e.v, e.p, lead]
        self.turning = forces.turning
        first = forces.with_mean(forces.predicted)
        self._forces = Patterned("forces", inputs, [*first.all, forces.predicted])
        self._mass = Patterned("mass", [e.y, e.p], [e.mass])
        magnitudes = ca.mtimes(ca.fabs(position_lift(e)).T, ca.fabs(e.y))
        rounding = ROUNDING * ca.mtimes(ca.fabs(e.position_jacobian), magnitudes)
        joints = [e.jacobian, still, e.constraints, ca.densify(rounding)]
        self._joints = Patterned("joints", inputs_at_position, joints)
        self.powers = Kernel(
            ca.Function("powers", [e.t, e.y, e.v, e.a, e.multiplier, e.p], [ca.densify(e.powers)])
        )
        self.exchanges_energy = ca.sparsify(e.powers).nnz() > 0
        self._reacts = ca.sparsify(ca.horzcat(forces.damping, forces.stiffness)).nnz() > 0
        pattern = ca.sparsify(e.mass).sparsity()
        for slope in (forces.damping, forces.stiffness):
            pattern = pattern + ca.sparsify(slope).sparsity()
        bodies = [group.twist.numel() for group in model.coordinates]
        self.coupling = Coupling.of(pattern, e.jacobian.sparsity(), bodies, WHOLE)
        self._states = list(e.states)
        self._couples = not e.states and couples_bodies(pattern, bodies)
        self.has_joints, self._go = e.constraint_count > 0, e.manifold.go
        self.prescribes = ca.depends_on(still, e.t)
        self._still = Kernel(ca.Function("prescribed", inputs_at_position, [ca.densify(still)]))

    def step(
        self, t: float, y: np.ndarray, v: np.ndarray, p: np.ndarray, h: float, theta: float
    ) -> SmoothStep:
        """The step with forces linearised about its start and joints at one position."""
        fraction = constrained_fraction(theta)
        middle, between = self._go(y, theta * h * v), self._go(y, fraction * h * v)
        arguments = t + theta * h, middle, v, p, theta * h
        force, damping, stiffness, rates, gain, mean = self._forces(*arguments)
        mass = self._mass(middle, p)[0]
        matrix = mass
        if self._reacts:
            matrix = mass - h * theta * damping - (h * theta) ** 2 * stiffness
        joints, still = self._joints(t + fraction * h, between, p)[:2]
        mobility = Mobility(matrix, joints, self.coupling)
        joint_rates = -(still + joints @ v) / fraction
        change, multiplier = mobility(h * force, joint_rates)
        free, states = (
            FreeMotion(v + change, multiplier, mobility),
            StateChange(self._states, h * rates, gain),
        )
        return SmoothStep(t, h, y, v, p, force, mass, mean, joint_rates, free, states)

    @cached_property
    def _with_mean(self) -> Patterned:
        """``(t, y, v, p, θ h, v̄) → F, D, K``."""
        e, forces = self._equations, self.forces
        inputs = [e.t, e.y, e.v, e.p, self.lead, forces.mean]
        return Patterned("turned", inputs, forces.all[:3])

    def repeated(self, start: SmoothStep, theta: float, after: np.ndarray) -> FreeMotion:
        """The motion with means over the step with speeds ``after`` at its end: of joints and
        forces, or, without joints, of gyroscopic forces."""
        if self.takes_means(theta):
            return self._along(start, after)
        return self._turned(start, theta, (start.v + theta * (after - start.v))[self.turning])

    def first_guess(self, start: SmoothStep, theta: float, after: np.ndarray) -> np.ndarray:
        """Speeds at the end of a step, for its means: ``after`` for those of joints and forces, or
        those by which gyroscopic forces have the mean speeds without impulses."""
        if self.takes_means(theta):
            return after
        guess = start.v.copy()
        guess[self.turning] += (start.mean - start.v[self.turning]) / (theta or 1.0)
        return guess

    def _turned(self, start: SmoothStep, theta: float, mean: np.ndarray) -> FreeMotion:
        """The motion with gyroscopic forces of the mean speeds ``mean`` (k,)."""
        h, p = start.h, start.p
        middle = self._go(start.y, theta * h * start.v)
        force, damping, stiffness = self._with_mean(
            start.t + theta * h, middle, start.v, p, theta * h, mean
        )
        matrix = start.mass - h * theta * damping - (h * theta) ** 2 * stiffness
        mobility = Mobility(matrix, start.free.mobility.joints, self.coupling)
        change, multiplier = mobility(h * force, start.joint_rates)
        return FreeMotion(start.v + change, multiplier, mobility)

    def _along(self, start: SmoothStep, after: np.ndarray) -> FreeMotion:
        """The motion with joints and forces along the path with speeds ``after`` at its end.

        With ``A = M − h θ D − h² θ² K``, whose solution for ``v⁺ = after`` is that of the means,

            A (v⁺ − v) + C̄ᵀ Λ = h F̄ + (A − M)(after − v),     C̄ (v⁺ + v)/2 = −Φ̄_t − Φ(y)/h

        Forces with states of first order stay linearised.
        """
        joints, still, force, open_by = self._means(
            start.t, start.y, start.v, start.p, start.h, after
        )
        matrix, momentum = start.free.mobility.matrix, start.h * start.force
        if not self._states:
            momentum = start.h * force
            if self._reacts:
                momentum = momentum + (matrix - start.mass) @ (after - start.v)
        mobility = start.free.mobility.with_joints(joints)
        rates = -2 * (still + open_by / start.h + joints @ start.v)
        change, multiplier = mobility(momentum, rates)
        return FreeMotion(start.v + change, multiplier, mobility)

    def takes_means(self, theta: float) -> bool:
        """Whether steps have means over their path."""
        joined: bool = self._equations.constraint_count > 0 or self._couples
        return theta == 0.5 and joined

    def path_nodes(self, theta: float) -> list[tuple[float, float]]:
        """Fractions of a step at which its forces are evaluated, and their weights."""
        if not self.takes_means(theta):
            return [(0.5, 1.0)]
        return [(float(s), float(weight)) for s, weight in zip(NODES, WEIGHTS, strict=True)]

    @cached_property
    def _means(self) -> Patterned:
        """``(t, y, v, p, h, v⁺) → C̄, Φ̄_t, F̄, Φ``."""
        e, h = self._equations, ca.SX.sym("h")
        after = ca.SX.sym("after", e.speed_count)
        means = path_forces(e, h, (e.v + after) / 2)
        outputs = [means.joints, means.still, means.force, ca.densify(e.constraints)]
        return Patterned("means", [e.t, e.y, e.v, e.p, h, after], outputs)

    def open_by(self, t: float, y: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """``Φ``, and its rounding error."""
        open_by, rounding = self._joints(t, y, p)[2:]
        return open_by, rounding

    def prescribed(self, t: float, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        """(m,) ``Φ_t``, minus the speeds that drivers prescribe."""
        return np.asarray(self._still(t, y, p)[0]).ravel()

    def at(
        self, t: float, y: np.ndarray, p: np.ndarray
    ) -> tuple[Mobility, np.ndarray, np.ndarray, Matrix]:
        """Mobility with ``M`` and ``C`` at a position, ``Φ``, ``Φ_t`` and ``C``."""
        joints, still, open_by = self._joints(t, y, p)[:3]
        return Mobility(self._mass(y, p)[0], joints, self.coupling), open_by, still, joints


@once
def smooth_motion(model: Model) -> SmoothMotion:
    """Functions of a model, built once."""
    return SmoothMotion(model)


def couples_bodies(pattern: ca.Sparsity, bodies: Sequence[int]) -> bool:
    """Whether a matrix (n, n) has entries of two bodies, with some numbers of successive speeds."""
    if sum(bodies) != pattern.size1():
        return False
    body = np.repeat(np.arange(len(bodies)), bodies)
    row, column = (np.array(part, dtype=int) for part in pattern.get_triplet())
    return bool((body[row] != body[column]).any())


def constrained_fraction(theta: float) -> float:
    """``σ``, the fraction of a step at which interpolated speeds satisfy the joints."""
    return max(theta, 0.5)
