"""Minimum normal speeds at the end of a step of ``AnticipatedImpacts``."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from dalembert.elements.contact.impact_law import ImpactLaw

if TYPE_CHECKING:
    from dalembert.integrators.contact.approach import Approach

CLOSING = 0.5
"""Fraction of a gap that a resting contact closes per step [-]."""


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
        """(n,) minimum speed of contacts under pressure: impacting, resting or separating."""
        approach, before = self._of, self._of.before[:, 0]
        closing = CLOSING * self._gap / approach.h
        stopping, gradual = self._margin(0.0), -np.minimum(closing, approach.forced)
        e = approach.contacts.laws.restitution
        parting = (1 - e) * stopping + e * np.maximum(stopping, -before)  # reversals do no work
        resting = np.where(before > 0, parting, np.maximum(stopping, gradual))
        impact = approach.impacting
        lower = np.where(impact & approach.begins, -np.inf, self.open)  # opened after the step
        return np.maximum(np.where(impact, approach.rebound, resting), lower)
