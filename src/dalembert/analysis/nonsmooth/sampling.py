"""States between the ends of steps."""

from __future__ import annotations

import numpy as np

from dalembert.model.model import Model
from dalembert.results.contact_record import ContactRecord
from dalembert.results.recording import Trajectory


def sampled(model: Model, record: ContactRecord, times: np.ndarray) -> Trajectory:
    """States at times within the steps: straight between their ends."""
    k = np.clip(np.searchsorted(record.t, times) - 1, 0, max(record.loss.size - 1, 0))
    if not record.loss.size:
        none = np.zeros((record.v.shape[0], times.size))
        multiplier = np.zeros((record.multiplier.shape[0], times.size))
        y, v, work = (
            np.repeat(s[:, :1], times.size, axis=1) for s in (record.y, record.v, record.work)
        )
        return Trajectory(times, y, v, none, multiplier, work)
    share = (times - record.t[k]) / (record.t[k + 1] - record.t[k])
    manifold = model.equations.manifold
    way = manifold.lead(record.y[:, k], record.y[:, k + 1])
    v, work = (s[:, k] + share * (s[:, k + 1] - s[:, k]) for s in (record.v, record.work))
    y = np.where(share == 1, record.y[:, k + 1], manifold.go(record.y[:, k], share * way))
    return Trajectory(times, y, v, record.a[:, k], record.multiplier[:, k], work)
