"""Evaluation of a graph function for several sets of arguments in lanes (SIMD).

Machine code computes with as many numbers at once as the processor has lanes, one for each set.
Results are identical to a scalar evaluation to the last bit, except for sines and cosines, which
may differ by a unit in the last place; lanes do not affect each other. Functions with
data-dependent control flow, such as equations solved by Newton's method, are called set by set.
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
from dalembert.symbolic.native.code_cache import compiled_loop
from dalembert.symbolic.native.llvm import find_llvm, lane_count
from dalembert.symbolic.native.source import c_source, obstacle


class LaneColumns:
    """A function for many columns of each of several sets.

    Calls have their own memory, and release the interpreter lock.

    Parameters
    ----------
    function, carried, fixed : as for ``Columns``
    uniform : indices of the arguments that are equal in all lanes, neither carried nor fixed; if
        there are any, only ``SideBySide.fill`` may be called
    """

    def __init__(
        self,
        function: ca.Function,
        carried: bool = False,
        fixed: Sequence[int] = (),
        uniform: Sequence[int] = (),
    ):
        self.function, self.carried, self.fixed = dense(function), carried, tuple(fixed)
        self.uniform = tuple(uniform)

    @cached_property
    def side_by_side(self) -> SideBySide | None:
        """The function in lanes; None if it cannot be compiled for them."""
        text, scalar = c_source(self.function), find_llvm()
        if text is None or scalar is None or obstacle(text, scalar):
            return None
        toolchain = type(scalar)(lane_count(), uniform=self.uniform)
        try:
            loop = compiled_loop(text, toolchain)
        except UnsupportedError:
            return None
        arguments = self.function, loop, toolchain.name, self.carried, self.fixed
        return SideBySide(toolchain.lanes, *arguments, uniform=self.uniform)

    @cached_property
    def single(self) -> Columns:
        """The function for one set."""
        return Automatic().columns(self.function, self.carried, self.fixed)

    def __call__(self, count: int, *arguments: Any) -> list[np.ndarray]:
        """Results for ``count`` columns of each set.

        Parameters
        ----------
        count : number of columns
        arguments : (sets, …) arguments of ``Columns`` for each set; (1, …) equal for all sets

        Returns
        -------
        list
            (sets, rows, columns) results of ``Columns`` for each set

        Raises
        ------
        SolverFailure
            A solver inside the function fails for one of the sets.
        """
        arrays = [np.asarray(argument, dtype=float) for argument in arguments]
        sets = max(array.shape[0] for array in arrays)
        arrays = [np.broadcast_to(a, (sets, *a.shape[1:])) for a in arrays]
        parts: list[list[np.ndarray]] = []
        begin = 0
        if sets > 1 and self.side_by_side is not None:
            width = self.side_by_side.lanes
            while begin < sets:
                chosen = np.minimum(np.arange(begin, begin + width), sets - 1)
                parts.append(self.side_by_side.group(count, [a[chosen] for a in arrays]))
                begin += width
        else:
            parts = [
                [r[None] for r in self.single(count, *(a[s] for a in arrays))] for s in range(sets)
            ]
        return [np.concatenate(result)[:sets] for result in zip(*parts, strict=True)]


class SideBySide(NativeColumns):
    """Machine code in which every number is a vector with one entry per lane.

    Arguments that are uniform over the lanes are single numbers, padded to whole vectors.
    """

    def __init__(self, lanes: int, *arguments: Any, uniform: Sequence[int] = ()):
        self.lanes, self.uniform = lanes, frozenset(uniform)
        super().__init__(*arguments)
        for i in uniform:
            self._steps[0][i] = self.padded(self.sizes[i]) // lanes

    def padded(self, size: int) -> int:
        """The size, rounded up to whole vectors."""
        return -(-size // self.lanes) * self.lanes

    def fill(self, count: int, arguments: list[np.ndarray], results: list[np.ndarray]) -> None:
        """Write results of arguments in the layout of the lanes, without copies.

        Parameters
        ----------
        arguments : (columns, rows, lanes) each, or (rows, lanes) if passed once; uniform ones
            (columns, padded size)
        results : (columns, rows, lanes) each; memory before a carried result holds the argument
        """
        self._call(count, arguments, results)  # functions in lanes do not fail

    def group(
        self, count: int, arguments: Sequence[np.ndarray], chosen: np.ndarray | None = None
    ) -> list[np.ndarray]:
        """Results (lanes, rows, columns) for one set of arguments in each lane.

        Parameters
        ----------
        chosen : indices of the columns to return, if columns are not matrices; default all
        """
        sizes = [
            n * (1 if i in self.once else count) * self.lanes for i, n in enumerate(self.sizes)
        ]
        buffers = [
            flattened(self.function.name(), i, a.T, n, "C")
            for i, (a, n) in enumerate(zip(arguments, sizes, strict=True))
        ]
        results = [np.empty(rows * columns * count * self.lanes) for rows, columns in self.shapes]
        if self.carried:
            first = self.sizes[0] * self.lanes
            states = np.empty(first * (count + 1))
            states[:first] = buffers[0]
            buffers[0], results[0] = states, states[first:]
        self.fill(count, buffers, results)
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
