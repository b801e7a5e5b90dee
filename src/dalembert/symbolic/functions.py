"""The functions allowed in formulas, from Python and in model files."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from dalembert.symbolic.expression import Expression, as_sx


def _lift(function: Callable) -> Callable[..., Expression]:
    def lifted(*arguments) -> Expression:
        return Expression(function(*(as_sx(a) for a in arguments)))

    return lifted


def _where(condition, a, b):
    return ca.if_else(condition, a, b)


def _smooth_abs(x, width):
    return ca.sqrt(x * x + width * width)


sin = _lift(ca.sin)
cos = _lift(ca.cos)
tan = _lift(ca.tan)
asin = _lift(ca.asin)
acos = _lift(ca.acos)
atan = _lift(ca.atan)
atan2 = _lift(ca.atan2)
sinh = _lift(ca.sinh)
cosh = _lift(ca.cosh)
tanh = _lift(ca.tanh)
exp = _lift(ca.exp)
log = _lift(ca.log)
sqrt = _lift(ca.sqrt)
hypot = _lift(ca.hypot)
sign = _lift(ca.sign)
absolute = _lift(ca.fabs)
floor = _lift(ca.floor)
minimum = _lift(ca.fmin)
maximum = _lift(ca.fmax)
where = _lift(_where)
smooth_abs = _lift(_smooth_abs)

FORMULA_FUNCTIONS: dict[str, tuple[Callable[..., Expression], int]] = {
    "sin": (sin, 1),
    "cos": (cos, 1),
    "tan": (tan, 1),
    "asin": (asin, 1),
    "acos": (acos, 1),
    "atan": (atan, 1),
    "atan2": (atan2, 2),
    "sinh": (sinh, 1),
    "cosh": (cosh, 1),
    "tanh": (tanh, 1),
    "exp": (exp, 1),
    "log": (log, 1),
    "sqrt": (sqrt, 1),
    "hypot": (hypot, 2),
    "abs": (absolute, 1),
    "sign": (sign, 1),
    "floor": (floor, 1),
    "min": (minimum, 2),
    "max": (maximum, 2),
    "where": (where, 3),
    "smooth_abs": (smooth_abs, 2),
}
"""Name in a formula → (function, number of arguments)."""
