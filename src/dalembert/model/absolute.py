"""Absolute coordinates: every body brings its own pose and twist."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.base import Powers, rate_of
from dalembert.elements.planar.body import Ground
from dalembert.model.description import Description
from dalembert.model.equations import Equations
from dalembert.model.inertia import BlockInertia
from dalembert.model.manifold import Manifold
from dalembert.symbolic.expression import stack, t


def at_ground(ground: Ground, expression: ca.SX) -> ca.SX:
    """The expression with the ground at rest in the origin."""
    still = ca.vertcat(ground.twist, ground.acceleration_symbols)
    values = ca.vertcat(ca.SX(list(ground.rest)), ca.SX.zeros(still.numel()))
    return ca.substitute(expression, ca.vertcat(ground.pose, still), values)


def absolute_equations(d: Description) -> Equations:
    """Equations of a mechanism in the coordinates of its bodies.

    ``f = Σ (∂u/∂v)ᵀ Q`` by virtual power over all forces; ``M`` block by block.
    """
    groups = d.coordinates
    y = stack(c.pose for c in groups)
    v = stack(c.twist for c in groups)

    def fixed(expression: ca.SX) -> ca.SX:
        return at_ground(d.ground, expression)

    held = fixed(stack(c.equations for c in d.constraints))
    slip = fixed(stack(c.slip for c in d.constraints))
    multiplier = stack(c.multiplier[k] for c, k in d.rows)
    constraints = ca.vertcat(held, ca.SX.zeros(slip.numel()))
    nonholonomic = ca.vertcat(ca.SX.zeros(held.numel()), slip)
    conservative: Powers = []
    others: Powers = []
    losses, potential, released = ca.SX(0), ca.SX(0), ca.SX(0)
    for element in d.forces:
        owners = element.parts() or groups

        def rate(s: ca.SX, owners=owners) -> ca.SX:
            return rate_of(s, owners, t.sx)

        (conservative if element.conservative else others).extend(element.powers(rate))
        for velocity, effort in element.dissipation(rate):
            losses -= ca.dot(velocity, effort)
        stored = element.potential()
        if stored is not None:
            potential += stored
            released += 0 if element.conservative else rate(stored)

    def generalised(powers: Powers) -> ca.SX:
        velocities, efforts = (fixed(stack(pair[k] for pair in powers)) for k in range(2))
        if not powers:
            return ca.SX.zeros(v.numel())
        return ca.jtimes(velocities, v, efforts, True)

    force, losses, potential = generalised(others), fixed(losses), fixed(potential)
    # on bodies and not from storage: ends that formulas of time move are given power from outside
    applied = ca.dot(force, v) + fixed(released)
    imposed = ca.substitute(nonholonomic, v, ca.SX.zeros(v.numel()))
    imposed += ca.jacobian(constraints, t.sx)
    delivered = ca.dot(multiplier, imposed)  # by drivers: C v = −Φ_t
    masses, gyroscopic = zip(*(c.inertia_by_speeds() for c in groups), strict=True)
    return Equations(
        t=t.sx,
        y=y,
        v=v,
        p=stack(p.sx for p in d.parameters.values()),
        a=stack(c.acceleration_symbols for c in groups),
        multiplier=multiplier,
        pose_rate=stack(c.pose_rate for c in groups),
        inertia=BlockInertia(ca.diagcat(*masses)),
        bias=ca.densify(stack(gyroscopic)),
        force=force + generalised(conservative),
        constraints=constraints,
        nonholonomic=nonholonomic,
        potential=potential,
        manifold=Manifold.of(groups),
        powers=ca.vertcat(losses, applied + losses + delivered),
    )
