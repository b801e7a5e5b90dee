"""Estimated error of a run, relative to its motion."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

SMALL = 1e-2
"""Minimum size of a range or speed, relative to the largest of the same unit."""
REST = 1e-8
"""Minimum size relative to natural sizes; below it a moving entry is rounding."""


@dataclass(frozen=True)
class ErrorEstimate:
    """Largest estimated error over a run.

    Attributes
    ----------
    share : relative to the range of the coordinate, or to the largest magnitude of the speed;
        infinite where the repetition with other steps fails
    name : coordinate or speed with the largest error
    time : instant of the largest error, or of the failure [s]
    repeated : length of the steps of the repetition, relative to those of the run, as text
    """

    share: float
    name: str
    time: float
    repeated: str = ""

    def __str__(self) -> str:
        return self.text

    @property
    def text(self) -> str:
        if not self.name:
            return f"not known, because steps {self.repeated} as long fail at t = {self.time:.6g} s"
        of_motion = f"{self.share:.2g} times" if self.share >= 10 else f"{self.share:.2g} of"
        return f"{of_motion} its range or largest value, in {self.name} at t = {self.time:.6g} s"


def largest_error(
    error: np.ndarray,
    sizes: np.ndarray,
    names: Sequence[str],
    times: np.ndarray,
    repeated: str = "",
) -> ErrorEstimate | None:
    """Largest error relative to the motion; None where nothing moves.

    Parameters
    ----------
    error : (n, K) of coordinates or speeds at ``times``
    sizes : (n,) of the motion (``motion_sizes``)
    names : of the coordinates and speeds
    repeated : length of the steps of the repetition, relative to those of the run, as text
    """
    moving = np.flatnonzero(sizes > 0)
    if not moving.size:
        return None
    share = np.abs(error[moving]) / sizes[moving, None]
    share = np.where(np.isfinite(share), share, np.inf)
    row, k = np.unravel_index(int(np.argmax(share)), share.shape)
    return ErrorEstimate(float(share[row, k]), names[moving[row]], float(times[k]), repeated)


def motion_sizes(ranges: np.ndarray, units: Sequence[str], natural: np.ndarray) -> np.ndarray:
    """Ranges of a motion, bounded below by a share of the largest of the same unit and by rounding
    relative to the natural sizes."""
    kinds = np.array(units)
    largest = [ranges[kinds == unit].max() for unit in units]
    sizes = np.maximum(ranges, SMALL * np.array(largest))
    return np.maximum(sizes, np.where(sizes > 0, REST * natural, 0.0))
