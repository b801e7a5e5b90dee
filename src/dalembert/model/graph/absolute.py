"""Equations of motion in absolute coordinates, the pose and twist of every body."""

from __future__ import annotations

from collections.abc import Collection
from contextlib import ExitStack
from dataclasses import replace
from weakref import WeakKeyDictionary

import casadi as ca

from dalembert.elements.base import Element, Powers
from dalembert.elements.coordinates import Coordinates, motion_rate_of, rate_of
from dalembert.elements.joint_forces import AlongJoint
from dalembert.elements.planar.body import Ground
from dalembert.elements.states import foreign_states
from dalembert.errors import ModelError
from dalembert.model.graph.description import Description
from dalembert.model.graph.equations import ConstraintKinematics, Equations
from dalembert.model.graph.inertia import BlockInertia
from dalembert.model.graph.manifold import Manifold
from dalembert.model.graph.rigid_gaps import RigidGap, rigid_gaps
from dalembert.symbolic.formulas.expression import stack, t

_AT_REST = WeakKeyDictionary[Ground, tuple[ca.SX, ca.SX]]()
"""Ground → symbols of its motion and their values."""


def at_ground(ground: Ground, expression: ca.SX) -> ca.SX:
    """The expression with the ground at rest at the origin."""
    if ground not in _AT_REST:
        motion = ca.vertcat(ground.twist, ground.acceleration_symbols)
        values = ca.vertcat(ca.SX(list(ground.rest)), ca.SX.zeros(motion.numel()))
        _AT_REST[ground] = ca.vertcat(ground.pose, motion), values
    return ca.substitute(expression, *_AT_REST[ground])


def absolute_equations(d: Description) -> Equations:
    """Equations of a mechanism in the coordinates of its bodies.

    ``f = Σ (∂u/∂v)ᵀ Q`` by virtual power over all forces; ``M`` from the bodies, and from the
    virtual power of inertia of elements between them.
    """
    groups = d.coordinates
    y = stack(c.pose for c in groups)
    v = stack(c.twist for c in groups)
    multiplier = stack(c.multiplier[k] for c, k in d.rows)
    mass, bias = inertia_of(d, v)
    with ExitStack() as enriched:
        followers = [enriched.enter_context(group.enriched()) for group in groups]
        symbols, values = (stack(pair[k] for pair in followers) for k in range(2))
        changed = bool(symbols.numel())  # constraints must be written in the enriched bodies
        pairs = [
            (c.residual(), c.slipping()) if changed else (c.equations, c.slip)
            for c in d.constraints
        ]
        held, slip = (at_ground(d.ground, stack(pair[k] for pair in pairs)) for k in range(2))
        kinematics = _kinematics(groups, held, slip, v) if changed else None
        force, work, potential, losses, released = _forces(d, v)

    def plain(expression: ca.SX) -> ca.SX:
        return ca.substitute(at_ground(d.ground, expression), symbols, values)

    force, work, potential, losses = map(plain, (force, work, potential, losses))
    # power not from storage: ends moved by formulas of time receive power from outside
    applied = ca.dot(force, v) + plain(released)
    constraints = plain(ca.vertcat(held, ca.SX.zeros(slip.numel())))
    nonholonomic = plain(ca.vertcat(ca.SX.zeros(held.numel()), slip))
    imposed = ca.substitute(nonholonomic, v, ca.SX.zeros(v.numel()))
    imposed += ca.jacobian(constraints, t.sx)
    followed = [c for c in groups if not c.twist.numel()]  # laws of drivers may contain states
    states, rates = (stack(getattr(c, k) for c in followed) for k in ("pose", "pose_rate"))
    if constraints.numel() and states.numel():
        imposed += ca.jtimes(ca.densify(constraints), states, plain(rates))
    delivered = ca.dot(multiplier, imposed)  # power of drivers: C v = −Φ_t − Φ_z ż
    return Equations(
        t=t.sx,
        y=y,
        v=v,
        p=d.space.symbols,
        a=stack(c.acceleration_symbols for c in groups),
        multiplier=multiplier,
        pose_rate=plain(stack(c.pose_rate for c in groups)),
        inertia=BlockInertia(mass),
        bias=ca.densify(bias),
        force=force + work,
        constraints=constraints,
        nonholonomic=nonholonomic,
        potential=potential,
        manifold=Manifold.of(groups),
        powers=ca.vertcat(losses, applied + losses + delivered),
        kinematics=None if kinematics is None else ConstraintKinematics(*map(plain, kinematics)),
        contacts=_contacts(d),
    )


def _contacts(d: Description) -> tuple[RigidGap, ...]:
    """Rigid gaps with the ground at rest."""

    def grounded(gap: RigidGap) -> RigidGap:
        friction = at_ground(d.ground, gap.impact.friction)
        return replace(
            gap,
            distance=at_ground(d.ground, gap.distance),
            slip=at_ground(d.ground, gap.slip),
            impact=replace(gap.impact, friction=friction),
        )

    gaps = tuple(map(grounded, rigid_gaps([*d.elements.values()], d.coordinates)))
    pose, twist = (stack(getattr(c, kind) for c in d.coordinates) for kind in ("pose", "twist"))
    for gap in gaps:
        if not ca.depends_on(gap.distance, pose):
            raise ModelError(
                "its distance does not depend on any position, so it can neither open nor close; "
                "give a distance that does, such as a body's y",
                gap.name,
            )
        if gap.slip.numel() and not ca.depends_on(gap.slip, twist):
            raise ModelError(
                "its slip does not depend on any speed; give a velocity along the surface, such as "
                "a body's vx",
                gap.name,
            )
    return gaps


def with_rotors(d: Description) -> list[AlongJoint]:
    """Elements with an inertia along the free motion of a joint."""
    elements = [e for e in d.elements.values() if isinstance(e, AlongJoint)]
    return [element for element in elements if element.own_mass]


def inertia_of(d: Description, v: ca.SX, without: Collection[Element] = ()) -> tuple[ca.SX, ca.SX]:
    """``M`` and ``d`` in ``M v̇ + d``, without the inertia of some elements."""
    groups = d.coordinates
    masses, gyroscopic = zip(*(c.inertia_by_speeds() for c in groups), strict=True)
    mass, bias = ca.diagcat(*masses), stack(gyroscopic)
    a = stack(c.acceleration_symbols for c in groups)
    for element in d.elements.values():
        if element in without:
            continue
        owners = element.parts()

        def rate(s: ca.SX, owners=owners) -> ca.SX:
            return motion_rate_of(s, owners, t.sx)

        for velocity, effort in element.inertial_powers(rate):
            velocity, effort = at_ground(d.ground, velocity), at_ground(d.ground, effort)
            force = ca.jtimes(velocity, v, effort, True)
            mass += ca.jacobian(force, a)
            bias += ca.substitute(force, a, ca.SX.zeros(a.numel()))
    return mass, bias


def _kinematics(groups: list[Coordinates], held: ca.SX, slip: ca.SX, v: ca.SX) -> list[ca.SX]:
    """``(∂Φ/∂y) A``, ``Ψ`` and ``ξ`` of holonomic and nonholonomic equations."""
    pose, rate = stack(c.pose for c in groups), stack(c.pose_rate for c in groups)
    jacobian = ca.mtimes(ca.jacobian(held, pose), ca.jacobian(rate, v))
    state, state_rate = ca.vertcat(t.sx, pose), ca.vertcat(1, rate)
    velocity = ca.vertcat(ca.jtimes(held, state, state_rate), slip)
    acceleration = -ca.jtimes(velocity, state, state_rate) if velocity.numel() else velocity
    rows = ca.vertcat(jacobian, ca.SX(slip.numel(), v.numel()))
    return [ca.sparsify(rows), velocity, acceleration]


def _forces(d: Description, v: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
    """Nonconservative and conservative forces, potential, losses, power released from storage."""
    conservative: Powers = []
    nonconservative: Powers = []
    losses, potential, released = ca.SX(0), ca.SX(0), ca.SX(0)
    followed = [c for c in d.coordinates if not c.twist.numel()]
    turning = {id(c): ca.SX.sym("state_rate", c.pose.numel()) for c in followed}
    for element in d.forces:
        owners = element.parts() or d.coordinates

        def rate(s: ca.SX, owners=owners) -> ca.SX:
            total = rate_of(s, owners, t.sx)
            for group in foreign_states(s, owners, d.coordinates):  # no virtual displacements
                total += ca.jtimes(s, group.pose, turning[id(group)])
            return total

        (conservative if element.conservative else nonconservative).extend(element.powers(rate))
        for velocity, effort in element.dissipation(rate):
            losses -= ca.dot(velocity, effort)
        stored = element.potential()
        if stored is not None:
            potential += stored
            released += 0 if element.conservative else rate(stored)

    def generalised(powers: Powers) -> ca.SX:
        if not powers:
            return ca.SX.zeros(v.numel())
        velocities, efforts = (
            at_ground(d.ground, stack(pair[k] for pair in powers)) for k in range(2)
        )
        return ca.jtimes(velocities, v, efforts, True)

    forces = generalised(nonconservative), generalised(conservative)
    symbols, rates = stack(turning.values()), stack(c.pose_rate for c in followed)
    parts = [*forces, potential, losses, released]
    return tuple(ca.substitute(part, symbols, rates) for part in parts)  # type: ignore[return-value]
