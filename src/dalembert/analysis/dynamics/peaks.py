"""Largest value of a measure between the steps of a run with error control.

The measure is evaluated at dense outputs, and more densely where its curvature permits a larger
value. The instant of the maximum is the root of its rate ``ṁ`` along the discrete motion
(Brent), or an end of a smooth stretch: of the run, or of the motion before and after an impact or
a switch. At a root a change of the instant is of second order, so the gradient at the fixed instant
is exact; samples at impacts and switches move with their instant (``MovingSide``).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.dynamics.dense_outputs import dense, jumps_between, sagittas
from dalembert.analysis.dynamics.flow import Flow
from dalembert.analysis.dynamics.step_quadrature import INSIDE
from dalembert.analysis.events import locate
from dalembert.analysis.output_places import OutputPlaces
from dalembert.results.motion import Motion
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once

ROOM = 3.0
"""Safety factor of the parabolic bound of a measure within an interval."""
FLAT = 1e-3
"""Bound above the samples, relative to the range of the measure, below which none are added."""
ROUNDS, MOST = 8, 4000
"""Upper limits of the halvings of intervals, and of the evaluations added by them."""
LOCATED = 8
"""Upper limit of the number of local maxima whose instants are located."""
NEARLY = 1e-6
"""Fraction at the beginning of a part of a step that the search for a root excludes."""
TOGETHER = 1e-8
"""Difference of times, relative to the run, below which samples belong to one instant."""
SAME = 1e-10
"""Difference of maxima, relative to the largest, below which they are equal."""


@once
def peaks(motion: Motion, measure: str | Expression, sign: float) -> Motion:
    """The motion where ``sign`` times a measure is largest; at several instants if they tie."""
    dense_motion = dense(motion)
    if not dense_motion.record.dense:
        return motion
    return PeakSearch(dense_motion, measure, sign).motion_at_peaks


class PeakSearch:
    """Search for the largest value of a measure.

    Parameters
    ----------
    motion : at dense outputs
    measure : scalar
    sign : −1 for the smallest value
    """

    def __init__(self, motion: Motion, measure: str | Expression, sign: float):
        self.motion, self.sign = motion, sign
        self.measure = motion.expression(measure)
        self.record = motion.record
        self.kernel, self.steps, self.p = self.record.kernel, self.record.steps, motion.parameters
        self.flow = Flow(self.kernel, self.steps, self.p)
        b = self.record.places
        self.index, self.length = b.index.copy(), b.length.copy()
        self.modes, self.time = np.full(b.index.size, -1), motion.time.copy()
        self._move_sides()
        self.m = self._values(np.arange(self.time.size))

    @property
    def motion_at_peaks(self) -> Motion:
        """The motion at the instant of the largest value, or at several of the same value."""
        if np.all(np.isfinite(self.m)):
            self._refine()
            self._locate()
        if np.isnan(self.m).any():
            return self._at(np.flatnonzero(np.isnan(self.m)))
        best = np.flatnonzero(self.m >= self.m.max() - SAME * np.abs(self.m).max())
        # of samples at one instant, the sample that moves with it
        new = np.diff(self.time[best], prepend=-np.inf) > TOGETHER * np.ptp(self.motion.time)
        groups = np.split(best, np.flatnonzero(new)[1:])
        chosen = [max(group, key=lambda k: (self.modes[k], self.m[k])) for group in groups]
        return self._at(np.array(chosen))

    # samples ---------------------------------------------------------------------------
    def _at(self, some: np.ndarray) -> Motion:
        places = OutputPlaces(self.index[some], self.length[some], self.modes[some])
        trajectory = self.kernel.trajectory(self.time[some], self.steps, places, self.p)
        record = replace(self.record, places=places, dense=False)
        return replace(self.motion, trajectory=trajectory, record=record)

    def _values(self, some: np.ndarray) -> np.ndarray:
        return np.asarray(self.sign * self._at(some).values(self.measure), dtype=float)

    def _add(self, index: np.ndarray, length: np.ndarray) -> None:
        """Add samples inside steps in temporal order."""
        first = self.time.size
        self.index, self.length = np.append(self.index, index), np.append(self.length, length)
        self.time = np.append(self.time, self.steps.t[index] + length)
        self.modes = np.append(self.modes, np.full(index.size, -1))
        self.m = np.append(self.m, self._values(np.arange(first, self.time.size)))
        order = np.argsort(self.time, kind="stable")
        for name in ("index", "length", "time", "modes", "m"):
            setattr(self, name, getattr(self, name)[order])

    def _move_sides(self) -> None:
        """Let samples on both sides of impacts and switches move with their instants.

        In a run repeated with other parameters, samples passed by a moved instant are dropped.
        """
        steps, valid = self.steps, np.ones(self.time.size, dtype=bool)
        for k, change in self.kernel.crossings(steps):
            following = k + 1
            if (k and steps.h[k - 1] == 0) or not steps.h[following : following + 1].any():
                continue  # another change at the same instant
            mode, size = int(steps.mode[k]), change.step.state_size
            before = self._before(k)
            after = np.flatnonzero((self.index == following) & (self.length == 0))
            location = self.kernel.variants[self.kernel.side(mode, False)].location
            instant = steps.t[k] + float(location(steps.t[k], steps.x[:size, k], self.p)[0])
            valid &= ~np.where(self.index < k, self.time > instant, False)
            valid &= ~np.where(self.index > k, self.time < instant, False)
            for samples, after_change in ((before, False), (after, True)):
                self.index[samples], self.length[samples] = k, 0.0
                self.modes[samples] = self.kernel.side(mode, after_change)
                self.time[samples] += instant - steps.t[k]
                valid[samples] = True
        for name in ("index", "length", "time", "modes"):
            setattr(self, name, getattr(self, name)[valid])

    def _before(self, k: int) -> np.ndarray:
        """Number of the sample before a change."""
        samples = np.flatnonzero((self.index == k) & (self.length == 0))
        if samples.size or not k:
            return samples
        last = self.length > (1 - 2 * INSIDE) * self.steps.h[k - 1]
        return np.flatnonzero((self.index == k - 1) & last)

    # refinement --------------------------------------------------------------------
    @property
    def _intervals(self) -> tuple[np.ndarray, np.ndarray]:
        """Lengths of the intervals, and whether they are jumps."""
        return np.diff(self.time), jumps_between(self.steps, self.time, self.index)

    def _bounds(self) -> np.ndarray:
        """Upper bound of the measure above the ends of each interval."""
        intervals, jump = self._intervals
        spacing = np.where(jump, 1.0, intervals)
        return np.where(jump, 0.0, ROOM * sagittas(self.m[None], spacing, jump))

    def _refine(self) -> None:
        """Halve intervals in which the measure may exceed the current maximum."""
        budget = MOST
        for _ in range(ROUNDS):
            bounds, size = self._bounds(), np.ptp(self.m)
            top = np.maximum(self.m[1:], self.m[:-1]) + bounds
            refined = np.flatnonzero((top > self.m.max()) & (bounds > FLAT * size))
            if not refined.size or refined.size > budget:
                return
            budget -= refined.size
            index, begin, end = self._inside(refined)
            self._add(index, (begin + end) / 2)

    def _inside(self, intervals: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Step, beginning and end of intervals between neighbouring samples."""
        t, count = self.steps.t, self.steps.count
        middle = (self.time[intervals] + self.time[intervals + 1]) / 2
        index = np.searchsorted(t[:count], middle, side="right") - 1
        begin, end = (self.time[intervals + k] - t[index] for k in (0, 1))
        return index, np.maximum(begin, 0.0), np.minimum(end, self.steps.h[index])

    # the instant -----------------------------------------------------------------------
    def _locate(self) -> None:
        """Add the roots of the rate beside the largest samples."""
        bounds = self._bounds()
        margin = np.maximum(np.append(bounds, 0.0), np.append(0.0, bounds))
        upper_bound = self.m + margin
        intervals, jump = self._intervals
        lower = np.append(self.m[1:] <= self.m[:-1], True) | np.append(jump, True)
        lower &= np.append(True, self.m[:-1] <= self.m[1:]) | np.append(True, jump)
        tops = np.flatnonzero(lower & (upper_bound >= self.m.max()))
        tops = tops[np.argsort(-upper_bound[tops], kind="stable")][:LOCATED]
        index: list[int] = []
        length: list[float] = []
        for interval in sorted({k for top in tops for k in (top - 1, top)}):
            if not 0 <= interval < intervals.size or jump[interval]:
                continue
            (k,), (begin,), (end,) = self._inside(np.array([interval]))
            if (root := self._root(int(k), float(begin), float(end))) is not None:
                index.append(int(k))
                length.append(root)
        if index:
            self._add(np.array(index), np.array(length))

    def _root(self, k: int, begin: float, end: float) -> float | None:
        """Length at which the measure stops rising within a part of a step; None if it does not."""

        def rate(length: float) -> float:
            return self.sign * self.flow.rate(self.measure, k, length)

        begin = max(begin, NEARLY * end)  # some methods have no rate at the beginning
        if not (begin < end and rate(begin) > 0 > rate(end)):
            return None
        return locate(rate, begin, end)
