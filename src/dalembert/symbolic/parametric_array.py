"""Arrays of constants and formulas of the parameters, with exact directional derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.formulas.expression import Expression, t


class ParametricArray:
    """A long vector of numbers, ``constants + Σ formula(p, t)`` at some entries.

    Parameters
    ----------
    constants : (n,) values
    index : (k,) entries to which a formula is added
    which : (k,) number of that formula; a formula may be added to many entries
    formulas : SX scalars of ``p`` and time
    p : (m,) SX symbols of the parameters
    """

    def __init__(
        self,
        constants: np.ndarray,
        index: np.ndarray,
        which: np.ndarray,
        formulas: Sequence[ca.SX],
        p: ca.SX,
    ):
        self.constants, self.index, self.which = constants, index, which
        self._formulas, self._p = list(formulas), p
        self.parameter_count = p.numel()
        column = ca.densify(ca.vertcat(*formulas)) if formulas else ca.SX(0, 1)
        self._count = column.numel()
        dp, weights = ca.SX.sym("dp", p.numel()), ca.SX.sym("w", column.numel())
        self._values = _kernel("values", [p, t.sx], column)
        self._push = _kernel("push", [p, t.sx, dp], ca.jtimes(column, p, dp))
        self._pull = _kernel("pull", [p, t.sx, weights], ca.jtimes(column, p, weights, True))
        self.depends_on_time = any(ca.which_depends(column, t.sx, 1, True)) if formulas else False

    @property
    def filled(self) -> np.ndarray:
        """Indices of the entries that are not identically zero."""
        return np.union1d(np.flatnonzero(self.constants), self.index).astype(int)

    def values(self, p: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) numbers at ``p``."""
        result = self.constants.copy()
        self._spread(result, self._values, p, time)
        return result

    @property
    def formulas(self) -> np.ndarray:
        """(n,) objects: numbers, or formulas of parameters at time zero."""
        entries = self.constants.astype(object)
        at_zero = [ca.substitute(formula, t.sx, 0) for formula in self._formulas]
        for k, number in zip(self.index, self.which, strict=True):
            entries[k] = entries[k] + at_zero[number]
        return entries

    def graph(self, p: ca.MX) -> ca.MX:
        """(n,) numbers at time zero as a graph of parameters."""
        constants = ca.MX(ca.DM(self.constants))
        if not self.index.size:
            return constants
        column = ca.densify(ca.vertcat(*self._formulas))
        formulas = ca.Function("formulas", [self._p, t.sx], [column])
        ones, shape = [1.0] * self.index.size, (self.constants.size, self._count)
        spread = ca.DM.triplet(self.index.tolist(), self.which.tolist(), ones, *shape)
        return constants + ca.mtimes(spread, formulas(p, 0.0))

    def push(self, p: np.ndarray, dp: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(n,) change of the numbers with a change of ``p``."""
        result = np.zeros_like(self.constants)
        self._spread(result, self._push, p, time, dp)
        return result

    def pull(self, p: np.ndarray, weights: np.ndarray, time: float = 0.0) -> np.ndarray:
        """(m,) weights of the parameters from weights (n,) of the numbers."""
        if not self.index.size:
            return np.zeros(self.parameter_count)
        formula_weights = np.bincount(self.which, weights[self.index], minlength=self._count)
        return self._pull(p, time, formula_weights)[0].ravel()

    def turn(
        self, p: np.ndarray, weights: np.ndarray, dp: np.ndarray, time: float = 0.0
    ) -> np.ndarray:
        """(m,) change of the result of ``pull`` with a change of ``p``."""
        if not self.index.size:
            return np.zeros(self.parameter_count)
        formula_weights = np.bincount(self.which, weights[self.index], minlength=self._count)
        return self._turn(p, time, formula_weights, dp)[0].ravel()

    @cached_property
    def _turn(self) -> Kernel:
        p, dp = self._p, ca.SX.sym("dp", self.parameter_count)
        weights = ca.SX.sym("w", self._count)
        slope = ca.jtimes(ca.vertcat(*self._formulas), p, weights, True)
        return _kernel("turn", [p, t.sx, weights, dp], ca.jtimes(slope, p, dp))

    @cached_property
    def derivative(self) -> ParametricArray:
        """Array of the time derivatives of the numbers."""
        slopes = [ca.gradient(formula, t.sx) for formula in self._formulas]
        return ParametricArray(
            np.zeros_like(self.constants), self.index, self.which, slopes, self._p
        )

    def _spread(self, into: np.ndarray, kernel: Kernel, *arguments) -> None:
        if self.index.size:
            np.add.at(into, self.index, kernel(*arguments)[0].ravel()[self.which])


def _kernel(name: str, inputs: list[ca.SX], output: ca.SX) -> Kernel:
    return Kernel(ca.Function(name, inputs, [ca.densify(output)], {"cse": True}))


class ArrayEntries:
    """Builder of a ``ParametricArray``; values added to the same entry are summed.

    Parameters
    ----------
    size : number of entries
    """

    def __init__(self, size: int):
        self.constants = np.zeros(size)
        self.formulas: list[ca.SX] = []
        self._formula_numbers: dict[int, int] = {}
        self._index: list[np.ndarray] = []
        self._which: list[np.ndarray] = []

    def add(self, places: Any, value: Any) -> None:
        """Add a number or formula to all entries ``places``, or an array or list of one each."""
        index = np.atleast_1d(np.asarray(places, dtype=int))
        if isinstance(value, Expression):
            if value.sx.is_constant():
                np.add.at(self.constants, index, float(value.sx))
            else:
                self._append(index, np.full(index.size, self._number(value.sx)))
        elif isinstance(value, list) or np.asarray(value).dtype.hasobject:
            self._add_each(index, list(value))
        else:
            np.add.at(self.constants, index, np.asarray(value, dtype=float))

    def _add_each(self, index: np.ndarray, values: list[Any]) -> None:
        """Add one value to each entry; the same object at many entries is one formula."""
        if len(values) != index.size:
            raise ValueError(f"{len(values)} values for {index.size} places")
        identities = np.fromiter(map(id, values), dtype=np.int64, count=len(values))
        _, first, which = np.unique(identities, return_index=True, return_inverse=True)
        order = np.argsort(which, kind="stable")
        groups = np.split(order, np.searchsorted(which[order], np.arange(1, first.size)))
        for k, members in zip(first, groups, strict=True):
            self.add(index[members], values[k])

    def copy(self, other: ArrayEntries, sources: np.ndarray, places: np.ndarray) -> None:
        """Add ``sources`` of another array, each set at most once, to the entries ``places``."""
        np.add.at(self.constants, places, other.constants[sources])
        index, which = other.placed
        if index.size:
            slot = np.full(other.constants.size, -1)
            slot[index] = which
            with_formula = np.flatnonzero(slot[sources] >= 0)
            numbers = np.array([self._number(formula) for formula in other.formulas], dtype=int)
            self._append(places[with_formula], numbers[slot[sources[with_formula]]])

    @property
    def placed(self) -> tuple[np.ndarray, np.ndarray]:
        """Entries with formulas, and the numbers of these."""
        empty = np.zeros(0, dtype=int)
        return np.concatenate([empty, *self._index]), np.concatenate([empty, *self._which])

    def array(self, p: ca.SX) -> ParametricArray:
        """The finished, immutable array."""
        index, which = self.placed
        used, which = np.unique(which, return_inverse=True)
        return ParametricArray(
            self.constants, index, which, [self.formulas[int(k)] for k in used], p
        )

    def _number(self, formula: ca.SX) -> int:
        key = formula.element_hash()  # the same node of the graph, however it is wrapped
        if key not in self._formula_numbers:
            self._formula_numbers[key] = len(self.formulas)
            self.formulas.append(formula)
        return self._formula_numbers[key]

    def _append(self, index: np.ndarray, which: np.ndarray) -> None:
        self._index.append(index)
        self._which.append(which)
