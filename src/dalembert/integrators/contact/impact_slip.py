"""Slips in an increment of an impact, and lengths of increments that end where a slip does."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dalembert.integrators.contact.contacts import FrictionProblem

SHORTEST, TURNING = 2.0**-26, 2.0**-10
"""Increments that are not divided, relative to a phase: at an end of slip, and where a slip changes
its direction by more than ``STRAIGHT``, its cosine, in space [-]."""
STRAIGHT, CONSTANT = 0.995, 1 - 1e-9
GROWTH = 4.0
"""Growth of increments [-]."""
NEAR, PASSING = 4.0, 1.5
"""Slip that counts as ending, relative to rounding, and length of the increment that passes its
end, relative to the linear extrapolation [-]."""
PRESSED = 1e-6
"""Normal impulse of a contact whose slip counts, relative to the largest of an increment [-]."""


@dataclass
class Slip:
    """Slips of pressing contacts in an increment.

    Attributes
    ----------
    ends, bends, turns : whether one ends or turns back; changes its direction so much that an
        increment is divided, or at all
    remaining : extrapolated length of increments until the first one ends, relative to this one
    near : whether that slip is close to rounding
    margin : share of the remaining length in which it is as close as that
    ended : (n, groups) mask of the slips that end or turn back
    """

    ends: bool = False
    bends: bool = False
    turns: bool = False
    remaining: float = np.inf
    near: bool = False
    margin: float = 0.0
    ended: np.ndarray = field(default_factory=lambda: np.zeros((0, 0), dtype=bool))


class Pace:
    """Lengths of increments: search for ends of slip, and division where slips bend.

    Attributes
    ----------
    share : next increment, relative to the phase
    """

    def __init__(self) -> None:
        self.share, self._end, self._passes = 1.0, np.inf, False

    def is_too_long(self, slip: Slip) -> bool:
        """Whether an increment has to be divided."""
        ends = slip.ends and not self._passes and self.share > SHORTEST
        if ends:
            self._end = self.share
        elif slip.ends or not slip.bends or self.share <= TURNING:
            return False
        self.share /= 2
        return True

    def accept(self, slip: Slip) -> None:
        """Select the next increment, up to the end of a slip that lies within ``_end``."""
        self._end -= self.share
        if self._end <= SHORTEST:  # no slip has ended there, it only changed its direction
            self._end = np.inf
        if slip.ends or self._passes:
            self.share, self._end, self._passes = 1.0, np.inf, False
            return
        if self.share <= SHORTEST or not np.isfinite(self._end):
            self.share, self._end = min(1.0, GROWTH * self.share), np.inf
            return
        remaining = slip.remaining * self.share
        self._passes = slip.near and remaining <= self._end
        if self._passes:
            self.share = PASSING * remaining
        elif remaining < self._end:
            self.share = (1 - slip.margin) * remaining
        else:
            self.share = self._end
        self.share = max(self.share, SHORTEST)


def slip_of(
    problem: FrictionProblem,
    velocity: np.ndarray,
    impulses: np.ndarray,
    after: np.ndarray,
    rounding: float,
) -> Slip:
    """Slips of the pressing contacts in an increment.

    Parameters
    ----------
    problem : FrictionProblem
    velocity, after : (n, k) before and after the increment
    impulses : (n, k) of the increment
    rounding : slip that counts as zero [m/s]
    """
    slip, pressure = Slip(), impulses[:, 0]
    slip.ended = np.zeros((pressure.size, len(problem.groups)), dtype=bool)
    for number, (components, friction) in enumerate(problem.discs):
        before, end = velocity[:, components], after[:, components]
        length, size = (np.linalg.norm(u, axis=1) for u in (before, end))
        counts = (length > rounding) & (friction > 0)
        counts &= pressure > PRESSED * pressure.max(initial=0.0)
        before, end, length, size = (u[counts] for u in (before, end, length, size))
        along = (before * end).sum(axis=1) / length
        slip.ended[counts, number] = (size <= rounding) | (along < 0)
        slip.bends |= bool((along < STRAIGHT * size).any())
        slip.turns |= bool((along < CONSTANT * size).any())
        slower = (along > 0) & (along < length)
        along, length = along[slower], length[slower]
        ends = along / (length - along)
        if ends.min(initial=np.inf) < slip.remaining:
            first = int(ends.argmin())
            slip.remaining, slip.near = float(ends[first]), along[first] < NEAR * rounding
            slip.margin = float(min(1.0, NEAR * rounding / along[first]) / 2)
    slip.ends = bool(slip.ended.any())
    return slip
