"""Rigid contacts: closed gaps as unilateral constraints, with friction.

A closed gap adds the row ``−g = 0``, whose multiplier is the normal force ``N ≥ 0``; a sticking
gap adds ``−slip = 0`` with the friction force ``T`` as multiplier; a sliding gap has the force
``T = −μ N slip/|slip|``, which follows from the multiplier (Pfeiffer and Glocker 1996):

    M v̇ + d = f − Cᵀλ + Wᵀ N + Uᵀ T
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from enum import Enum

import casadi as ca
import numpy as np

from dalembert.model.graph.equations import ConstraintKinematics, Equations
from dalembert.model.graph.rigid_gaps import Branch, RigidGap, contact_forces
from dalembert.model.graph.scales import Scales
from dalembert.symbolic.formulas.expression import stack


class Phase(Enum):
    """Contact state of a gap."""

    APART = "apart"
    SMOOTH = "touching without friction"
    STICKING = "sticking"
    FORWARD = "sliding forwards"
    BACKWARD = "sliding backwards"
    SLIDING = "sliding along a surface"

    @property
    def sense(self) -> int:
        """Sign of the slip along one direction; 0 without slip, or for two directions."""
        return {Phase.FORWARD: 1, Phase.BACKWARD: -1}.get(self, 0)


Phases = tuple[Phase, ...]


class BranchedPhases(tuple[Phase, ...]):
    """Phases of all gaps, with the branches of the distances of closed ones.

    Attributes
    ----------
    branches : of all gaps, empty for open gaps and distances without branches
    """

    branches: tuple[Branch, ...]

    def __new__(cls, phases: Sequence[Phase], branches: Sequence[Branch]) -> BranchedPhases:
        self = super().__new__(cls, phases)
        pairs = zip(phases, branches, strict=True)
        self.branches = tuple(() if phase is Phase.APART else branch for phase, branch in pairs)
        return self

    def __getnewargs__(self) -> tuple:
        return tuple(self), self.branches

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, tuple) or not super().__eq__(other):
            return False
        return self.branches == branches_of(other)

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return super().__hash__()


def branches_of(phases: Phases) -> tuple[Branch, ...]:
    """Branches of the distances of all gaps; empty ones where none are stored."""
    if isinstance(phases, BranchedPhases):
        return phases.branches
    return ((),) * len(phases)


SLOW = 1e-4
"""Threshold for slip along a surface without a clear direction, in natural speeds."""
TINY = 1e-30
"""Regularisation of the norm of a zero vector, in slow slips."""
MIN_SHARE = 0.25
"""Lower limit of the component along the stored slip, relative to it."""


def heading(gap: RigidGap, phase: Phase, scales: Scales) -> ca.SX:
    """Unit vector along which a gap slides.

    Along a surface it is ``s/|s|``, which is singular at zero slip. So the component along the
    stored slip ``r`` is limited from below to a share of ``|r|``, and friction continues smoothly
    across the stop. ``r`` is stored again whenever the slip has halved, so that the limit acts
    only near the stop.
    """
    if phase is not Phase.SLIDING:
        return ca.SX(phase.sense)
    size = ca.sqrt(ca.sumsqr(gap.heading) + (TINY * slow(scales)) ** 2)
    direction = gap.heading / size
    along = ca.dot(gap.slip, direction)
    least = ca.fmax(MIN_SHARE * size, slow(scales))
    limited = gap.slip + (ca.fmax(along, least) - along) * direction
    return limited / ca.sqrt(ca.sumsqr(limited) + (TINY * slow(scales)) ** 2)


def slow(scales: Scales) -> float:
    """Threshold for slip without a clear direction [m/s]."""
    return float(SLOW * scales.length / scales.time)


def touching(e: Equations, phases: Phases) -> Equations:
    """The system with closed gaps as constraints and with the friction of sliding gaps."""
    if not e.contacts:
        return e
    contacts = zip(e.contacts, branches_of(phases), strict=True)
    e = replace(e, contacts=tuple(gap.on(branch) for gap, branch in contacts))
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
    active_forces = {s.element_hash() for s in ca.vertsplit(ca.vertcat(added, rubbing))}
    inactive = [
        s for s in ca.vertsplit(contact_forces(e.contacts)) if s.element_hash() not in active_forces
    ]
    system = replace(
        e,
        constraints=ca.vertcat(e.constraints, held, ca.SX.zeros(slips.numel())),
        nonholonomic=ca.vertcat(e.nonholonomic, ca.SX(held.numel(), 1), slips),
        multiplier=ca.vertcat(e.multiplier, added),
        dropped=ca.vertcat(e.dropped, stack(inactive)),
        scales=replace(
            e.scales, rows=np.append(e.scales.rows, np.full(added.numel(), e.scales.length))
        ),
        follows=(rubbing, follows),
        rubbing=ca.mtimes(ca.jacobian(slip, e.v).T, follows) if sliding else e.rubbing,
        kinematics=None,
    )
    if e.kinematics is not None:
        contact_part = replace(
            e,
            kinematics=None,
            constraints=ca.vertcat(held, ca.SX.zeros(slips.numel())),
            nonholonomic=ca.vertcat(ca.SX(held.numel(), 1), slips),
        )
        rows = (
            contact_part.position_jacobian,
            contact_part.velocity_constraints,
            contact_part.constraint_acceleration,
        )
        k = e.kinematics
        joined = zip((k.jacobian, k.velocity, k.acceleration), rows, strict=True)
        kinematics = (ca.vertcat(*pair) for pair in joined)
        system = replace(system, kinematics=ConstraintKinematics(*kinematics))
    return replace(
        system, powers=system.without_dropped(_powers(e, closed, stuck, (slip, follows)))
    )


def _powers(e: Equations, closed, stuck, sliding: tuple[ca.SX, ca.SX]) -> ca.SX:
    """Dissipated and input power, with losses of friction and power of moving surfaces."""

    def imposed(slip: ca.SX) -> ca.SX:
        return ca.substitute(slip, e.v, ca.SX.zeros(e.speed_count))

    slip, force = sliding
    lost = -ca.dot(force, slip)
    supplied = -sum((g.normal * ca.jacobian(g.distance, e.t) for g in closed), ca.SX(0))
    supplied -= sum((ca.dot(g.tangential, imposed(g.slip)) for g in stuck), ca.SX(0))
    supplied -= ca.dot(force, imposed(slip))
    return e.powers + ca.vertcat(lost, supplied)
