"""Repetition of a step in machine code with means over its path, which opens gaps at its end."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from dalembert.analysis.nonsmooth.free_bodies.free_body_steps import FreeBodySteps
from dalembert.analysis.nonsmooth.mean_gaps import LOBATTO
from dalembert.model.graph.manifold import Manifold


class PlaceShapes(Protocol):
    """Places the shapes at a share of the displacement of a step."""

    def __call__(self, share: float, displacement: np.ndarray) -> None: ...


class PathRepeats:
    """Contacts of one step whose gaps are means over its path, as in ``advance``.

    Parameters
    ----------
    steps : arrays and machine code of a step
    manifold : of the positions
    rounding : penetration that counts as rounding [m]

    Attributes
    ----------
    step : number of the step; -1 before the first one
    keys : of the contacts with means over the path
    count : number of repetitions
    """

    def __init__(self, steps: FreeBodySteps, manifold: Manifold, rounding: float):
        self._steps, self._manifold, self._rounding = steps, manifold, rounding
        self.step, self.keys, self.count = -1, np.zeros(0, dtype=np.int64), 0

    def begin(self, step: int) -> None:
        """Begin with a step, unless it is the one of the last repetition."""
        if step != self.step:
            self.step, self.keys, self.count = step, self.keys[:0], 0
        self.count += 1

    def select(self, place: PlaceShapes, displacement: np.ndarray) -> bool:
        """Select the contacts that are closed at the end, where the shapes are; false if one that
        took no part in the step is closed at its start, too."""
        steps = self._steps
        keys, contacts, gaps = steps.contacts()
        before, described = steps.contacts_before()
        closed = gaps < -self._rounding
        added = closed & ~np.isin(keys, before)
        steps.set_path(before, described)
        own = np.isin(before, self.keys) | (steps.path_gaps() < -self._rounding)
        self.keys = np.concatenate([before[own], keys[added]])
        steps.set_path(self.keys, np.vstack([described[own], contacts[added]]))
        place(0.0, displacement)
        start = steps.path_gaps()[own.sum() :]
        return bool(self.keys.size and (start >= -self._rounding).all())

    def average(self, place: PlaceShapes, displacement: np.ndarray) -> None:
        """Means over the path, and distances by which gaps at its end are linear in the
        displacement."""
        steps = self._steps
        for share, weight in LOBATTO.items():
            place(share, displacement)
            shares = self._manifold.path_shares(displacement, share)
            gaps = steps.path_gaps(weight, shares)
        steps.shift_path_gaps(gaps, displacement)
