"""Equations at rest in which states of first order are displaced like positions.

A state has no speed, so that solvers for positions leave it unchanged. Here it has a displacement,
and the balance of forces has the row ``f(y, 0, x) = 0`` for it, so that an equilibrium includes the
states.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from dalembert.model.graph.equations import ConstraintKinematics, Equations
from dalembert.model.graph.inertia import BlockInertia
from dalembert.model.graph.manifold import Manifold

SHIFTS = 0.0, 0.7, -1.3
"""Values of states, from the start and in their sizes, at which rates are examined."""
RESTING = 1e-9
"""Rate at rest that counts as zero, relative to the size and the natural time [-]."""


def with_displaced_states(e: Equations, states: list[int]) -> Equations:
    """Static equations of the same system; itself without states.

    Rates ``f`` enter the forces as ``energy · time/size² · f``, so that their natural size is that
    of the other rows.

    Parameters
    ----------
    e : Equations
    states : numbers of the coordinates of first order that are displaced
    """
    if not states:
        return e
    count, scales = len(states), e.scales
    size = scales.coordinates[states]
    rate, other_rate = ca.SX.sym("state_rate", count), ca.SX.sym("state_acceleration", count)
    pose_rate = ca.SX(e.pose_rate)
    pose_rate[states] = rate
    effort = ca.SX(scales.energy * scales.time / size**2) * e.pose_rate[states]
    nothing = ca.SX(count, 1)
    return replace(
        e,
        v=ca.vertcat(e.v, rate),
        a=ca.vertcat(e.a, other_rate),
        pose_rate=pose_rate,
        inertia=BlockInertia(ca.diagcat(e.inertia.matrix, ca.SX(count, count))),
        bias=ca.vertcat(e.bias, nothing),
        force=ca.vertcat(e.force, effort),
        rubbing=ca.vertcat(e.rubbing, nothing),
        kinematics=_kinematics(e, states),
        manifold=_manifold(e.manifold, states),
        scales=replace(scales, displacements=np.concatenate([scales.displacements, size])),
    )


def _kinematics(e: Equations, states: list[int]) -> ConstraintKinematics | None:
    if e.kinematics is None:
        return None
    columns = ca.jacobian(e.constraints, e.y[states])
    return replace(e.kinematics, jacobian=ca.horzcat(e.kinematics.jacobian, columns))


def _manifold(m: Manifold, states: list[int]) -> Manifold:
    delta = ca.SX.sym("state_delta", len(states))
    moved = ca.SX(m.moved)
    moved[states] = m.y[states] + delta
    return Manifold(
        y=m.y,
        other=m.other,
        delta=ca.vertcat(m.delta, delta),
        moved=moved,
        flat=False,
        bounds=m.bounds,
        between=lambda: ca.vertcat(m.apart, m.other[states] - m.y[states]),
    )


def changing_at_rest(e: Equations, y: np.ndarray, p: np.ndarray) -> list[int]:
    """Numbers of the states whose rates at rest are not always zero, as those of bristles are."""
    states = list(e.states)
    if not states:
        return []
    still = ca.substitute(ca.densify(e.pose_rate[states]), e.v, ca.SX.zeros(e.speed_count))
    function = ca.Function("rates", [e.t, e.y, e.p], [still])
    sizes, changes = e.scales.coordinates[states], np.zeros(len(states), dtype=bool)
    for shift in SHIFTS:
        moved = y.copy()
        moved[states] += shift * sizes
        changes |= np.abs(function(0.0, moved, p).full().ravel()) * e.scales.time > RESTING * sizes
    return [state for state, changing in zip(states, changes, strict=True) if changing]
