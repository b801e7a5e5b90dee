"""Continuation of an assembled position in time and parameters, and its failure.

A branch may end where other assemblies continue; a fixed coordinate may be out of reach where
others are not; or there may be no assembly at all. A search from random starts distinguishes these
cases.
"""

from __future__ import annotations

import numpy as np

from dalembert.model.assembly.recipe import Pinned
from dalembert.symbolic.equations import newton

FOLLOWED = newton.NewtonSettings(
    tolerance=1e-14, max_iterations=25, slack=1e3, halvings=0, growth=4.0
)
SHORTEST = 1e-3
"""Lower limit of a step, in natural units of time."""


def continued(
    pinned: Pinned, y: np.ndarray, p0: np.ndarray, p1: np.ndarray, time: float
) -> tuple[np.ndarray, float]:
    """Continue a position to other parameters by Newton's method, in smaller steps if necessary.

    Parameters
    ----------
    pinned : the square system
    y : its solution for the parameters p0 at the time 0
    p0, p1 : (np,) initial and final parameters
    time : final time

    Returns
    -------
    ndarray, float
        Position, and the share of the path at which it was found, or not found if less than 1.
    """
    reached, step = 0.0, 1.0
    shortest = SHORTEST / (1.0 + abs(time) / pinned.assembler.scales.time)
    while reached < 1.0:
        target = min(1.0, reached + step)
        p = p0 + target * (p1 - p0)
        solution = newton.solve(pinned.at(target * time, p), y, FOLLOWED)
        if solution.accepted:
            reached, y, step = target, solution.x, 2 * step
            continue
        step /= 2
        if step < shortest:
            return solution.x, min(target, np.nextafter(1.0, 0.0))
    return y, 1.0
