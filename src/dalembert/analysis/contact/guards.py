"""Guards of contact phases: functions that are positive while a gap stays in its phase.

Apart: the gap ``g``. Closed: the normal force ``N``. Sticking: ``μ N − |T|``. Sliding: the slip in
its sense, over a surface its component along the stored slip ``r``. The stored slip is renewed when
the slip ``s`` has turned by 60°, has halved or is four times as large. On a branch of its distance:
the switching functions on which the branch depends, with their signs.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.events import locate
from dalembert.formulations.base import state_symbols
from dalembert.model.graph.contacts import Phase, Phases, branches_of, slow
from dalembert.model.graph.equations import Equations
from dalembert.model.graph.rigid_gaps import ANY, Branch, GapSwitches, RigidGap
from dalembert.model.graph.scales import Scales

NEAR = 1e-12
"""Tolerance of a negative guard, in natural sizes."""
SHRUNK, GROWN = 0.5, 4.0
"""Slip, relative to the stored slip, at which the stored slip is renewed."""
SMALLEST = 1e-30
"""Offset that makes the length of a zero vector differentiable."""
HALVINGS = 50
"""Upper limit of the halvings of a step that begins at a zero."""
ZERO = 1e-9
"""Time to the zero of a function, relative to the run, below which it is zero."""
GRAZED = 1e-6
"""The same for a guard whose zero is the instant of a change."""


class Change(Enum):
    """Event at a zero of a guard."""

    TOUCHES = "touches"
    LIFTS = "lifts off"
    SLIPS = "begins to slide"
    STOPS = "stops sliding"
    TURNS = "slides on in another direction or at another speed"
    PASSES = "passes an end of a face"


@dataclass(frozen=True, eq=False)
class Guard:
    """A function that is positive while a gap stays in its phase.

    Attributes
    ----------
    gap : number of the gap
    change : event at the zero
    value : SX
    size : natural size of the value
    stiff : a step beyond the zero is not a motion, so its end has no significance
    switch : number of the switch of the distance, for the end of a branch
    after : side of this switch beyond the zero
    idle : not a guard; the value of a switch that others depend on
    """

    gap: int
    change: Change
    value: ca.SX
    size: float
    stiff: bool = False
    switch: int = -1
    after: int = 0
    idle: bool = False


def guards_of(e: Equations, phases: Phases, switches: Sequence[GapSwitches]) -> list[Guard]:
    """Guards of all gaps in the given phases; ``switches`` are those of their distances."""
    s, guards = e.scales, []
    length, speed, force = s.length, s.length / s.time, s.force
    for k, (gap, phase) in enumerate(zip(e.contacts, phases, strict=True)):
        if phase is Phase.APART:
            guards.append(Guard(k, Change.TOUCHES, gap.distance, length))
            continue
        guards.append(Guard(k, Change.LIFTS, gap.normal, force))
        if phase is Phase.STICKING:
            cone = gap.impact.friction * gap.normal - _length(gap.tangential)
            guards.append(Guard(k, Change.SLIPS, cone, force))
        if phase.sense:
            guards.append(Guard(k, Change.STOPS, phase.sense * gap.slip, speed))
        if phase is Phase.SLIDING:
            guards += _sliding(k, gap, s)
    for k, branch in enumerate(branches_of(phases)):
        if branch:
            guards += _branch_ends(k, switches[k], branch, length)
    return guards


def _branch_ends(k: int, switches: GapSwitches, branch: Branch, size: float) -> list[Guard]:
    """Guards of the branch of a distance, then the switches on which their values depend."""
    ending, others = switches.watched(branch)
    guards = []
    for j, value in zip([*ending, *others], switches.functions([*ending, *others]), strict=True):
        idle = j not in ending
        value = value if idle or branch[j] else -value
        after = ANY if idle else 1 - branch[j]
        guards.append(Guard(k, Change.PASSES, value, size, False, j, after, idle))
    return guards


def _sliding(k: int, gap: RigidGap, scales: Scales) -> list[Guard]:
    """Guards of a sliding gap: end of sliding, and renewal of the stored slip."""
    speed, near = scales.length / scales.time, slow(scales)
    stored, size = _length(gap.heading), _length(gap.slip)
    along = ca.dot(gap.slip, gap.heading) / stored
    shrunk = ca.if_else(stored > 2 * near, along - SHRUNK * stored, speed)
    guards = [Guard(k, Change.STOPS, along, speed, True)]
    for value in (2 * along - size + near, GROWN * stored - size, shrunk):
        guards.append(Guard(k, Change.TURNS, value, speed, True))
    return guards


def _length(vector: ca.SX) -> ca.SX:
    """Length of a force or slip, differentiable at zero."""
    if vector.numel() == 1:
        return ca.fabs(vector)
    return ca.sqrt(ca.sumsqr(vector) + SMALLEST**2)


class Guards:
    """Guards of a variant as functions of the state.

    Parameters
    ----------
    e : Equations of the variant
    watched : the guards
    values : ``(t, x, p)`` → values of the guards
    rate : ``(t, x, p) → ẋ``
    """

    def __init__(
        self, e: Equations, watched: Sequence[Guard], values: ca.Function, rate: ca.Function
    ):
        self.watched, self._values, self._rate = list(watched), values, rate
        self._symbols = e.t, state_symbols(e), e.p
        sizes = [np.inf if guard.idle else guard.size for guard in watched]
        self.near = NEAR * np.array(sizes)
        self.stiff = np.array([guard.stiff for guard in watched], dtype=bool)
        self.idle = np.array([guard.idle for guard in watched], dtype=bool)

    @cached_property
    def function(self) -> ca.Function:
        """``(t, x, p)`` → values and their rates along the motion."""
        t, x, p = self._symbols
        values = self._values(t, x, p)
        rates = ca.jtimes(values, ca.vertcat(t, x), ca.vertcat(1, self._rate(t, x, p)))
        outputs = [ca.densify(values), ca.densify(rates)]
        return ca.Function("guards", [t, x, p], outputs, {"cse": True})


def first_zero(value: Callable[[float], float], inside: float, longest: float) -> float | None:
    """The first zero of a function that is smooth only before it; None without a zero."""
    before = inside
    for k in range(HALVINGS - 1, -1, -1):
        length = inside + (longest - inside) * 2.0**-k
        if not value(length) > 0:
            return locate(value, before, length)
        before = length
    return None


def zero_guard(
    guards: Guards, number: int, values: np.ndarray, rates: np.ndarray, span: float
) -> tuple[int, Guard, bool]:
    """The guard that is zero at a change, and whether its zero determines the instant.

    The switching function that ends a branch of a distance may jump, where another one is zero. A
    guard that is grazed has no instant that moves with the parameters.

    Parameters
    ----------
    guards : of the phases before the change
    number : guard that becomes negative
    values, rates : of all guards at the change
    span : length of the run [s]
    """
    guard = guards.watched[number]
    if guard.change is not Change.PASSES:
        return number, guard, bool(abs(values[number]) <= GRAZED * span * abs(rates[number]))
    zero = (np.abs(values) <= ZERO * span * np.abs(rates)) & (rates != 0)
    if zero[number]:
        return number, guard, True
    for i, other in enumerate(guards.watched):
        if zero[i] and other.change is Change.PASSES and other.gap == guard.gap:
            after = int(rates[i] > 0) if other.idle else other.after
            return i, replace(other, after=after), True
    return number, guard, False


def chattering(recent: Sequence[Guard], name: str, t: float) -> str:
    """Message where the phases of a gap change without end."""
    if any(guard.change is Change.PASSES for guard in recent):
        return (
            f"{name} moves between faces again and again at t = {t:.9g} s, as in a dent whose "
            "faces are one contact; give each face its own Contact, or use solve_nonsmooth with "
            "Collisions"
        )
    return (
        f"{name} opens and closes again and again at t = {t:.9g} s; give it restitution=0, or a "
        "compliant contact, or use solve_nonsmooth, which does not locate impacts"
    )
