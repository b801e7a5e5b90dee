"""Marching over a grid with events inside steps, after which the grid is resumed.

A step in which Newton's method fails is halved: its midpoint is inserted into the grid.
"""

from __future__ import annotations

import numpy as np

from dalembert.errors import UnsolvedPart
from dalembert.integrators.marching.march import SHORT_CHUNK, FixedMarch, even_length
from dalembert.integrators.marching.steps import Grid, Steps, Watch

CLOSE = 1e-9
"""Shortest distance of an event from the next grid time, relative to the step [-]."""


class ChangingMarch:
    """March to the times of a grid; steps across an event are cut there.

    Parameters
    ----------
    fixed : FixedMarch that takes the steps
    """

    def __init__(self, fixed: FixedMarch):
        self.fixed = fixed

    def run(
        self, grid: np.ndarray, x0: np.ndarray, p: np.ndarray, mode: int, watch: Watch
    ) -> Steps:
        """March over the times; stops at the first state that is not finite."""
        recorder, parts, times_ahead = watch.recorder(x0), [], Grid(grid)
        time, end, message, interrupted = float(grid[0]), float(grid[-1]), "", False
        explained, usual = False, float(np.max(np.diff(grid), initial=0.0))
        try:
            while time < end and not message:
                t, h, flags = self._next_steps(times_ahead, time, CLOSE * usual)
                if self.fixed.at_once(mode):
                    t, h, flags = (column[: even_length(h)] for column in (t, h, flags))
                out, reason, explained = self.fixed.advance(mode, recorder.last, (t, h, flags), p)
                lasting = int(np.sum(h > 0))  # steps of zero length are padding
                finite = np.isfinite(out[:, :lasting]).all(axis=0)
                count = lasting if finite.all() else int(np.argmin(finite))
                message = "" if finite.all() else reason or "the state is no longer finite"
                failed = count
                columns, last, following = out[:, :count], recorder.last, mode
                times = np.append(t[:count], t[count - 1 : count] + h[count - 1 : count])
                times = times if count else np.array([time])
                if count:
                    valid, following, stop = watch.switch(
                        times, np.column_stack([last, columns]), mode
                    )
                    message = stop or (message if valid == count else "")
                    times, columns, count = times[: valid + 1], columns[:, :valid], valid
                crossing = None
                try:
                    crossing = watch.cross(times, np.column_stack([last, columns]), mode)
                except UnsolvedPart as failure:
                    count = failed = failure.number
                    times, columns, message = times[: count + 1], columns[:, :count], str(failure)
                part = [t[:count], h[:count], flags[:count], np.full(count, mode)]
                if crossing is not None:
                    k, new = crossing.accepted, crossing.t.size
                    added = [crossing.t, crossing.h, np.ones(new, bool), crossing.mode]
                    part = [np.append(a[:k], b) for a, b in zip(part, added, strict=True)]
                    columns = np.column_stack([columns[:, :k], crossing.x])
                    times = np.append(part[0], part[0][-1] + part[1][-1])
                    following = mode if crossing.after is None else crossing.after
                    message = crossing.reason
                elif message and count == failed and self.fixed.halves(mode, reason):
                    message = (
                        "" if times_ahead.halve(float(t[failed]), float(h[failed])) else message
                    )
                parts.append(part)
                recorder.add(times, columns)
                time, mode = float(times[-1]), following
                watch.progress((time - grid[0]) / (end - grid[0]))
                if count and watch.stop(times, np.column_stack([last, columns]), part[3]):
                    break
        except KeyboardInterrupt:
            message, interrupted = "interrupted", True
        steps = _collect(parts, float(grid[0]), recorder.last)
        steps.rejected = times_ahead.halved
        steps.message, steps.interrupted = message, interrupted
        steps.explained = explained and bool(message)
        steps.x = recorder.states(self.fixed.again(steps, p))
        return steps

    def _next_steps(self, times_ahead: Grid, time: float, close: float):
        """Next steps, padded with steps of zero length to the fixed size of a chunk."""
        grid = times_ahead.times
        following = grid[grid > time + close][:SHORT_CHUNK]
        if not following.size or (following.size < SHORT_CHUNK and following[-1] < grid[-1]):
            following = np.append(following, grid[-1])
        times = np.concatenate([[time], following])
        times = np.append(times, np.full(SHORT_CHUNK + 1 - times.size, times[-1]))
        number = np.searchsorted(times_ahead.prescribed, times[1:] - close)
        flags = (number % self.fixed.period == 0) | (times[1:] >= grid[-1])
        return times[:-1], np.diff(times), flags


def _collect(parts, start: float, last: np.ndarray) -> Steps:
    empty = [np.zeros(0), np.zeros(0), np.zeros(0, bool), np.zeros(0, int)]
    t, h, corrected, mode = (np.concatenate(c) for c in zip(empty, *parts, strict=True))
    return Steps(t if t.size else np.array([start]), h, last, corrected, mode.astype(int))
