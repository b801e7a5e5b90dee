"""States of a run with contacts between the ends of its steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.model.graph.model import Model
from dalembert.results.nonsmooth_motion import ContactRecord
from dalembert.results.recording import Trajectory


def interpolate(model: Model, record: ContactRecord, times: np.ndarray) -> Trajectory:
    """States at times within the steps, linear between their ends."""
    ends = record.ends
    if ends.t.size == 1:
        return replace(ends.some(np.zeros(times.size, dtype=int)), t=times)
    k = np.clip(np.searchsorted(ends.t, times), 1, ends.t.size - 1)
    share = (times - ends.t[k - 1]) / (ends.t[k] - ends.t[k - 1])
    v, work = (s[:, k - 1] + share * (s[:, k] - s[:, k - 1]) for s in (ends.v, ends.work))
    middle = between(model, ends.y[:, k - 1], ends.y[:, k], share)
    y = np.where(share == 1, ends.y[:, k], middle)
    return Trajectory(times, y, v, ends.a[:, k], ends.multiplier[:, k], work)


def between(
    model: Model, y: np.ndarray, other: np.ndarray, share: float | np.ndarray
) -> np.ndarray:
    """Positions at a share of the way from columns ``y`` to ``other``, and states likewise."""
    manifold, states = model.equations.manifold, list(model.equations.states)
    positions = manifold.go(y, share * manifold.lead(y, other))
    if states:
        positions[states] = y[states] + share * (other[states] - y[states])
    return positions
