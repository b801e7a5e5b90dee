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


def with_displaced_states(e: Equations) -> Equations:
    """Static equations of the same system; itself if it has no states.

    Rates ``f`` enter the forces as ``energy · time/size² · f``, so that their natural size is that
    of the other rows.
    """
    states = list(e.states)
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
