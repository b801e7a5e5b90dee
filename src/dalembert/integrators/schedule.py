"""The steps a march is going to take, some of which are halved where they fail."""

from __future__ import annotations

import numpy as np

HALVINGS = 6
"""Times that a step is halved before the march ends."""


def told_halves(count: int) -> list[str]:
    """What a run is warned of that has halved steps so often."""
    steps = f"{count} step{'s' if count > 1 else ''}"
    text = f"Newton's method failed in {steps}, taken in halves instead; use a shorter step"
    return [text] if count else []


class Schedule:
    """Steps of length ``h`` from ``t``, in the order in which they are taken.

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
        """``t``, ``h``, ``corrected`` of steps."""
        some = slice(begin, begin + count)
        return self.t[some], self.h[some], self.corrected[some]

    def halve(self, k: int) -> bool:
        """Put two steps in the place of the k-th; False where that has been done too often.

        The second one ends as the whole step would have, where all steps do both of them.
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
    """Times that steps lead to, whatever happens between them.

    Parameters
    ----------
    given : the times, in order [s]
    """

    def __init__(self, given: np.ndarray):
        self.given = self.times = given
        self.shortest = shortest(np.diff(given))

    @property
    def halved(self) -> int:
        """How many times have been put in."""
        return self.times.size - self.given.size

    def halve(self, t: float, h: float) -> bool:
        """Put in the middle of a step; False where that has been done too often."""
        middle = t + h / 2
        if h / 2 < self.shortest[np.searchsorted(self.given, middle) - 1]:
            return False
        self.times = np.insert(self.times, np.searchsorted(self.times, middle), middle)
        return True


def shortest(h: np.ndarray) -> np.ndarray:
    """The least lengths of the parts of steps."""
    return h / (1.5 * 2**HALVINGS)
