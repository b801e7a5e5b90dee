"""Marching over a grid with changes inside steps, which are located, and the grid gone on with.

Where the equations of a step are not solved, its middle becomes a time of the grid.
"""

from __future__ import annotations

import numpy as np

from dalembert.errors import UnsolvedPart
from dalembert.integrators.marching.march import SHORT_CHUNK, FixedMarch, even_length
from dalembert.integrators.marching.steps import Steps, Watch
from dalembert.integrators.schedule import Grid

CLOSE = 1e-9
"""Part of a step that is left out where a change comes right before a time of the grid."""


class ChangingMarch:
    """Steps to the times of a grid; those across a change are cut there.

    Parameters
    ----------
    fixed : FixedMarch, makes the steps
    """

    def __init__(self, fixed: FixedMarch):
        self.fixed = fixed

    def run(
        self, grid: np.ndarray, x0: np.ndarray, p: np.ndarray, mode: int, watch: Watch
    ) -> Steps:
        """March over the times; stops at the first state that is not finite."""
        recorder, parts, ahead = watch.recorder(x0), [], Grid(grid)
        time, end, message, interrupted = float(grid[0]), float(grid[-1]), "", False
        explained, usual = False, float(np.max(np.diff(grid), initial=0.0))
        try:
            while time < end and not message:
                t, h, flags = self._ahead(ahead, time, CLOSE * usual)
                if self.fixed.at_once(mode):
                    t, h, flags = (column[: even_length(h)] for column in (t, h, flags))
                out, reason, explained = self.fixed.advance(mode, recorder.last, (t, h, flags), p)
                wanted = int(np.sum(h > 0))  # the others are no steps
                good = np.isfinite(out[:, :wanted]).all(axis=0)
                count = wanted if good.all() else int(np.argmin(good))
                message = "" if good.all() else reason or "the state is no longer finite"
                failed = count
                columns, last, following = out[:, :count], recorder.last, mode
                times = np.append(t[:count], t[count - 1 : count] + h[count - 1 : count])
                times = times if count else np.array([time])
                if count:
                    kept, following, why = watch.switch(
                        times, np.column_stack([last, columns]), mode
                    )
                    message = why or (message if kept == count else "")
                    times, columns, count = times[: kept + 1], columns[:, :kept], kept
                crossing = None
                try:
                    crossing = watch.cross(times, np.column_stack([last, columns]), mode)
                except UnsolvedPart as failure:
                    count = failed = failure.number
                    times, columns, message = times[: count + 1], columns[:, :count], str(failure)
                taken = [t[:count], h[:count], flags[:count], np.full(count, mode)]
                if crossing is not None:
                    k, new = crossing.kept, crossing.t.size
                    put = [crossing.t, crossing.h, np.ones(new, bool), crossing.mode]
                    taken = [np.append(a[:k], b) for a, b in zip(taken, put, strict=True)]
                    columns = np.column_stack([columns[:, :k], crossing.x])
                    times = np.append(taken[0], taken[0][-1] + taken[1][-1])
                    following = mode if crossing.after is None else crossing.after
                    message = crossing.reason
                elif message and count == failed and self.fixed.halves(mode, reason):
                    message = "" if ahead.halve(float(t[failed]), float(h[failed])) else message
                parts.append(taken)
                recorder.add(times, columns)
                time, mode = float(times[-1]), following
                watch.progress((time - grid[0]) / (end - grid[0]))
                if count and watch.stop(times, np.column_stack([last, columns]), taken[3]):
                    break
        except KeyboardInterrupt:
            message, interrupted = "interrupted", True
        steps = _collected(parts, float(grid[0]), recorder.last)
        steps.rejected = ahead.halved
        steps.message, steps.interrupted = message, interrupted
        steps.explained = explained and bool(message)
        steps.x = recorder.states(self.fixed.again(steps, p))
        return steps

    def _ahead(self, ahead: Grid, time: float, close: float):
        """Next steps, filled up with some of no length, so that one function does them all."""
        grid = ahead.times
        following = grid[grid > time + close][:SHORT_CHUNK]
        if not following.size or (following.size < SHORT_CHUNK and following[-1] < grid[-1]):
            following = np.append(following, grid[-1])
        times = np.concatenate([[time], following])
        times = np.append(times, np.full(SHORT_CHUNK + 1 - times.size, times[-1]))
        number = np.searchsorted(ahead.given, times[1:] - close)
        flags = (number % self.fixed.period == 0) | (times[1:] >= grid[-1])
        return times[:-1], np.diff(times), flags


def _collected(parts, start: float, last: np.ndarray) -> Steps:
    none = [np.zeros(0), np.zeros(0), np.zeros(0, bool), np.zeros(0, int)]
    t, h, corrected, mode = (np.concatenate(c) for c in zip(none, *parts, strict=True))
    return Steps(t if t.size else np.array([start]), h, last, corrected, mode.astype(int))
