"""Replacement of a step that crosses a change: its first part, then transitions."""

from __future__ import annotations

import numpy as np

from dalembert.integrators.marching.steps import Crossing

SIMULTANEOUS = 1e-13
"""Difference of times, relative to the run, below which events are simultaneous."""


class StepReplacement:
    """First part of a step, then transitions, each an entry with its end state."""

    def __init__(self, time: float, x: np.ndarray):
        self.time, self.x = time, x
        self.entries: list[tuple[float, float, np.ndarray, int]] = []

    def add(self, length: float, x: np.ndarray, mode: int) -> None:
        self.entries.append((self.time, length, x, mode))
        self.time, self.x = self.time + length, x

    def crossing(self, accepted: int, following: float, reason: str) -> Crossing:
        t, h, columns, modes = zip(*self.entries, strict=True)
        x = np.column_stack(columns)
        return Crossing(accepted, np.array(t), np.array(h), x, np.array(modes), following, reason)
