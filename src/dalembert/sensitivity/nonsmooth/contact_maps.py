"""Smooth maps of a step with contacts, for known pressing and slipping contacts.

    (M − h θ D − h² θ² K)(v⁺ − v) + Cᵀ Λ − Wᵀ P = h F,      C (σ v⁺ + (1−σ) v) = −Φ_t,
    u_N⁺ + e u_N⁻ = 0,      u_T⁺ + e_T u_T⁻ = 0  or  P_T = −μ P_N u_T/|u_T|  (also of rotations)

then ``y⁺ = y ⊕ h (θ v⁺ + (1−θ) v)``; correction of gaps along ``M⁻¹``; projection of speeds.
"""

from __future__ import annotations

from enum import Enum
from functools import cached_property
from itertools import pairwise

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.smooth_motion import constrained_fraction
from dalembert.integrators.contact.contact_laws import FIRST
from dalembert.sensitivity.nonsmooth.implicit_map import ImplicitMap
from dalembert.symbolic.formulas.expression import stack


class Friction(Enum):
    """State of a group of tangential components of a pressing contact."""

    NONE = 0
    STICK = 1
    SLIP = 2


Pattern = tuple[tuple[int, tuple[Friction, ...]], ...]
"""Keys of the pressing gaps with the states of their tangential groups."""


class ContactMaps:
    """Maps of one model and scheme, built on request and cached.

    Parameters
    ----------
    step : ContactStep of the run
    """

    def __init__(self, step: ContactStep):
        self.contact_step = step
        self.e = e = step.model.equations
        self.x = ca.vertcat(e.y, e.v)
        self.h, self.empty = ca.SX.sym("h"), ca.SX(0, 1)
        self._steps: dict[Pattern, ImplicitMap] = {}
        self._openings: dict[tuple[tuple[int, bool], ...], ImplicitMap] = {}
        self._gaps: dict[int, ca.Function] = {}
        self._closings: dict[int, ca.Function] = {}

    @cached_property
    def _smooth(self) -> ca.Function:
        """``(t, y, v, p) → M, F, D, K``."""
        e = self.e
        driving = ca.densify(e.force - e.bias)
        outputs = [e.mass, driving, ca.jacobian(driving, e.v), e.by_displacement(driving)]
        return ca.Function("smooth", [e.t, e.y, e.v, e.p], outputs)

    @cached_property
    def _joints(self) -> ca.Function:
        """``(t, y, p) → C, Φ_t, Φ``."""
        e = self.e
        by_time = ca.substitute(e.velocity_constraints, e.v, ca.SX.zeros(e.speed_count))
        return ca.Function("joints", [e.t, e.y, e.p], [e.jacobian, by_time, e.constraints])

    def gap(self, key: int) -> ca.Function:
        """``(t, y, v, p) → g, u, e, e_T, μ_s, μ``."""
        if key not in self._gaps:
            e, gap = self.e, self.contact_step.symbolic_gap(key)
            coefficients = gap.coefficients
            laws = [*ca.vertsplit(coefficients[:FIRST]), coefficients[FIRST:]]
            self._gaps[key] = ca.Function(
                "gap", [e.t, e.y, e.v, e.p], [gap.distance, gap.speeds, *laws]
            )
        return self._gaps[key]

    def groups(self, key: int) -> list[slice]:
        """Components of each group of the impulse of a gap."""
        widths = self.contact_step.symbolic_gap(key).groups
        ends = np.cumsum([1, *widths])
        return [slice(*limits) for limits in pairwise(map(int, ends))]

    def closing(self, key: int) -> ca.Function:
        """``(t, y, v, p) → ġ, ∂ġ/∂v, ∂g/∂y, ∂g/∂p``."""
        if key not in self._closings:
            e = self.e
            distance, speeds, *_ = self.gap(key)(e.t, e.y, e.v, e.p)
            slopes = [ca.jacobian(distance, by) for by in (e.y, e.p)]
            outputs = [speeds[0], ca.jacobian(speeds[0], e.v), *slopes]
            self._closings[key] = ca.Function(
                "closing", [e.t, e.y, e.v, e.p], [ca.densify(out) for out in outputs]
            )
        return self._closings[key]

    @cached_property
    def kinematic_matrix(self) -> ca.Function:
        """``y → A`` with ``ẏ = A v``."""
        m = self.e.manifold
        zero = ca.SX.zeros(m.delta.numel())
        rate = ca.substitute(ca.jacobian(m.moved, m.delta), m.delta, zero)
        return ca.Function("kinematic_matrix", [m.y], [ca.densify(rate)])

    def step(self, pattern: Pattern) -> ImplicitMap:
        """Map from the start of a step to its end before corrections."""
        if pattern not in self._steps:
            self._steps[pattern] = self._step(pattern)
        return self._steps[pattern]

    def _step(self, pattern: Pattern) -> ImplicitMap:
        e, h, theta = self.e, self.h, self.contact_step.scheme.theta
        after = ca.SX.sym("v", e.v.numel())
        multiplier = ca.SX.sym("multiplier", e.constraint_count)
        at, middle = e.t + theta * h, e.manifold.going(e.y, theta * h * e.v)
        mass, force, damping, stiffness = self._smooth(at, middle, e.v, e.p)
        part = constrained_fraction(theta)
        between = e.manifold.going(e.y, part * h * e.v)
        jacobian, by_time, _ = self._joints(e.t + part * h, between, e.p)
        matrix = mass - h * theta * damping - (h * theta) ** 2 * stiffness
        dynamics = ca.mtimes(matrix, after - e.v) + ca.mtimes(jacobian.T, multiplier) - h * force
        impulses, rows = [], [ca.mtimes(jacobian, part * after + (1 - part) * e.v) + by_time]
        for key, states in pattern:
            gap = self.gap(key)
            _, before, restitution, tangential, _, friction = gap(e.t, e.y, e.v, e.p)
            end = gap(e.t, e.y, after, e.p)[1]
            impulse = ca.SX.sym("P", end.numel())
            impulses.append(impulse)
            dynamics -= ca.mtimes(ca.jacobian(before, e.v).T, impulse)
            rows.append(end[0] + restitution * before[0])
            for j, (components, state) in enumerate(zip(self.groups(key), states, strict=True)):
                along, push = end[components], impulse[components]
                if j == 0:
                    along += tangential * before[components]
                if state is Friction.NONE:
                    rows.append(push)
                elif state is Friction.STICK:
                    rows.append(along)
                else:
                    direction = along / ca.norm_2(along)
                    rows.append(push + friction[j] * impulse[0] * direction)
        positions = e.manifold.going(e.y, h * (theta * after + (1 - theta) * e.v))
        z = ca.vertcat(after, multiplier, *impulses)
        equations = ca.vertcat(dynamics, *rows)
        return ImplicitMap(z, self.x, e.t, e.p, h, equations, ca.vertcat(positions, after))

    def opening(self, keys: tuple[tuple[int, bool], ...]) -> ImplicitMap:
        """One iteration towards closed joints and open gaps, ``M δ + Cᵀ λ − Nᵀ π = 0``.

        Each key of a gap comes with a flag whether its contact presses. The lift of other gaps is
        constant: their impact is still to come, and its instant depends on their position.
        """
        if keys not in self._openings:
            e = self.e
            jacobian, _, open_by = self._joints(e.t, e.y, e.p)
            gaps = [self.gap(key)(e.t, e.y, e.v, e.p) for key, _ in keys]
            normals = stack(ca.jacobian(gap[1][0], e.v) for gap in gaps)
            if not gaps:
                normals = ca.SX(0, e.v.numel())
            lifts = ca.SX.sym("lift", len(keys))
            open_gaps = [
                gap[0] if presses else lifts[n]
                for n, (gap, (_, presses)) in enumerate(zip(gaps, keys, strict=True))
            ]
            rows = ca.vertcat(jacobian, -normals)
            z = ca.SX.sym("z", e.v.numel() + rows.shape[0])
            shift, forces = z[: e.v.numel()], z[e.v.numel() :]
            equations = ca.vertcat(
                ca.mtimes(e.mass, shift) + ca.mtimes(rows.T, forces),
                ca.mtimes(jacobian, shift) + open_by,
                ca.mtimes(normals, shift) + stack(open_gaps),
            )
            following = ca.vertcat(e.manifold.going(e.y, shift), e.v)
            self._openings[keys] = ImplicitMap(z, self.x, e.t, e.p, lifts, equations, following)
        return self._openings[keys]

    @cached_property
    def consistent(self) -> ImplicitMap:
        """Projection to the nearest speeds that satisfy the joints."""
        e = self.e
        jacobian, by_time, _ = self._joints(e.t, e.y, e.p)
        z = ca.SX.sym("z", e.v.numel() + e.constraint_count)
        change, multiplier = z[: e.v.numel()], z[e.v.numel() :]
        equations = ca.vertcat(
            ca.mtimes(e.mass, change) + ca.mtimes(jacobian.T, multiplier),
            ca.mtimes(jacobian, e.v + change) + by_time,
        )
        following = ca.vertcat(e.y, e.v + change)
        return ImplicitMap(z, self.x, e.t, e.p, self.empty, equations, following)
