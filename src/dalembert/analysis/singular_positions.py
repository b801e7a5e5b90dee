"""Whether a run broke down at a singular position of the constraints."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.integrators.steps import Steps
from dalembert.model.equations import Equations

NEAR = 0.02
"""Smallest singular value of ``C``, relative to that at the start, that counts as near zero."""
LOST = 1e-6
"""Violation of a constraint from which on a state tells nothing, and a corrected run has failed."""
SAMPLES = 200


def near_singular_position(
    e: Equations, steps: Steps, p: np.ndarray, lost_at: float
) -> tuple[float, float] | None:
    """Time and smallest singular value of ``C`` where the run lost its constraints.

    Looked for from two steps before the last good state to two steps after it, along the
    straight line of its speeds; None where ``C`` keeps its rank.

    Parameters
    ----------
    e : Equations as integrated
    steps : steps taken, ``x = [y; v; …]``
    p : (np,) parameters
    lost_at : time of the first output that violates the constraints
    """
    if not e.constraint_count or not steps.count or not np.all(np.isfinite(steps.x[:, 0])):
        return None
    function = ca.Function(
        "constraints", [e.t, e.y, e.v, e.p], [e.constraints, ca.densify(e.jacobian), e.pose_rate]
    )
    n, k = e.coordinate_count, e.speed_count
    times = np.append(steps.t[: steps.count], steps.end)

    def seen(j: int, after: float = 0.0) -> tuple[np.ndarray, float]:
        """Violation and smallest singular value some time after the beginning of step ``j``."""
        y, v = steps.x[:n, j], steps.x[n : n + k, j]
        moved = y + after * function(times[j], y, v, p)[2].full().ravel()
        violation, jacobian, _ = function(times[j] + after, moved, v, p)
        if not np.all(np.isfinite(jacobian.full())):
            return np.full(1, np.inf), np.inf
        return violation.full(), float(np.linalg.svd(jacobian.full(), compute_uv=False)[-1])

    before = int(np.searchsorted(times, lost_at)) - 1
    good = max(min(_last_good(function, steps, times, n, k, p), before), 0)
    length = steps.h[min(good, steps.count - 1)]
    found = [(seen(j)[1], times[j]) for j in range(max(good - 2, 0), good + 1)]
    # twice the step: a fold is approached like a square root, so a straight line comes late
    for after in np.linspace(0.0, 2 * length, 2 * SAMPLES - 1)[1:]:
        found.append((seen(good, after)[1], times[good] + after))
    smallest, time = min(found)
    return (float(time), smallest) if smallest < NEAR * seen(0)[1] else None


def _last_good(function: ca.Function, steps: Steps, times, n: int, k: int, p) -> int:
    """Number of the last state whose constraints hold."""
    x = steps.x[: n + k]
    violation = function.map(times.size)(times, x[:n], x[n:], np.tile(p[:, None], times.size))[0]
    lost = ~(np.abs(violation.full()).max(axis=0) < LOST)
    return max(int(np.argmax(lost)) - 1, 0) if lost.any() else times.size - 1
