"""Parallel evaluation of many sets of arguments, in lanes of the processor and in threads."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

import casadi as ca
import numpy as np

from dalembert.symbolic.evaluation.backends import Backend
from dalembert.symbolic.evaluation.columns import Columns
from dalembert.symbolic.evaluation.lanes import LaneColumns, SideBySide
from dalembert.symbolic.once import once

MEMORY = 1 << 20
"""Size of the states of one call [bytes]; chosen to fit the cache."""
BLOCK = 4000
"""Columns of one call of ``in_blocks``."""


@once
def _in_lanes(backend: Backend, function: ca.Function, fixed: tuple[int, ...]) -> SideBySide | None:
    """The function in lanes, cached for the parts of a batch."""
    return LaneColumns(function, True, fixed).side_by_side


class LaneMarch:
    """Repeated evaluation of a function ``(x, …, q) → x`` for many sets of arguments.

    Parameters
    ----------
    function : of carried ``x``, columns shared by all sets, and fixed ``q``
    columns : the function for one set
    backend : of both
    work : total number of columns of all sets
    """

    def __init__(self, function: ca.Function, columns: Columns, backend: Backend, work: int):
        self.fixed = (function.n_in() - 1,)
        self._single, self.size = columns, function.numel_in(0)
        self._lanes = None
        if backend.side_by_side(columns.function, function, work):
            self._lanes = _in_lanes(backend, function, self.fixed)
        if self._lanes is None:
            columns.announce(work)

    @property
    def width(self) -> int:
        """Number of sets in one call."""
        return 1 if self._lanes is None else self._lanes.lanes

    @property
    def threaded(self) -> bool:
        """Whether calls release the interpreter lock."""
        return self._lanes is not None or self._single.compiled

    @property
    def report(self) -> str:
        return self._single.report if self._lanes is None else f"LLVM, {self.width} lanes"

    def shared(self, *columns: np.ndarray) -> list[np.ndarray]:
        """(count,) columns shared by all sets, in the layout of ``run``."""
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
        x, q : (sets, …) initial states, and fixed numbers
        shared : columns shared by all sets, from ``shared``, or (sets, rows, count) per set
        chosen : increasing indices of the columns to return
        count : number of columns, if none are shared

        Returns
        -------
        (sets, chosen, size)
        """
        count, states = shared[0].shape[-1] if count is None else count, []
        longest = int(np.clip(MEMORY // (8 * self.size * self.width), 100, 5000))
        for begin in range(0, count, longest):
            part = slice(begin, min(begin + longest, count))
            inside = chosen[(chosen >= part.start) & (chosen < part.stop)] - begin
            selected = np.append(inside, part.stop - begin - 1)
            columns = [column[..., part] for column in shared]
            part_states = self._call(part.stop - begin, x, columns, q, selected)
            x = part_states[:, -1]
            states.append(part_states[:, :-1])
        return np.concatenate(states, axis=1)

    def _call(
        self, count: int, x: np.ndarray, shared: list[np.ndarray], q: np.ndarray, chosen: np.ndarray
    ) -> np.ndarray:
        if self._lanes is None:
            results = []
            for k in range(len(x)):
                own = [column if column.ndim == 1 else column[k] for column in shared]
                results.append(self._single(count, x[k], *own, q[k])[0][:, chosen].T)
            return np.array(results)
        lanes = np.minimum(np.arange(self.width), len(x) - 1)
        columns = [column if column.ndim == 2 else column[lanes] for column in shared]
        (states,) = self._lanes.group(count, [x[lanes], *columns, q[lanes]], chosen)
        return states[: len(x)].transpose(0, 2, 1)


def in_groups(
    work: Callable[[np.ndarray], None],
    sets: np.ndarray,
    width: int,
    workers: int,
    report: Callable[[float], None],
) -> np.ndarray:
    """Do ``work`` for groups of sets in threads.

    Returns
    -------
    (sets,) bool
        Which sets are complete, also after an interruption.
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
    """Submit several groups at a time, to limit the overhead of scheduling."""
    share = int(np.clip(len(groups) // (16 * workers), 1, 64))

    def run_groups(begin: int) -> int:
        for number in range(begin, min(begin + share, len(groups))):
            work(groups[number])
            done[number * width : (number + 1) * width] = True
        return begin

    pool = ThreadPoolExecutor(workers)
    try:
        waiting: set[Future[int]] = {
            pool.submit(run_groups, k) for k in range(0, len(groups), share)
        }
        total = len(waiting)
        while waiting:
            finished, waiting = wait(waiting, timeout=0.5, return_when=FIRST_COMPLETED)
            for future in finished:
                future.result()
            report(1 - len(waiting) / total)
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def in_blocks(columns: Columns, workers: int, *arguments: np.ndarray) -> list[np.ndarray]:
    """Results for many columns, evaluated in threads by machine code.

    Parameters
    ----------
    columns : of a function without carried or fixed arguments
    workers : upper limit of threads; the virtual machine has one
    arguments : (count, rows) each, one row per column of the function

    Returns
    -------
    list
        (count, rows) each
    """
    return gathered_blocks(
        columns, workers, len(arguments[0]), BLOCK, lambda part: [a[part] for a in arguments]
    )


def gathered_blocks(
    columns: Columns,
    workers: int,
    count: int,
    block: int,
    gather: Callable[[slice], Sequence[np.ndarray]],
    each: int = 1,
) -> list[np.ndarray]:
    """``in_blocks`` for ``count`` sets of ``each`` columns, with arguments gathered when needed.

    ``gather`` returns the arguments, (columns, rows), of a slice of ``block`` sets.
    """
    results = [np.empty((count * each, rows * wide)) for rows, wide in columns.shapes]

    def evaluate(begin: int) -> None:
        part = slice(begin, min(begin + block, count))
        size = (part.stop - begin) * each
        block_results = columns(size, *(argument.T for argument in gather(part)))
        for result, values in zip(results, block_results, strict=True):
            result[begin * each : begin * each + size] = values.T

    columns.announce(count * each)
    begins = range(0, count, block)
    for begin in begins[:1]:
        evaluate(begin)
    share_out(evaluate, begins[1:], workers if columns.compiled else 1)
    return results


def share_out(work: Callable[[int], None], parts: Sequence[int], workers: int) -> None:
    """Do parts of the work in threads, or serially if one worker or part suffices."""
    if workers < 2 or len(parts) < 2:
        for part in parts:
            work(part)
        return
    with ThreadPoolExecutor(workers) as pool:
        for _ in pool.map(work, parts):
            pass
