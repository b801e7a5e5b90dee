"""Parameters of a mechanism, and numbers computed from them outside of the graph.

Computed numbers (shapes of flexible bodies) are appended to the parameters, ``(p, r(p))``, so that
equations, steps and gradients treat both as parameters. Gradients follow by the chain rule,
``dJ/dp = ∂J/∂p + (∂J/∂r) (∂r/∂p)``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import casadi as ca
import numpy as np

from dalembert.elements.computed import ComputedNumbers
from dalembert.symbolic.formulas.expression import stack


class ParameterSpace:
    """Parameters and the numbers computed from them.

    Parameters
    ----------
    parameters : (np,) SX symbols
    computed : computed numbers, in their order in the vector
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
        """``(p, r(p))`` from ``p``, replacing appended numbers if there are any.

        Raises
        ------
        ModelError, AnalysisError
            A number cannot be computed at these values.
        """
        own = np.asarray(p, dtype=float)[: self.count]
        if not self.computed:
            return own
        arguments = zip(self.computed, self._columns(self._arguments, own), strict=True)
        return np.concatenate([own, *(c.values(a.ravel()) for c, a in arguments)])

    def arguments(self, p: np.ndarray, of: ComputedNumbers) -> np.ndarray:
        """Arguments of some of the computed numbers."""
        return self._columns(self._arguments, p[: self.count])[self.computed.index(of)].ravel()

    def tangents(self, p: np.ndarray, columns: Sequence[int]) -> np.ndarray:
        """(n, columns) changes of the whole vector with some of the parameters."""
        changes = [np.eye(self.count)[:, list(columns)]]
        for numbers, arguments, slopes in self._chains(p):
            changes.append(numbers.push(arguments.ravel(), slopes @ changes[0]))
        return np.vstack(changes)

    def parameter_gradients(self, p: np.ndarray, gradients: np.ndarray) -> np.ndarray:
        """(rows, np) gradients by the parameters from (rows, n) by the whole vector."""
        if not self.computed:
            return gradients
        total, begin = gradients[:, : self.count].copy(), self.count
        for numbers, arguments, slopes in self._chains(p):
            size = numbers.symbols.numel()
            own = gradients[:, begin : begin + size].T
            total += numbers.pull(arguments.ravel(), own).T @ slopes
            begin += size
        return total

    def _chains(self, p: np.ndarray) -> Iterator[tuple[ComputedNumbers, np.ndarray, np.ndarray]]:
        """Computed numbers, their arguments, and the slopes of these (k, np)."""
        if not self.computed:
            return iter(())
        own = p[: self.count]
        arguments, slopes = (self._columns(f, own) for f in (self._arguments, self._slopes))
        return zip(self.computed, arguments, slopes, strict=True)

    def _columns(self, function: ca.Function, p: np.ndarray) -> list[np.ndarray]:
        results = function(p)
        return [x.full() for x in (results if isinstance(results, (tuple, list)) else [results])]
