"""A function of the graph called for several sets of arguments side by side.

Machine code computes with as many numbers at once as the processor has lanes, one for each set.
Each lane gets what it would get alone, to the last bit, but for sines and cosines, which are within
a unit in the last place here and there; what is in other lanes changes nothing. Functions whose
course depends on their numbers, such as equations solved by Newton's method, have no common course;
they are called set by set.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.symbolic.evaluation.backends import Automatic
from dalembert.symbolic.evaluation.columns import Columns, NativeColumns, dense
from dalembert.symbolic.evaluation.kernel import flattened
from dalembert.symbolic.native.code_cache import made
from dalembert.symbolic.native.llvm import find_llvm, lane_count
from dalembert.symbolic.native.source import c_source, hindrance


class LaneColumns:
    """A function for many columns of each of several sets.

    Calls have memory of their own, and let other threads run.

    Parameters
    ----------
    function, carried, fixed : as for ``Columns``
    alike : numbers of the arguments that are the same in all lanes, which neither are carried nor
        fixed; where there are some, ``SideBySide.fill`` calls it
    """

    def __init__(
        self,
        function: ca.Function,
        carried: bool = False,
        fixed: Sequence[int] = (),
        alike: Sequence[int] = (),
    ):
        self.function, self.carried, self.fixed = dense(function), carried, tuple(fixed)
        self.alike = tuple(alike)

    @cached_property
    def side_by_side(self) -> SideBySide | None:
        """The function in lanes; None where there are none for it."""
        text, found = c_source(self.function), find_llvm()
        if text is None or found is None or hindrance(text, found):
            return None
        toolchain = type(found)(lane_count(), alike=self.alike)
        try:
            loop = made(text, toolchain)
        except UnsupportedError:
            return None
        made_for = self.function, loop, toolchain.name, self.carried, self.fixed
        return SideBySide(toolchain.lanes, *made_for, alike=self.alike)

    @cached_property
    def alone(self) -> Columns:
        """The function for one set."""
        return Automatic().columns(self.function, self.carried, self.fixed)

    def __call__(self, count: int, *arguments: Any) -> list[np.ndarray]:
        """Results for so many columns of each set.

        Parameters
        ----------
        count : columns
        arguments : (sets, …) what ``Columns`` takes, for each set; (1, …) for all sets alike

        Returns
        -------
        list
            (sets, rows, columns) what ``Columns`` gives, for each set

        Raises
        ------
        SolverFailure
            A solver inside the function gives up for one of the sets.
        """
        given = [np.asarray(argument, dtype=float) for argument in arguments]
        sets = max(argument.shape[0] for argument in given)
        given = [np.broadcast_to(a, (sets, *a.shape[1:])) for a in given]
        parts: list[list[np.ndarray]] = []
        begin = 0
        if sets > 1 and self.side_by_side is not None:
            width = self.side_by_side.lanes
            while begin < sets:
                chosen = np.minimum(np.arange(begin, begin + width), sets - 1)
                parts.append(self.side_by_side.group(count, [a[chosen] for a in given]))
                begin += width
        else:
            parts = [
                [r[None] for r in self.alone(count, *(a[s] for a in given))] for s in range(sets)
            ]
        return [np.concatenate(result)[:sets] for result in zip(*parts, strict=True)]


class SideBySide(NativeColumns):
    """Machine code in which every number is a row of as many numbers as there are lanes.

    Columns of arguments that are the same in all lanes are single numbers, filled up to whole rows
    of lanes.
    """

    def __init__(self, lanes: int, *made_for: Any, alike: Sequence[int] = ()):
        self.lanes, self.alike = lanes, frozenset(alike)
        super().__init__(*made_for)
        for i in alike:
            self._steps[0][i] = self.filled(self.sizes[i]) // lanes

    def filled(self, size: int) -> int:
        """Numbers of whole rows that hold so many."""
        return -(-size // self.lanes) * self.lanes

    def fill(self, count: int, given: list[np.ndarray], results: list[np.ndarray]) -> None:
        """Results where they are wanted, of arguments as they are laid out, without copies.

        Parameters
        ----------
        given : (columns, rows, lanes) each, or (rows, lanes) of those given once; those that are
            the same in all lanes (columns, filled size)
        results : (columns, rows, lanes) each; of those carried the first has the argument before it
        """
        self._call(count, given, results)  # what is in lanes does not fail

    def group(
        self, count: int, arguments: Sequence[np.ndarray], chosen: np.ndarray | None = None
    ) -> list[np.ndarray]:
        """Results (lanes, rows, columns) for one set of arguments in each lane.

        Parameters
        ----------
        chosen : numbers of the columns that are wanted, where columns are no matrices; else all
        """
        wanted = [
            n * (1 if i in self.once else count) * self.lanes for i, n in enumerate(self.sizes)
        ]
        given = [
            flattened(self.function.name(), i, a.T, n, "C")
            for i, (a, n) in enumerate(zip(arguments, wanted, strict=True))
        ]
        results = [np.empty(rows * columns * count * self.lanes) for rows, columns in self.shapes]
        if self.carried:
            first = self.sizes[0] * self.lanes
            whole = np.empty(first * (count + 1))
            whole[:first] = given[0]
            given[0], results[0] = whole, whole[first:]
        self.fill(count, given, results)
        if chosen is not None:
            return [
                r.reshape(count, rows, self.lanes)[chosen].transpose(2, 1, 0)
                for r, (rows, _) in zip(results, self.shapes, strict=True)
            ]
        return [
            np.ascontiguousarray(r.reshape(-1, self.lanes).T)
            .reshape(self.lanes, columns * count, rows)
            .transpose(0, 2, 1)
            for r, (rows, columns) in zip(results, self.shapes, strict=True)
        ]
