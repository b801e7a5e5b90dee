"""Repetition of a step in machine code with means over its path, which opens gaps at its end."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from dalembert.analysis.nonsmooth.advance import SETTLED, STALLS, is_settled
from dalembert.analysis.nonsmooth.free_bodies.free_body_steps import FreeBodySteps
from dalembert.analysis.nonsmooth.free_bodies.path_contacts import SHAPES
from dalembert.analysis.nonsmooth.mean_gaps import LOBATTO
from dalembert.integrators.contact.step_places import Descriptions, Limits
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
        self._depth, self._slow, self._stalls = np.inf, False, 0

    @property
    def stalls(self) -> bool:
        """Whether repetitions with the same contacts have not opened the gaps."""
        return self._stalls == STALLS

    def settles(self, step: int, depth: float, inexact: float) -> bool:
        """Whether the step is not repeated for a penetration at its end."""
        last, self._depth = self._depth if step == self.step else np.inf, depth
        self._slow = depth > SETTLED * last
        return is_settled(depth, last, self._rounding, inexact)

    def begin(self, step: int) -> None:
        """Begin with a step, unless it is the one of the last repetition."""
        if step != self.step:
            self.step, self.keys, self.count, self._stalls = step, self.keys[:0], 0, 0
        self.count += 1

    def select(
        self, place: PlaceShapes, forces: Callable[[], object], displacement: np.ndarray
    ) -> bool:
        """Select the contacts that are closed at the end, where the shapes are; false without any
        and where repetitions with the same ones have not opened the gaps.

        Those that took no part in the step and are closed at its start, too, are replaced by gaps
        that separate the shapes there or, without any, selected if forces can open them.
        """
        steps = self._steps
        keys, contacts, gaps = steps.contacts()
        before, described = steps.contacts_before()
        closed = gaps < -self._rounding
        added = closed & ~np.isin(keys, before)
        steps.set_path(before, described)
        own = np.isin(before, self.keys) | (steps.path_gaps() < -self._rounding)
        more, others = keys[added], contacts[added]
        steps.set_path(more, others)
        place(0.0, displacement)
        start = steps.path_gaps()
        opened = start >= -self._rounding
        if not opened.all():
            separating = self._separating(place, displacement, others[~opened])
            names = steps.keys_of(separating)
            if not separating.size:
                steps.set_path(np.concatenate([before, more]), np.vstack([described, others]))
                place(0.0, displacement)
                forces()
                opened |= start >= -steps.limits[Limits.LENGTH] * steps.forced() / 2
            fresh = ~np.isin(names, before)
            more = np.concatenate([more[opened], names[fresh]])
            others = np.vstack([others[opened], separating[fresh]])
        last, self.keys = self.keys, np.concatenate([before[own], more])
        steps.set_path(self.keys, np.vstack([described[own], others]))
        unchanged = np.array_equal(np.sort(last), np.sort(self.keys))
        self._stalls = self._stalls + 1 if unchanged and self._slow else 0
        return bool(self.keys.size) and not self.stalls

    def _separating(
        self, place: PlaceShapes, displacement: np.ndarray, described: np.ndarray
    ) -> np.ndarray:
        """Descriptions of gaps between faces and corners of the hulls of some contacts that
        separate these at the start, where the shapes are, and are closed at the end."""
        steps = self._steps
        listed = described[:, Descriptions.PAIR]
        hulls = np.unique(np.column_stack([np.sort(described[:, SHAPES]), listed]), axis=0)
        sides = [side for i, j, pair in hulls for side in ((i, j, pair), (j, i, pair))]
        faces = np.vstack([steps.face_contacts(*side) for side in sides])
        steps.set_path(steps.keys_of(faces), faces)
        opened = steps.path_gaps()
        place(1.0, displacement)
        closed = steps.path_gaps() < -self._rounding
        columns = [Descriptions.SHAPE, Descriptions.FEATURE, Descriptions.OTHER_SHAPE]
        face = np.unique(faces[:, columns], axis=0, return_inverse=True)[1].ravel()
        lowest = np.full(face.max(initial=0) + 1, np.inf)
        np.minimum.at(lowest, face, opened)
        separating: np.ndarray = faces[(lowest[face] >= -self._rounding) & closed]
        return separating

    def average(self, place: PlaceShapes, displacement: np.ndarray) -> None:
        """Means over the path, and distances by which gaps at its end are linear in the
        displacement."""
        steps = self._steps
        for share, weight in LOBATTO.items():
            place(share, displacement)
            shares = self._manifold.path_shares(displacement, share)
            gaps = steps.path_gaps(weight, shares)
        steps.shift_path_gaps(gaps, displacement)
