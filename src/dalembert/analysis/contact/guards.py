"""What must stay positive while gaps are in their phases, and when it ceases to be.

Apart: the gap ``g``. Closed: the normal force ``N``. Sticking: ``μ N − |T|``. Sliding: the slip in
its sense, over a surface its component along the slip ``r`` remembered. Where ``s`` has turned away
from it by 60°, has halved or is four times as large, it is remembered anew.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.formulations.base import state_symbols
from dalembert.model.contacts import Phase, slow
from dalembert.model.equations import Equations
from dalembert.model.rigid_gaps import RigidGap
from dalembert.model.scales import Scales

NEAR = 1e-12
"""Natural sizes by which a guard may be negative without having been crossed."""
SHRUNK, GROWN = 0.5, 4.0
"""Share of the slip remembered at which it is remembered anew."""
NOTHING = 1e-30
"""Keeps the length of nothing differentiable."""


class Change(Enum):
    """What happens where a guard reaches zero."""

    TOUCHES = "touches"
    LIFTS = "lifts off"
    SLIPS = "begins to slide"
    STOPS = "stops sliding"
    TURNS = "slides on in another direction or at another speed"


@dataclass(frozen=True, eq=False)
class Guard:
    """One of them.

    Attributes
    ----------
    gap : its number
    change : what happens at zero
    value : SX
    size : its natural size
    stiff : beyond its zero a step is no motion, so that its end tells nothing
    """

    gap: int
    change: Change
    value: ca.SX
    size: float
    stiff: bool = False


def guards_of(e: Equations, phases: Sequence[Phase]) -> list[Guard]:
    """The guards of all gaps in these phases."""
    s, found = e.scales, []
    length, speed, force = s.length, s.length / s.time, s.force
    for k, (gap, phase) in enumerate(zip(e.contacts, phases, strict=True)):
        if phase is Phase.APART:
            found.append(Guard(k, Change.TOUCHES, gap.distance, length))
            continue
        found.append(Guard(k, Change.LIFTS, gap.normal, force))
        if phase is Phase.STICKING:
            cone = gap.impact.friction * gap.normal - _length(gap.tangential)
            found.append(Guard(k, Change.SLIPS, cone, force))
        if phase.sense:
            found.append(Guard(k, Change.STOPS, phase.sense * gap.slip, speed))
        if phase is Phase.SLIDING:
            found += _sliding(k, gap, s)
    return found


def _sliding(k: int, gap: RigidGap, scales: Scales) -> list[Guard]:
    """It stops; or its slip has turned, grown or shrunk since it was remembered."""
    speed, near = scales.length / scales.time, slow(scales)
    known, size = _length(gap.heading), _length(gap.slip)
    along = ca.dot(gap.slip, gap.heading) / known
    shrunk = ca.if_else(known > 2 * near, along - SHRUNK * known, speed)
    found = [Guard(k, Change.STOPS, along, speed, True)]
    for value in (2 * along - size + near, GROWN * known - size, shrunk):
        found.append(Guard(k, Change.TURNS, value, speed, True))
    return found


def _length(vector: ca.SX) -> ca.SX:
    """Of a force or a slip, differentiable where there is none."""
    if vector.numel() == 1:
        return ca.fabs(vector)
    return ca.sqrt(ca.sumsqr(vector) + NOTHING**2)


class Guards:
    """The guards of a variant as functions of the state.

    Parameters
    ----------
    e : Equations of the variant
    watched : the guards
    values : ``(t, x, p)`` → their values
    rate : ``(t, x, p) → ẋ``
    """

    def __init__(
        self, e: Equations, watched: Sequence[Guard], values: ca.Function, rate: ca.Function
    ):
        self.watched, self._values, self._rate = list(watched), values, rate
        self._symbols = e.t, state_symbols(e), e.p
        self.near = NEAR * np.array([guard.size for guard in watched])
        self.stiff = np.array([guard.stiff for guard in watched], dtype=bool)

    @cached_property
    def function(self) -> ca.Function:
        """``(t, x, p)`` → values and their rates along the motion."""
        t, x, p = self._symbols
        values = self._values(t, x, p)
        rates = ca.jtimes(values, ca.vertcat(t, x), ca.vertcat(1, self._rate(t, x, p)))
        found = [ca.densify(values), ca.densify(rates)]
        return ca.Function("guards", [t, x, p], found, {"cse": True})
