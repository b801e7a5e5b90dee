"""Choice between an explicit and an implicit method during a march with error control."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

STIFF, MOST = 1.0, 0.75
"""Value of ``h ρ`` that indicates a limit by stability, and the share of steps that have it."""
WORTH = 500
"""Explicit steps left to the end from which on the implicit method is prepared."""
EXPLICIT, IMPLICIT = 64, 16
"""Attempts in a period, at the end of which the method is chosen."""
SHORTEST, LONGEST = 2, 256
"""Periods until the other method is tried, at first and after it has failed often."""


@dataclass
class MethodChoice:
    """Which of two methods goes on, by how far each advances for its cost.

    A period of explicit attempts that are limited by stability counts as stiff. After some of these
    the implicit method is tried for a period; it stays while it advances faster for its cost than
    the explicit one did. After some implicit periods the explicit method is tried again. The number
    of periods before a trial doubles with each trial that fails.

    Parameters
    ----------
    end : of the run [s]
    implicit : mode → whether its method is implicit
    cost : mode → operations of an attempt
    other : mode → the same equations in a mode of the other method; the mode itself if it does not
        suit them
    """

    end: float
    implicit: Callable[[int], bool]
    cost: Callable[[int], float]
    other: Callable[[int], int]
    advances: dict[bool, float] = field(default_factory=dict)
    """Mean advance of an attempt [s], of either method where it was last used."""
    paces: dict[bool, float] = field(default_factory=dict)
    """The same for an operation."""
    waits: dict[bool, int] = field(default_factory=lambda: {True: SHORTEST, False: SHORTEST})
    """Periods of the other method before this one is tried."""
    periods: int = 0
    """Periods, of the explicit method stiff ones, since the method was chosen."""
    trial: bool = False

    def attempts(self, mode: int) -> int:
        """Attempts of the next period."""
        return IMPLICIT if self.implicit(mode) else EXPLICIT

    def after(self, record: np.ndarray, mode: int, failure: str) -> tuple[int, float | None, str]:
        """The mode after a period, the length of its first step if known, and why it ends there.

        Parameters
        ----------
        record : (5, n) time, length, error, acceptance and stiffness of each attempt
        failure : of the march in this period; of a method on trial it is no reason to end
        """
        if failure and not (self.trial and self.implicit(mode)):
            return mode, None, failure
        return *self._following(record, mode), ""

    def _following(self, record: np.ndarray, mode: int) -> tuple[int, float | None]:
        record = record[:, record[1] > 0]
        if not record.shape[1] and not self.trial:
            return mode, None
        implicit, taken = self.implicit(mode), record[3] > 0.5
        late = np.arange(taken.size) >= 3 * taken.size // 4  # those before it adapt the step
        advance = float(np.sum(record[1, late & taken]) / max(1, np.sum(late)))
        self.advances[implicit], self.paces[implicit] = advance, advance / self.cost(mode)
        if implicit or (taken.any() and np.mean(record[4, taken] > STIFF) >= MOST):
            self.periods += 1
        else:
            self.periods = 0
        tried, self.trial = self.trial, False
        if tried and self._slower(implicit):  # so it was tried in vain
            self.waits[implicit] = min(2 * self.waits[implicit], LONGEST)
            return self._change(mode)
        if tried:
            self.waits = {True: SHORTEST, False: SHORTEST}
        if implicit and self._slower(True):
            return self._change(mode)
        if self.periods < self.waits[not implicit]:
            return mode, None
        if not implicit and self.end - record[0, -1] < WORTH * advance:
            return mode, None
        following, length = self._change(mode)
        self.trial = following != mode
        return following, length

    def _slower(self, implicit: bool) -> bool:
        """This method advances less for its cost than the other one did."""
        return self.paces[implicit] < self.paces.get(not implicit, 0.0)

    def _change(self, mode: int) -> tuple[int, float | None]:
        self.periods, following = 0, self.other(mode)
        if following == mode:
            return mode, None
        return following, self.advances.get(self.implicit(following))
