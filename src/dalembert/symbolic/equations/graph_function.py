"""Functions of graphs, differentiated by CasADi."""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.symbolic.once import CacheOwner, once


class GraphFunction(CacheOwner):
    """A function ``(t, x, p) → y`` with the derivatives of an ``ImplicitFunction``.

    Parameters
    ----------
    function : ca.Function
    """

    def __init__(self, function: ca.Function):
        self.function = function

    @cached_property
    def tangent(self) -> ca.Function:
        """``(t, x, p, ṫ, ẋ, ṗ) → ẏ``."""
        inputs, rates = self._symbols(""), self._symbols("d")
        rate = self.function.forward(1)(*inputs, self.function(*inputs), *rates)
        return ca.Function("tangent", [*inputs, *rates], [ca.densify(rate)])

    @cached_property
    def adjoint(self) -> ca.Function:
        """``(t, x, p, ȳ) → t̄, x̄, p̄``."""
        inputs, weight = self._symbols(""), ca.MX.sym("w", self.function.numel_out(0))
        weights = self.function.reverse(1)(*inputs, self.function(*inputs), weight)
        return ca.Function("adjoint", [*inputs, weight], [ca.densify(part) for part in weights])

    @once
    def tangents(self, count: int) -> ca.Function:
        """``(t, x, p, dx, dp) → dy`` in ``count`` columns."""
        inputs = self._symbols("")
        dx, dp = (ca.MX.sym(f"d{i}", s.numel(), count) for i, s in enumerate(inputs[1:]))
        forward = self.function.forward(count)
        changes = forward(*inputs, self.function(*inputs), ca.MX(1, count), dx, dp)
        return ca.Function("tangents", [*inputs, dx, dp], [ca.densify(changes)])

    @cached_property
    def second(self) -> ca.Function:
        """``(t, x, p, ȳ, ẋ, ṗ, dȳ) → (x̄, d x̄, d p̄)``."""
        inputs, weight = self._symbols(""), ca.MX.sym("w", self.function.numel_out(0))
        _, x_bar, p_bar = self.adjoint(*inputs, weight)
        return tangent_of_adjoint(ca.Function("adjoint", [*inputs, weight], [x_bar, p_bar]))

    def _symbols(self, prefix: str) -> list[ca.MX]:
        return [ca.MX.sym(prefix + n, self.function.numel_in(i)) for i, n in enumerate("txp")]


def tangent_of_adjoint(adjoint: ca.Function) -> ca.Function:
    """``(…, x, p, w, ẋ, ṗ, ẇ) → (x̄, d x̄, d p̄)`` from ``(…, x, p, w) → (x̄, p̄)``."""
    inputs = [ca.MX.sym(f"i{k}", adjoint.size_in(k)) for k in range(adjoint.n_in())]
    rates = [ca.MX.sym(f"d{k}", x.shape) for k, x in enumerate(inputs[-3:])]
    bars, zeros = adjoint(*inputs), [0] * (len(inputs) - 3)
    changes = adjoint.forward(1)(*inputs, *bars, *zeros, *rates)
    return ca.Function("second", [*inputs, *rates], [ca.densify(o) for o in (bars[0], *changes)])
