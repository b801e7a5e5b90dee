"""Choice between an explicit and an implicit method during a march with error control."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

STIFF, STIFF_SHARE = 1.0, 0.75
"""Threshold of ``h ρ`` for a stiff step, and of the share of stiff steps in a stiff period [-]."""
MINIMUM_REMAINING = 500
"""Threshold of explicit steps left to the end for compiling the implicit method."""
EXPLICIT, IMPLICIT = 64, 16
"""Attempts per period of either method; the method is chosen at the end of a period."""
SHORTEST, LONGEST = 2, 256
"""Initial and maximum number of periods before the other method is tried."""


@dataclass
class MethodChoice:
    """Choice between two methods by their advance in time per operation.

    A period of explicit attempts that are limited by stability counts as stiff. After a number of
    stiff periods the implicit method is tried for one period; it continues while it advances faster
    per operation than the explicit one did. After a number of implicit periods the explicit method
    is tried again. The number of periods before a trial doubles with each failed trial.

    Parameters
    ----------
    end : of the run [s]
    implicit : mode → whether its method is implicit
    cost : mode → operations of an attempt
    other : mode → mode of the other method for the same equations; the mode itself if there is none
    """

    end: float
    implicit: Callable[[int], bool]
    cost: Callable[[int], float]
    other: Callable[[int], int]
    advances: dict[bool, float] = field(default_factory=dict)
    """Length of the first step [s] of either method, its mean advance when last used."""
    paces: dict[bool, float] = field(default_factory=dict)
    """Mean advance per operation [s]."""
    waits: dict[bool, int] = field(default_factory=lambda: {True: SHORTEST, False: SHORTEST})
    """Periods of the other method before this method is tried."""
    periods: int = 0
    """Periods since the method was chosen; of the explicit method only stiff periods."""
    trial: bool = False

    def attempts(self, mode: int) -> int:
        """Attempts of the next period."""
        return IMPLICIT if self.implicit(mode) else EXPLICIT

    def after(self, record: np.ndarray, mode: int, failure: str) -> tuple[int, float | None, str]:
        """The mode after a period, the length of its first step if known, and the reason to stop.

        Parameters
        ----------
        record : (5, n) time, length, error, acceptance and stiffness of each attempt
        failure : reason why the march failed; ignored for an implicit method on trial
        """
        if failure and not (self.trial and self.implicit(mode)):
            return mode, None, failure
        return *self._next_mode(record, mode), ""

    def _next_mode(self, record: np.ndarray, mode: int) -> tuple[int, float | None]:
        record = record[:, record[1] > 0]
        if not record.shape[1] and not self.trial:
            return mode, None
        implicit, accepted = self.implicit(mode), record[3] > 0.5
        late = np.arange(accepted.size) >= 3 * accepted.size // 4  # earlier attempts adapt the step
        advance = float(np.sum(record[1, late & accepted]) / max(1, np.sum(late)))
        self.paces[implicit] = advance / self.cost(mode)
        if advance > 0:
            self.advances[implicit] = advance
        elif record.shape[1]:  # all late attempts were rejected: continue with the last length
            self.advances[implicit] = float(record[1, -1])
        if implicit or (accepted.any() and np.mean(record[4, accepted] > STIFF) >= STIFF_SHARE):
            self.periods += 1
        else:
            self.periods = 0
        trial, self.trial = self.trial, False
        if trial and self._slower(implicit):
            self.waits[implicit] = min(2 * self.waits[implicit], LONGEST)
            return self._change(mode)
        if trial:
            self.waits = {True: SHORTEST, False: SHORTEST}
        if implicit and self._slower(True):
            return self._change(mode)
        if self.periods < self.waits[not implicit]:
            return mode, None
        if not implicit and self.end - record[0, -1] < MINIMUM_REMAINING * advance:
            return mode, None
        following, length = self._change(mode)
        self.trial = following != mode
        return following, length

    def _slower(self, implicit: bool) -> bool:
        """True if this method advances less per operation than the other one did."""
        return self.paces[implicit] < self.paces.get(not implicit, 0.0)

    def _change(self, mode: int) -> tuple[int, float | None]:
        self.periods, following = 0, self.other(mode)
        if following == mode:
            return mode, None
        return following, self.advances.get(self.implicit(following))
