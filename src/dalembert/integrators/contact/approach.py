"""Contacts and their velocities before a step."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy

from dalembert.elements.contact.impact_law import ImpactLaw

if TYPE_CHECKING:
    from dalembert.integrators.contact.contacts import Contacts

Offsets = np.ndarray
"""(n, k) offsets of the velocities after a step: ``u⁺ + offset`` satisfies the conditions."""
CLOSING = 0.55
"""Fraction of a gap that a resting contact closes per step, by its speed at the end [-]. With a
half, this would be the speed itself that permits a stop in the next step."""
SLOW = 1.9
"""Threshold of the speed of an impact, relative to the change of speed by forces in a step [-]. No
fall of round length has it: from rest over ``k a h²`` it is ``√(2 k)``, after ``n`` steps ``n``."""
SLOWEST = 1e-6
"""Least part of a gap that an impact closes in a step, by its speed at the contact [-]. Bodies that
fall together have relative speeds by rounding, which forces in the step do not change."""


@dataclass(frozen=True, eq=False)
class Approach:
    """Contacts and their velocities before a step.

    Attributes
    ----------
    contacts : Contacts
    before, free : (n, k) relative velocities at the start, and at the end without impulses
    h : step [s], of each contact if they act in different ones
    longest : longest step that may follow [s], of each contact if they act in different steps
    begins : True in the first step, which no earlier step could prepare for an impact
    rounding : gap that counts as closed [m]
    struck : (n, k) relative velocities after impacts at the start; None without any
    hit : (n,) mask of the contacts of these impacts
    rest : step whose change of speed by forces an impact exceeds, if it is longer [s]
    """

    contacts: Contacts
    before: np.ndarray
    free: np.ndarray
    h: float | np.ndarray
    longest: float | np.ndarray
    begins: bool = False
    rounding: float = 0.0
    struck: np.ndarray | None = None
    hit: np.ndarray | bool = False
    rest: float = 0.0

    @cached_property
    def fastest(self) -> float:
        """The largest component of a velocity [m/s]."""
        linear = self.contacts.linear
        return float(np.abs([self.before[:, :linear], self.free[:, :linear]]).max(initial=0.0))

    def newton(self) -> Offsets:
        """Restitution, ``u_N⁺ ≥ −e u_N⁻`` and ``u_T⁺ + e_T u_T⁻`` (Newton; Moreau 1988)."""
        laws, linear = self.contacts.laws, self.contacts.linear
        offsets = np.zeros_like(self.before)
        offsets[:, 0] = laws.restitution * self.before[:, 0]
        offsets[:, 1:linear] = laws.tangential[:, None] * self.before[:, 1:linear]
        return offsets

    @property
    def struck_from(self) -> np.ndarray:
        """(n, k) velocities before impacts at the start, where the directions are.

        An impulse does the work of the mean of these velocities and those after it.
        """
        return np.asarray(self.before + self.contacts.turning)

    @cached_property
    def forced(self) -> float:
        """The largest change of a normal velocity by forces in the step [m/s]."""
        return float(np.abs(self._change).max(initial=0.0))

    @cached_property
    def _change(self) -> np.ndarray:
        """(n,) change of the normal speeds by forces in the step [m/s]."""
        start = self.before if self.struck is None else self.struck
        return np.asarray(self.free[:, 0] - start[:, 0])

    @cached_property
    def nearby(self) -> np.ndarray:
        """(n,) largest change of a normal speed by forces in the step at the same bodies [m/s]."""
        change, contacts = np.abs(self._change), self.contacts
        if isinstance(contacts.directions, np.ndarray):
            return largest_moving(contacts.moved_speeds, change)
        return largest_nearby(contacts.directions, change)

    @cached_property
    def fast(self) -> np.ndarray:
        """(n,) mask of the gaps with ``√(u_N² + 2 a g)``, the speed at the contact, of an impact.

        ``a`` is the acceleration towards the contact. Steps of the midpoint rule conserve this
        speed in a flight, so that all of its steps agree.
        """
        fall, gap = np.maximum(-self._change, 0.0), np.maximum(self.contacts.distance, 0.0)
        squared = self.before[:, 0] ** 2 + 2 * fall * gap / self.h
        slow = SLOW * np.maximum(self.rest / self.h, 1.0)
        least = np.maximum(slow * self.nearby, SLOWEST * gap / self.h)
        return np.asarray(squared > least**2)

    @cached_property
    def least(self) -> LeastSpeeds:
        """Minimum normal speeds at the end of the step."""
        return LeastSpeeds(self)

    @cached_property
    def impacting(self) -> np.ndarray:
        """(n,) mask of the gaps that close faster than forces on their bodies change speeds."""
        return np.asarray((self.before[:, 0] < 0) & self.fast)

    @property
    def is_impact(self) -> bool:
        """Whether a gap closes faster than forces change speeds."""
        return bool(self.impacting.any())

    @property
    def slow(self) -> np.ndarray:
        """(n,) mask of the gaps that do not open faster than forces change speeds."""
        return np.asarray(self.before[:, 0] <= SLOW * self.forced)

    @property
    def resting(self) -> np.ndarray:
        """(n,) mask of the gaps that forces can close in a step, and that move no faster."""
        near = self.contacts.distance <= self.h * self.forced / 2
        return np.asarray(near & (np.abs(self.before[:, 0]) <= SLOW * self.forced))

    @property
    def rebound(self) -> np.ndarray:
        """(n,) normal speeds after an impact, by Newton's law or those of impacts at the start.

        Forces in the step do not reduce the latter, up to the speeds before: contacts do no work.
        """
        before = self.before[:, 0]
        newton = -self.contacts.laws.restitution * before
        if self.struck is None:
            return newton
        limited = np.clip(self.struck[:, 0], 0.0, np.maximum(-before, 0.0))
        return np.where(self.hit, limited, newton)


class LeastSpeeds:
    """Minimum normal speeds of contacts at the end of a step, each computed once.

    Parameters
    ----------
    approach : contacts and their velocities before the step
    """

    def __init__(self, approach: Approach):
        self._of = approach
        self._gap = np.maximum(approach.contacts.distance, 0.0)
        self._after_half = self._gap + approach.h * approach.before[:, 0] / 2

    @cached_property
    def open(self) -> np.ndarray:
        """(n,) ``s``, the minimum speed that leaves the gap open."""
        return -2 * self._of.contacts.distance / self._of.h - self._of.before[:, 0]

    def _margin(self, restitution: np.ndarray | float) -> np.ndarray:
        """Minimum speed that permits an impact in the next step, ``g⁺ ≥ −(1−e) H u_N⁺/2``, where
        ``H`` is the longest step."""
        room = (self._of.h + (1 - restitution) * self._of.longest) / 2
        return np.maximum(-self._after_half / room, self.open)

    @cached_property
    def room(self) -> np.ndarray:
        """(n,) minimum speed that permits an impact in the next step, or a stop: without
        restitution if the contact is slow, and by other laws than Newton's."""
        laws = self._of.contacts.laws
        rebounds = laws.follows(ImpactLaw.NEWTON) & self._of.fast
        restitution = np.where(rebounds, laws.restitution, 0.0)
        margin = self._margin(restitution)
        closes = self._of.free[:, 0] < margin
        if not closes.any():
            return margin
        return np.where(closes & self._passes(restitution), self.open, margin)

    def _passes(self, restitution: np.ndarray) -> np.ndarray:
        """(n,) mask of the gaps that need no room for an impact: as their directions turn, they
        remain open without impulses for the time that it would take, though their linear parts
        close."""
        approach, free = self._of, self._of.free[:, 0]
        turning = np.broadcast_to(approach.contacts.turning, approach.before.shape)[:, 0]
        ahead = (1 - restitution) * approach.longest / 2
        gap = self._gap + approach.h * (approach.before[:, 0] + free) / 2
        gap = gap + ahead * (free + ahead * turning / approach.h)
        return np.asarray((turning > 0) & (gap >= 0))

    @cached_property
    def bounce(self) -> np.ndarray:
        """(n,) minimum speed of contacts under pressure: impacting, resting or separating; between
        the latter where they approach more slowly than resting ones do, without a jump."""
        approach, before = self._of, self._of.before[:, 0]
        closing = CLOSING * self._gap / approach.h
        stopping, gradual = self._margin(0.0), -np.minimum(closing, approach.forced)
        e, parts = approach.contacts.laws.restitution, np.maximum(before, 0.0)
        parting = (1 - e) * stopping + e * np.maximum(stopping, -parts)  # reversals do no work
        share = np.clip(1 + before / np.where(closing > 0, closing, 1.0), 0.0, 1.0)
        share = np.where(closing > 0, share, before > 0)
        slow = (1 - share) * np.maximum(stopping, gradual) + share * parting
        impact = approach.impacting
        lower = np.where(impact & approach.begins, -np.inf, self.open)  # opened after the step
        return np.maximum(np.where(impact, approach.rebound, slow), lower)


def largest_moving(moved: np.ndarray, change: np.ndarray) -> np.ndarray:
    """``largest_nearby`` of contacts whose bodies have the speeds ``moved`` (n, n_v), a mask."""
    of_speeds = np.where(moved, change[:, None], 0.0).max(axis=0, initial=0.0)
    return np.maximum(change, np.where(moved, of_speeds, 0.0).max(axis=1, initial=0.0))


def largest_nearby(directions: scipy.sparse.csr_array, change: np.ndarray) -> np.ndarray:
    """(n,) largest of the values (n,) of contacts that share a body with each one.

    Parameters
    ----------
    directions : (n k, n_v) of their impulses
    """
    rows, n = scipy.sparse.csr_array(directions), change.size
    width = rows.shape[0] // max(n, 1)
    contact = np.repeat(np.arange(n).repeat(width), np.diff(rows.indptr))
    of_speeds, largest = np.zeros(rows.shape[1]), change.copy()
    np.maximum.at(of_speeds, rows.indices, change[contact])
    np.maximum.at(largest, contact, of_speeds[rows.indices])
    return largest
