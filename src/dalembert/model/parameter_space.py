"""The parameter vector of a mechanism: values of its parameters, then numbers computed from them.

What is computed outside of the graph (the shapes of flexible bodies) stands behind the parameters,
``(p, r(p))``, so that equations, steps and gradients take both for parameters. Gradients come back
by the chain rule, ``dJ/dp = ∂J/∂p + (∂J/∂r) (∂r/∂p)``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import casadi as ca
import numpy as np

from dalembert.elements.computed import ComputedNumbers
from dalembert.symbolic.formulas.expression import stack


class ParameterSpace:
    """How computed numbers follow the parameters.

    Parameters
    ----------
    parameters : (np,) SX symbols
    computed : what is computed, in the order in which it stands behind them
    """

    def __init__(self, parameters: ca.SX, computed: list[ComputedNumbers]):
        self.computed = computed
        self.count = parameters.numel()
        self.symbols = stack([parameters, *(c.symbols for c in computed)])
        arguments = [c.arguments for c in computed]
        self._arguments = ca.Function("arguments", [parameters], arguments)
        self._slopes = ca.Function(
            "slopes", [parameters], [ca.densify(ca.jacobian(a, parameters)) for a in arguments]
        )

    def complete(self, p: np.ndarray) -> np.ndarray:
        """``(p, r(p))`` of ``p``, whatever stands behind it now.

        Raises
        ------
        ModelError, AnalysisError
            Something cannot be computed at these values.
        """
        own = np.asarray(p, dtype=float)[: self.count]
        if not self.computed:
            return own
        given = zip(self.computed, self._columns(self._arguments, own), strict=True)
        return np.concatenate([own, *(c.values(a.ravel()) for c, a in given)])

    def arguments(self, p: np.ndarray, of: ComputedNumbers) -> np.ndarray:
        """What one of them follows."""
        return self._columns(self._arguments, p[: self.count])[self.computed.index(of)].ravel()

    def tangents(self, p: np.ndarray, columns: Sequence[int]) -> np.ndarray:
        """(n, columns) changes of the whole vector with some of the parameters."""
        moved = [np.eye(self.count)[:, list(columns)]]
        for numbers, arguments, slopes in self._chains(p):
            moved.append(numbers.push(arguments.ravel(), slopes @ moved[0]))
        return np.vstack(moved)

    def gathered(self, p: np.ndarray, gradients: np.ndarray) -> np.ndarray:
        """(rows, np) gradients by the parameters from (rows, n) by the whole vector."""
        if not self.computed:
            return gradients
        found, begin = gradients[:, : self.count].copy(), self.count
        for numbers, arguments, slopes in self._chains(p):
            size = numbers.symbols.numel()
            own = gradients[:, begin : begin + size].T
            found += numbers.pull(arguments.ravel(), own).T @ slopes
            begin += size
        return found

    def _chains(self, p: np.ndarray) -> Iterator[tuple[ComputedNumbers, np.ndarray, np.ndarray]]:
        """What is computed, its arguments, and their slopes (k, np)."""
        if not self.computed:
            return iter(())
        own = p[: self.count]
        arguments, slopes = (self._columns(f, own) for f in (self._arguments, self._slopes))
        return zip(self.computed, arguments, slopes, strict=True)

    def _columns(self, function: ca.Function, p: np.ndarray) -> list[np.ndarray]:
        found = function(p)
        return [x.full() for x in (found if isinstance(found, (tuple, list)) else [found])]
