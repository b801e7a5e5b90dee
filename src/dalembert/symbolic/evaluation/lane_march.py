"""Marches of many sets of arguments: side by side in lanes, and groups of lanes in threads."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

import casadi as ca
import numpy as np

from dalembert.symbolic.evaluation.backends import Backend
from dalembert.symbolic.evaluation.columns import Columns
from dalembert.symbolic.evaluation.lanes import LaneColumns, SideBySide
from dalembert.symbolic.once import once

MEMORY = 1 << 20
"""Bytes of states of one call, so that they stay near the processor."""


@once
def _in_lanes(backend: Backend, function: ca.Function, fixed: tuple[int, ...]) -> SideBySide | None:
    """The function in lanes, made once: batches are taken in parts."""
    return LaneColumns(function, True, fixed).side_by_side


class LaneMarch:
    """A function ``(x, …, q) → x`` called again and again, for many sets.

    Parameters
    ----------
    function : of carried ``x``, columns that all sets share, and fixed ``q``
    columns : what evaluates it for one set
    backend : of both
    work : columns that are asked for, of all sets
    """

    def __init__(self, function: ca.Function, columns: Columns, backend: Backend, work: int):
        self.fixed = (function.n_in() - 1,)
        self._alone, self.size = columns, function.numel_in(0)
        self._lanes = None
        if backend.side_by_side(columns.function, function, work):
            self._lanes = _in_lanes(backend, function, self.fixed)
        if self._lanes is None:
            columns.announce(work)

    @property
    def width(self) -> int:
        """Sets in one call."""
        return 1 if self._lanes is None else self._lanes.lanes

    @property
    def threaded(self) -> bool:
        """Whether calls let others run."""
        return self._lanes is not None or self._alone.compiled

    @property
    def report(self) -> str:
        return self._alone.report if self._lanes is None else f"LLVM, {self.width} lanes"

    def shared(self, *columns: np.ndarray) -> list[np.ndarray]:
        """(count,) columns that all sets have, as ``run`` takes them."""
        if self._lanes is None:
            return list(columns)
        return [np.repeat(column, self.width).reshape(-1, self.width).T for column in columns]

    def run(
        self,
        x: np.ndarray,
        shared: list[np.ndarray],
        q: np.ndarray,
        chosen: np.ndarray,
        count: int | None = None,
    ) -> np.ndarray:
        """States of at most ``width`` sets.

        Parameters
        ----------
        x, q : (sets, …) first states, and fixed numbers
        shared : columns that all sets have, by ``shared``, or (sets, rows, count) of their own
        chosen : numbers of the columns that are kept, in order
        count : columns, where there are no shared ones

        Returns
        -------
        (sets, chosen, size)
        """
        count, kept = shared[0].shape[-1] if count is None else count, []
        longest = int(np.clip(MEMORY // (8 * self.size * self.width), 100, 5000))
        for begin in range(0, count, longest):
            part = slice(begin, min(begin + longest, count))
            inside = chosen[(chosen >= part.start) & (chosen < part.stop)] - begin
            wanted = np.append(inside, part.stop - begin - 1)
            columns = [column[..., part] for column in shared]
            found = self._called(part.stop - begin, x, columns, q, wanted)
            x = found[:, -1]
            kept.append(found[:, :-1])
        return np.concatenate(kept, axis=1)

    def _called(
        self, count: int, x: np.ndarray, shared: list[np.ndarray], q: np.ndarray, wanted: np.ndarray
    ) -> np.ndarray:
        if self._lanes is None:
            found = []
            for k in range(len(x)):
                own = [column if column.ndim == 1 else column[k] for column in shared]
                found.append(self._alone(count, x[k], *own, q[k])[0][:, wanted].T)
            return np.array(found)
        lanes = np.minimum(np.arange(self.width), len(x) - 1)
        same = [column if column.ndim == 2 else column[lanes] for column in shared]
        (states,) = self._lanes.group(count, [x[lanes], *same, q[lanes]], wanted)
        return states[: len(x)].transpose(0, 2, 1)


def in_groups(
    work: Callable[[np.ndarray], None],
    sets: np.ndarray,
    width: int,
    workers: int,
    report: Callable[[float], None],
) -> np.ndarray:
    """Do ``work`` for groups of sets, in threads; which sets are done, also after an interruption.

    Returns
    -------
    (sets,) bool
    """
    groups = [sets[k : k + width] for k in range(0, len(sets), width)]
    done = np.zeros(len(sets), dtype=bool)
    try:
        if workers < 2:
            for number, group in enumerate(groups):
                work(group)
                done[number * width : (number + 1) * width] = True
                report((number + 1) / len(groups))
            return done
        _threaded(work, groups, done, width, workers, report)
    except KeyboardInterrupt:
        pass
    return done


def _threaded(work, groups: list[np.ndarray], done: np.ndarray, width: int, workers: int, report):
    """Parts of several groups, so that threads seldom ask for more."""
    share = int(np.clip(len(groups) // (16 * workers), 1, 64))

    def several(begin: int) -> int:
        for number in range(begin, min(begin + share, len(groups))):
            work(groups[number])
            done[number * width : (number + 1) * width] = True
        return begin

    pool = ThreadPoolExecutor(workers)
    try:
        waiting: set[Future[int]] = {pool.submit(several, k) for k in range(0, len(groups), share)}
        whole = len(waiting)
        while waiting:
            finished, waiting = wait(waiting, timeout=0.5, return_when=FIRST_COMPLETED)
            for one in finished:
                one.result()
            report(1 - len(waiting) / whole)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)
