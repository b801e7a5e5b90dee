"""Following an assembled position along a change of time and parameters, on its branch."""

from __future__ import annotations

import numpy as np

from dalembert.model.assembly.recipe import Pinned
from dalembert.symbolic.equations import newton

FOLLOWED = newton.NewtonSettings(
    tolerance=1e-14, max_iterations=25, slack=1e3, halvings=0, growth=4.0
)
SHORTEST = 1e-3
"""Shortest step from one position to another, in natural units of time."""


def continued(
    pinned: Pinned, y: np.ndarray, p0: np.ndarray, p1: np.ndarray, time: float
) -> tuple[np.ndarray, float]:
    """Newton from one position to that of other parameters; in smaller steps if need be.

    Parameters
    ----------
    pinned : the square system
    y : its solution for the parameters p0 at the time 0
    p0, p1 : (np,) parameters, at first and in the end
    time : at which the position is wanted

    Returns
    -------
    position, and the share of the way at which it is, or at which none was found
    """
    reached, step = 0.0, 1.0
    shortest = SHORTEST / (1.0 + abs(time) / pinned.assembler.scales.time)
    while reached < 1.0:
        target = min(1.0, reached + step)
        p = p0 + target * (p1 - p0)
        found = newton.solve(pinned.at(target * time, p), y, FOLLOWED)
        if found.accepted:
            reached, y, step = target, found.x, 2 * step
            continue
        step /= 2
        if step < shortest:
            return found.x, min(target, np.nextafter(1.0, 0.0))
    return y, 1.0
