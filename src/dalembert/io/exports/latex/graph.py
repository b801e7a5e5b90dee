"""Graphs of CasADi as sums of products."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.io.exports.latex.sums import MOST_TERMS, Sum, function
from dalembert.io.exports.latex.trigonometry import simplified

LARGEST = 20 * MOST_TERMS
"""Upper limit of the instructions of a graph."""


class WithoutNotation(UnsupportedError):
    """An operation that has no notation in LaTeX."""


def _power(base: Sum, exponent: Sum) -> Sum:
    value = exponent.constant
    return function("pow", base, exponent) if value is None else base.power(value)


def _named(name: str) -> Callable[..., Sum]:
    return lambda *arguments: function(name, *arguments)


OPERATIONS: dict[int, Callable[..., Sum]] = {
    ca.OP_ADD: lambda a, b: a + b,
    ca.OP_ASSIGN: lambda a: a,
    ca.OP_CONSTPOW: _power,
    ca.OP_DIV: lambda a, b: a * b.inverse(),
    ca.OP_EXPM1: lambda a: function("exp", a) - Sum.number(1.0),
    ca.OP_HYPOT: lambda a, b: function("sqrt", a * a + b * b),
    ca.OP_INV: lambda a: a.inverse(),
    ca.OP_LOG1P: lambda a: function("log", a + Sum.number(1.0)),
    ca.OP_MUL: lambda a, b: a * b,
    ca.OP_NEG: lambda a: -a,
    ca.OP_POW: _power,
    ca.OP_SQ: lambda a: a * a,
    ca.OP_SUB: lambda a, b: a - b,
    ca.OP_TWICE: lambda a: a.scaled(2.0),
}
NAMES = {
    "ABS": "FABS",
    "IF": "IF_ELSE_ZERO",
    "MAX": "FMAX",
    "MIN": "FMIN",
}
"""Functions with another name in CasADi."""
UNPRINTED = {
    ca.OP_CALL: "an interpolation, an iteration or an external function",
}
"""Operations without a notation."""
for _name in (
    "abs acos acosh and asin asinh atan atan2 atanh copysign cos cosh eq erf exp floor if le log "
    "lt max min ne not or sign sin sinh sqrt tan tanh"
).split():
    OPERATIONS[getattr(ca, f"OP_{NAMES.get(_name.upper(), _name.upper())}")] = _named(_name)


def sums_of(column: ca.SX, symbols: Sequence[tuple[ca.SX, str]]) -> list[Sum]:
    """Simplified entries of a column.

    Parameters
    ----------
    symbols : scalar symbols with their names

    Raises
    ------
    WithoutNotation
        The expressions have an operation without a notation.
    UnsupportedError
        They are too large.
    """
    inputs = ca.vertcat(*(symbol for symbol, _ in symbols))
    graph = ca.Function("entries", [inputs], [ca.densify(ca.vec(column))])
    if graph.n_instructions() > LARGEST:
        raise UnsupportedError(f"the expressions have {graph.n_instructions()} operations")
    work: dict[int, Sum] = {}
    entries = [Sum({})] * column.numel()
    for k in range(graph.n_instructions()):
        code, outputs, arguments = (
            graph.instruction_id(k),
            graph.instruction_output(k),
            graph.instruction_input(k),
        )
        if code == ca.OP_CONST:
            work[outputs[0]] = Sum.number(graph.instruction_constant(k))
        elif code == ca.OP_INPUT:
            work[outputs[0]] = Sum.symbol(symbols[arguments[1]][1])
        elif code == ca.OP_OUTPUT:
            entries[outputs[1]] = simplified(work[arguments[0]])
        elif code in OPERATIONS:
            work[outputs[0]] = OPERATIONS[code](*(work[a] for a in arguments))
        else:
            raise WithoutNotation(UNPRINTED.get(code, f"operation {code} of CasADi"))
    return entries
