"""What is put in place of a step at whose end the motion is another: part of it, then changes."""

from __future__ import annotations

import numpy as np

from dalembert.integrators.marching.steps import Crossing

NOW = 1e-13
"""Time, relative to the run, that counts as none."""


class Passage:
    """Part of a step, then transitions, one column each."""

    def __init__(self, time: float, x: np.ndarray):
        self.time, self.x = time, x
        self.entries: list[tuple[float, float, np.ndarray, int]] = []

    def add(self, length: float, x: np.ndarray, mode: int) -> None:
        self.entries.append((self.time, length, x, mode))
        self.time, self.x = self.time + length, x

    def crossing(self, kept: int, following: float, reason: str) -> Crossing:
        t, h, columns, modes = zip(*self.entries, strict=True)
        x = np.column_stack(columns)
        return Crossing(kept, np.array(t), np.array(h), x, np.array(modes), following, reason)
