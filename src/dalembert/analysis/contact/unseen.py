"""Rigid contacts in analyses that look at joints and forces alone."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.model.model import Model
from dalembert.results.recording import Trajectory

INSIDE = 1e-9
"""Negative gap, in natural lengths, that is told."""


def negative_gaps(model: Model, s: Trajectory, p: np.ndarray) -> list[str]:
    """Which gaps a result leaves negative, for nothing kept them from it."""
    e, found = model.all_equations, []
    if not (e.contacts and s.t.size):
        return []
    gaps = ca.densify(ca.vertcat(*(gap.distance for gap in e.contacts)))
    function = ca.Function("gaps", [e.t, e.y, e.p], [gaps]).map(s.t.size)
    values = function(s.t, s.y, np.tile(p[:, None], s.t.size)).full()
    for gap, row in zip(e.contacts, values, strict=True):
        k = int(np.argmin(row))
        if row[k] < -INSIDE * e.scales.length:
            found.append(
                f"the gap of {gap.name} is {row[k]:.3g} at t = {s.t[k]:.6g} s: this analysis does "
                "not see rigid contacts; solve_dynamics does"
            )
    return found
