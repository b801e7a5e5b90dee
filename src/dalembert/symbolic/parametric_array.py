"""Numbers, some of them formulas of the parameters, with exact derivatives both ways."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np

from dalembert.symbolic.kernel import Kernel


class ParametricArray:
    """A long vector of numbers, mostly constant, a few entries formulas of ``p``.

    Parameters
    ----------
    constants : (n,) values; those of formulas are ignored
    formulas : index → SX scalar of ``p``
    p : (m,) SX symbols of the parameters
    """

    def __init__(self, constants: np.ndarray, formulas: Mapping[int, ca.SX], p: ca.SX):
        self.constants = np.asarray(constants, dtype=float)
        self.index = np.fromiter(formulas, dtype=int, count=len(formulas))
        self.parameter_count = p.numel()
        column = ca.densify(ca.vertcat(*formulas.values())) if formulas else ca.SX(0, 1)
        dp, weights = ca.SX.sym("dp", p.numel()), ca.SX.sym("w", column.numel())
        self._values = Kernel(ca.Function("values", [p], [column]))
        push = ca.densify(ca.jtimes(column, p, dp)) if formulas else column
        pull = ca.SX.zeros(p.numel())
        if formulas:
            pull = ca.densify(ca.jtimes(column, p, weights, True))
        self._push = Kernel(ca.Function("push", [p, dp], [push], {"cse": True}))
        self._pull = Kernel(ca.Function("pull", [p, weights], [pull], {"cse": True}))

    def values(self, p: np.ndarray) -> np.ndarray:
        """(n,) numbers at ``p``."""
        found = self.constants.copy()
        if self.index.size:
            found[self.index] = self._values(p)[0].ravel()
        return found

    def push(self, p: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """(n,) change of the numbers with a change of ``p``."""
        found = np.zeros_like(self.constants)
        if self.index.size:
            found[self.index] = self._push(p, dp)[0].ravel()
        return found

    def pull(self, p: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """(m,) weights of the parameters from weights (n,) of the numbers."""
        if not self.index.size:
            return np.zeros(self.parameter_count)
        return self._pull(p, weights[self.index])[0].ravel()
