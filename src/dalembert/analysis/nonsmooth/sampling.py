"""States between the ends of steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.model.model import Model
from dalembert.results.nonsmooth_motion import ContactRecord
from dalembert.results.recording import Trajectory


def sampled(model: Model, record: ContactRecord, times: np.ndarray) -> Trajectory:
    """States at times within the steps: straight between their ends."""
    ends = record.ends
    if ends.t.size == 1:
        return replace(ends.some(np.zeros(times.size, dtype=int)), t=times)
    k = np.clip(np.searchsorted(ends.t, times), 1, ends.t.size - 1)
    share = (times - ends.t[k - 1]) / (ends.t[k] - ends.t[k - 1])
    manifold = model.equations.manifold
    way = manifold.lead(ends.y[:, k - 1], ends.y[:, k])
    v, work = (s[:, k - 1] + share * (s[:, k] - s[:, k - 1]) for s in (ends.v, ends.work))
    y = np.where(share == 1, ends.y[:, k], manifold.go(ends.y[:, k - 1], share * way))
    return Trajectory(times, y, v, ends.a[:, k], ends.multiplier[:, k], work)
