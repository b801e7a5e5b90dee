"""What must stay positive while gaps are in their phases, and when it ceases to be.

Apart: the gap ``g``. Closed: the normal force ``N``. Sticking: ``μ N − |T|``. Sliding: the slip in
its sense.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.formulations.base import state_symbols
from dalembert.model.contacts import Phase
from dalembert.model.equations import Equations

NEAR = 1e-12
"""Natural sizes by which a guard may be negative without having been crossed."""


class Change(Enum):
    """What happens where a guard reaches zero."""

    TOUCHES = "touches"
    LIFTS = "lifts off"
    SLIPS = "begins to slide"
    STOPS = "stops sliding"


@dataclass(frozen=True, eq=False)
class Guard:
    """One of them.

    Attributes
    ----------
    gap : its number
    change : what happens at zero
    value : SX
    size : its natural size
    """

    gap: int
    change: Change
    value: ca.SX
    size: float


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
            cone = gap.impact.friction * gap.normal - ca.fabs(gap.tangential)
            found.append(Guard(k, Change.SLIPS, cone, force))
        if phase.sense:
            found.append(Guard(k, Change.STOPS, phase.sense * gap.slip, speed))
    return found


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

    @cached_property
    def function(self) -> ca.Function:
        """``(t, x, p)`` → values and their rates along the motion."""
        t, x, p = self._symbols
        values = self._values(t, x, p)
        rates = ca.jtimes(values, ca.vertcat(t, x), ca.vertcat(1, self._rate(t, x, p)))
        found = [ca.densify(values), ca.densify(rates)]
        return ca.Function("guards", [t, x, p], found, {"cse": True})
