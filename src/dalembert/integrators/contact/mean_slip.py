"""Friction of spatial contacts that slide throughout a step.

    P_T = −μ P_N s / |s|,      s = u_T⁺ + u_T⁻

opposes the mean of the slip over the step, with an error of second order where its direction turns.
A contact whose slip is small, or that stops within the step, has ``s = u_T⁺`` instead: a stop is a
condition at the end.
"""

from __future__ import annotations

import numpy as np

from dalembert.integrators.contact.approach import Approach, Offsets
from dalembert.integrators.contact.contacts import lengths_of

SLIDES = 0.5
"""Least slip of a contact that slides throughout a step, by the change of normal speeds by forces
[-]."""
STOPS = 1.0
"""Change of the slip by which a contact stops or reverses, relative to the slip before [-]."""
SLIP = slice(1, 3)
"""Components of the slip."""


class MeanSlip:
    """Contacts of a step that slide throughout it.

    Parameters
    ----------
    approach : contacts and their velocities before the step
    theta : of the scheme; the mean is that of the midpoint rule, ``θ = 1/2``
    """

    def __init__(self, approach: Approach, theta: float):
        self._approach, contacts = approach, approach.contacts
        self._slides = np.zeros(contacts.count, dtype=bool)
        if theta == 0.5 and contacts.groups[:1] == (2,):
            slip = lengths_of(approach.before[:, SLIP])
            self._slides = ~approach.impacting & (slip > SLIDES * approach.nearby)

    def first(self, offsets: Offsets) -> Offsets:
        """Offsets with ``u_T⁻`` of contacts that slide."""
        offsets[self._slides, SLIP] = self._approach.before[self._slides, SLIP]
        return offsets

    def again(self, offsets: Offsets, after: np.ndarray) -> Offsets:
        """Offsets for the computed velocities: those of Newton's law where contacts stop or
        reverse."""
        before = self._approach.before[:, SLIP]
        change = lengths_of(after[:, SLIP] - before)
        stops = self._slides & (change > STOPS * lengths_of(before))
        if not stops.any():
            return offsets
        self._slides &= ~stops
        changed = offsets.copy()
        changed[stops, SLIP] = self._approach.newton()[stops, SLIP]
        return changed
