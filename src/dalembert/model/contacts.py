"""Rigid contacts: gaps that are apart, or closed and then constraints of one side.

A closed gap adds the row ``−g = 0``, whose multiplier is the normal force ``N ≥ 0``; one that
sticks adds ``−slip = 0`` with the friction force ``T`` as multiplier; one that slides has the force
``T = −μ N slip/|slip|``, which follows from the multiplier (Pfeiffer and Glocker 1996):

    M v̇ + d = f − Cᵀλ + Wᵀ N + Uᵀ T
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from enum import Enum

import casadi as ca
import numpy as np

from dalembert.model.equations import ConstraintKinematics, Equations
from dalembert.model.rigid_gaps import RigidGap, contact_forces
from dalembert.model.scales import Scales
from dalembert.symbolic.formulas.expression import stack


class Phase(Enum):
    """What a gap is doing."""

    APART = "apart"
    SMOOTH = "touching without friction"
    STICKING = "sticking"
    FORWARD = "sliding forwards"
    BACKWARD = "sliding backwards"
    SLIDING = "sliding along a surface"

    @property
    def sense(self) -> int:
        """Of the slip along one direction; 0 where there is none, or two directions."""
        return {Phase.FORWARD: 1, Phase.BACKWARD: -1}.get(self, 0)


Phases = tuple[Phase, ...]

SLOW = 1e-4
"""Natural speeds below which a slip over a surface hardly has a direction."""
NOTHING = 1e-30
"""Keeps the length of nothing differentiable."""
LEAST = 0.25
"""Share of the slip remembered that its component along it is not let below."""


def heading(gap: RigidGap, phase: Phase, scales: Scales) -> ca.SX:
    """Unit vector along which a gap slides.

    Over a surface it is ``s/|s|``. Where the slip goes to zero, or begins there, this is no
    function of ``s`` to integrate over; so its component along the slip ``r`` remembered is not let
    below a share of ``|r|``, and friction goes on smoothly across the stop. On the way to it ``r``
    is remembered anew whenever the slip has halved, so that this share acts in the end only.
    """
    if phase is not Phase.SLIDING:
        return ca.SX(phase.sense)
    size = ca.sqrt(ca.sumsqr(gap.heading) + (NOTHING * slow(scales)) ** 2)
    way = gap.heading / size
    along = ca.dot(gap.slip, way)
    least = ca.fmax(LEAST * size, slow(scales))
    seen = gap.slip + (ca.fmax(along, least) - along) * way
    return seen / ca.sqrt(ca.sumsqr(seen) + (NOTHING * slow(scales)) ** 2)


def slow(scales: Scales) -> float:
    """Speed of a slip that hardly has a direction."""
    return float(SLOW * scales.length / scales.time)


def touching(e: Equations, phases: Sequence[Phase]) -> Equations:
    """The same system with closed gaps as constraints and with the friction of those that slide."""
    if not e.contacts:
        return e
    pairs = list(zip(e.contacts, phases, strict=True))
    closed = [gap for gap, phase in pairs if phase is not Phase.APART]
    stuck = [gap for gap, phase in pairs if phase is Phase.STICKING]
    slides = [(gap, phase) for gap, phase in pairs if phase.sense or phase is Phase.SLIDING]
    sliding = [(gap, heading(gap, phase, e.scales)) for gap, phase in slides]
    held, slips = stack(-gap.distance for gap in closed), stack(-gap.slip for gap in stuck)
    added = ca.vertcat(stack(g.normal for g in closed), stack(g.tangential for g in stuck))
    follows = stack(-g.impact.friction * g.normal * along for g, along in sliding)
    rubbing = stack(g.tangential for g, _ in sliding)
    slip = stack(g.slip for g, _ in sliding)
    known = {s.element_hash() for s in ca.vertsplit(ca.vertcat(added, rubbing))}
    none = [s for s in ca.vertsplit(contact_forces(e.contacts)) if s.element_hash() not in known]
    made = replace(
        e,
        constraints=ca.vertcat(e.constraints, held, ca.SX.zeros(slips.numel())),
        nonholonomic=ca.vertcat(e.nonholonomic, ca.SX(held.numel(), 1), slips),
        multiplier=ca.vertcat(e.multiplier, added),
        dropped=ca.vertcat(e.dropped, stack(none)),
        scales=replace(
            e.scales, rows=np.append(e.scales.rows, np.full(added.numel(), e.scales.length))
        ),
        follows=(rubbing, follows),
        rubbing=ca.mtimes(ca.jacobian(slip, e.v).T, follows) if sliding else e.rubbing,
        known=None,
    )
    if e.known is not None:
        alone = replace(
            e,
            known=None,
            constraints=ca.vertcat(held, ca.SX.zeros(slips.numel())),
            nonholonomic=ca.vertcat(ca.SX(held.numel(), 1), slips),
        )
        rows = alone.position_jacobian, alone.velocity_constraints, alone.constraint_acceleration
        whole = (e.known.jacobian, e.known.velocity, e.known.acceleration)
        joined = (ca.vertcat(*pair) for pair in zip(whole, rows, strict=True))
        made = replace(made, known=ConstraintKinematics(*joined))
    return replace(made, powers=made.without_dropped(_powers(e, closed, stuck, (slip, follows))))


def _powers(e: Equations, closed, stuck, sliding: tuple[ca.SX, ca.SX]) -> ca.SX:
    """Energy lost and put in, with what friction loses and surfaces that move of themselves do."""

    def imposed(slip: ca.SX) -> ca.SX:
        return ca.substitute(slip, e.v, ca.SX.zeros(e.speed_count))

    slip, force = sliding
    lost = -ca.dot(force, slip)
    given = -sum((g.normal * ca.jacobian(g.distance, e.t) for g in closed), ca.SX(0))
    given -= sum((ca.dot(g.tangential, imposed(g.slip)) for g in stuck), ca.SX(0))
    given -= ca.dot(force, imposed(slip))
    return e.powers + ca.vertcat(lost, given)
