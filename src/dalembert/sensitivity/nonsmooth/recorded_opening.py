"""Corrections of positions, repeated with their active gaps."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction import PositionCorrection, PositionResidual
from dalembert.symbolic.equations import newton

SAME = 1e-6
"""Permitted difference of a repeated state from the recorded one, relative to its size [-]."""


class RecordedOpening(PositionCorrection):
    """Position correction that records its active gaps.

    Attributes
    ----------
    active : for each iteration, keys of the active gaps and their distances
    """

    def __init__(self, step: ContactStep, t: float, open_gaps: bool):
        super().__init__(step, t, open_gaps)
        self.active: list[tuple[np.ndarray, np.ndarray]] = []

    def step(self, x: np.ndarray, residual: newton.Residual) -> np.ndarray:
        assert isinstance(residual, PositionResidual)
        shift, gaps = self.shift(x, residual)
        keys, lifts = np.zeros(0, dtype=int), np.zeros(0)
        if gaps is not None:
            remainder = np.abs(gaps.distance + gaps.normals @ shift)
            active = np.flatnonzero(remainder <= SAME * -gaps.distance.min())
            active = active[np.argsort(gaps.key[active])]
            keys, lifts = gaps.key[active], gaps.distance[active]
        self.active.append((keys, lifts))
        return shift
