"""Schedule of the steps ahead of a march, with halving of failed steps."""

from __future__ import annotations

import numpy as np

HALVINGS = 6
"""Maximum number of times a step is halved before the march stops."""


def halving_warnings(count: int) -> list[str]:
    """Warnings of a run that has halved ``count`` steps."""
    steps = f"{count} step{'s' if count > 1 else ''}"
    text = f"Newton's method failed in {steps}, taken in halves instead; use a shorter step"
    return [text] if count else []


class Schedule:
    """Scheduled steps of length ``h`` from ``t``, in order.

    Parameters
    ----------
    t, h : [s]
    corrected, mode : of each step
    """

    def __init__(self, t: np.ndarray, h: np.ndarray, corrected: np.ndarray, mode: np.ndarray):
        self.t, self.h, self.corrected, self.mode = t, h, corrected, mode.copy()
        self.shortest = shortest(h)
        self.halved = 0

    def part(self, begin: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """``t``, ``h``, ``corrected`` of ``count`` steps from ``begin``."""
        part = slice(begin, begin + count)
        return self.t[part], self.h[part], self.corrected[part]

    def halve(self, k: int) -> bool:
        """Replace step k by two halves; False if it is too short to be halved again.

        The second half ends with the correction of the original step. The first half does so
        only if all steps are corrected.
        """
        half = self.h[k] / 2
        if half < self.shortest[k]:
            return False
        self.t = np.insert(self.t, k + 1, self.t[k] + half)
        self.h = np.insert(self.h, k, half)
        self.h[k + 1] = half
        self.corrected = np.insert(self.corrected, k, bool(self.corrected.all()))
        self.mode = np.insert(self.mode, k, self.mode[k])
        self.shortest = np.insert(self.shortest, k, self.shortest[k])
        self.halved += 1
        return True


class Grid:
    """Grid of times that the steps of a march must hit.

    Parameters
    ----------
    times : prescribed times, ascending [s]
    """

    def __init__(self, times: np.ndarray):
        self.prescribed = self.times = times
        self.shortest = shortest(np.diff(times))

    @property
    def halved(self) -> int:
        """Number of times inserted by halving."""
        return self.times.size - self.prescribed.size

    def halve(self, t: float, h: float) -> bool:
        """Insert the midpoint of a step; False if the step is too short to be halved again."""
        middle = t + h / 2
        if h / 2 < self.shortest[np.searchsorted(self.prescribed, middle) - 1]:
            return False
        self.times = np.insert(self.times, np.searchsorted(self.times, middle), middle)
        return True


def shortest(h: np.ndarray) -> np.ndarray:
    """Minimum lengths of the parts of halved steps."""
    return h / (1.5 * 2**HALVINGS)
