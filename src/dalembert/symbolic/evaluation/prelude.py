"""Subexpressions of the parameters alone, evaluated once for many calls.

The largest subexpressions that depend on parameters only are extracted from a function,

    f(x, p) = g(x, q),   q = h(p).

In a tangent these are numbers q and rates ``q̇ = h'(p) ṗ``; an adjoint march accumulates q̄ and ends
with ``p̄ = h'(p)ᵀ q̄``.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import casadi as ca


class Prelude:
    """``q = h(p)`` and the rates ``q̇ = h'(p) ṗ`` that enter a tangent.

    Values and rates differ in number, as not every value enters the tangent by its rate.

    Parameters
    ----------
    p, dp : SX symbols of the parameters and their rates
    values, rates : SX columns, ``q(p)`` and ``q̇(p, ṗ)``
    """

    def __init__(self, p: ca.SX, dp: ca.SX, values: ca.SX, rates: ca.SX):
        self._p, self._dp, self._rates = p, dp, rates
        self.value_count, self.rate_count = values.numel(), rates.numel()
        self.values = ca.Function("prelude", [p], [values], {"cse": True})

    @classmethod
    def identity(cls, count: int) -> Prelude:
        """Identity map of ``count`` parameters."""
        p, dp = ca.SX.sym("p", count), ca.SX.sym("dp", count)
        return cls(p, dp, p, dp)

    @classmethod
    def joined(cls, preludes: Sequence[Prelude]) -> Prelude:
        """The preludes of several functions of the same parameters, stacked."""
        p, dp = preludes[0]._p, preludes[0]._dp
        values = [prelude.values(p) for prelude in preludes]
        rates = [prelude.tangent(p, dp) for prelude in preludes]
        return cls(p, dp, ca.vertcat(*values), ca.vertcat(*rates))

    @cached_property
    def tangent(self) -> ca.Function:
        """``(p, ṗ) → q̇``."""
        return ca.Function("prelude_tangent", [self._p, self._dp], [self._rates], {"cse": True})

    @cached_property
    def adjoint(self) -> ca.Function:
        """``(p, q̄) → p̄``."""
        weight = ca.SX.sym("w", self.rate_count)
        back = ca.densify(ca.jtimes(self._rates, self._dp, weight, True))
        return ca.Function("prelude_adjoint", [self._p, weight], [back], {"cse": True})


def before(function: ca.Function, k: int) -> tuple[ca.Function, ca.Function]:
    """``h`` and ``g`` of a function for its input ``k``; graphs of matrices are unchanged.

    Returns
    -------
    ca.Function, ca.Function
        ``p → q``, and the function with q in place of p.
    """
    if not function.is_a("SXFunction"):
        p = ca.SX.sym("p", function.numel_in(k))
        return ca.Function("prelude", [p], [p]), function
    inputs = function.sx_in()
    outputs, symbols, parts = _extract(function.call(inputs), inputs[k])
    values = ca.Function("prelude", [inputs[k]], [_column(parts)], {"cse": True})
    inputs[k] = _column(symbols)
    return values, ca.Function(function.name(), inputs, outputs)


def before_tangent(
    tangent: ca.Function, function: ca.Function
) -> tuple[Prelude, ca.Function, ca.Function]:
    """The prelude of a function ``(…, p)`` and of its tangent ``(…, p, …, ṗ)``, linear in rates.

    Returns
    -------
    Prelude, ca.Function, ca.Function
        Its ``q`` and ``q̇`` stand for p and ṗ in the tangent and the function.
    """
    inputs, last = tangent.sx_in(), function.n_in() - 1
    p, dp, results = inputs[last], inputs[-1], function.call(inputs[: last + 1])
    outputs, symbols, parts = _extract([*tangent.call(inputs), *results], ca.vertcat(p, dp))
    moves = ca.which_depends(_column(parts), dp, 1, True) if parts and dp.numel() else ()
    rated = [k for k, moving in enumerate(moves) if moving]
    fixed = sorted(set(range(len(parts))) - set(rated))
    prelude = Prelude(p, dp, *(_column([parts[k] for k in chosen]) for chosen in (fixed, rated)))
    inputs[last], inputs[-1] = (_column([symbols[k] for k in chosen]) for chosen in (fixed, rated))
    cut = tangent.n_out()
    return (
        prelude,
        ca.Function(tangent.name(), inputs, outputs[:cut]),
        ca.Function(function.name(), inputs[: last + 1], outputs[cut:]),
    )


def _extract(expressions: list[ca.SX], p: ca.SX) -> tuple[list[ca.SX], list[ca.SX], list[ca.SX]]:
    """Expressions in new symbols, the symbols, and their distinct subexpressions of p."""
    expressions, symbols, parts = ca.extract_parametric(expressions, p, {"extract_trivial": True})
    if not parts:
        return expressions, [], []
    column, first = ca.cse(ca.vertcat(*parts)), dict[int, int]()
    representative = [first.setdefault(column[k].element_hash(), k) for k in range(len(parts))]
    expressions = ca.substitute(expressions, symbols, [symbols[k] for k in representative])
    return expressions, [symbols[k] for k in first.values()], [column[k] for k in first.values()]


def _column(entries: Sequence[ca.SX]) -> ca.SX:
    return ca.densify(ca.vertcat(*entries)) if entries else ca.SX(0, 1)
