"""Functions of formulas, in Python and in model files."""

from __future__ import annotations

import inspect
from collections.abc import Callable

import casadi as ca

from dalembert.errors import ExpressionError
from dalembert.symbolic.formulas.expression import Expression, as_sx

DOCSTRING = """{summary}

Of numbers and formulas, with exact derivatives.

Parameters
----------
{names} : numbers or formulas

Raises
------
ExpressionError
    Another number of arguments.

Examples
--------
>>> import math
>>> import dalembert as da
>>> round(float(da.{name}({example})), 12)
{value}
"""


def _lift(
    name: str, function: Callable, names: str, summary: str, example: str = "", value: float = 0.0
) -> Callable[..., Expression]:
    """A CasADi function as a documented function of formulas."""
    count = len(names.split(", "))

    def lifted(*arguments) -> Expression:
        if len(arguments) != count:
            raise ExpressionError(f"takes ({names}), got {len(arguments)} argument(s)", name)
        return Expression(function(*(as_sx(a) for a in arguments)))

    lifted.__name__ = lifted.__qualname__ = name
    lifted.__doc__ = DOCSTRING.format(
        summary=summary, names=names, name=name, example=example, value=value
    )
    parameters = [
        inspect.Parameter(n, inspect.Parameter.POSITIONAL_ONLY) for n in names.split(", ")
    ]
    lifted.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    return lifted


def _where(condition, a, b):
    return ca.if_else(condition, a, b)


def _smooth_abs(x, width):
    return ca.sqrt(x * x + width * width)


sin = _lift("sin", ca.sin, "angle", "Sine of an angle [rad].", "math.pi / 6", 0.5)
cos = _lift("cos", ca.cos, "angle", "Cosine of an angle [rad].", "math.pi / 3", 0.5)
tan = _lift("tan", ca.tan, "angle", "Tangent of an angle [rad].", "math.pi / 4", 1.0)
asin = _lift("asin", ca.asin, "x", "Angle of a sine, −π/2 to π/2.", "math.sin(0.3)", 0.3)
acos = _lift("acos", ca.acos, "x", "Angle of a cosine, 0 to π.", "math.cos(0.3)", 0.3)
atan = _lift("atan", ca.atan, "x", "Angle of a tangent, −π/2 to π/2.", "math.tan(0.3)", 0.3)
atan2 = _lift(
    *("atan2", ca.atan2, "y, x", "Angle of the direction (x, y), −π to π."),
    *("2 * math.sin(3.0), 2 * math.cos(3.0)", 3.0),
)
sinh = _lift("sinh", ca.sinh, "x", "Hyperbolic sine.", "math.log(2.0)", 0.75)
cosh = _lift("cosh", ca.cosh, "x", "Hyperbolic cosine: a hanging chain.", "math.log(2.0)", 1.25)
tanh = _lift("tanh", ca.tanh, "x", "Hyperbolic tangent: a smooth step.", "math.log(2.0)", 0.6)
exp = _lift("exp", ca.exp, "x", "Exponential function.", "math.log(3.0)", 3.0)
log = _lift("log", ca.log, "x", "Natural logarithm.", "math.e**2", 2.0)
sqrt = _lift("sqrt", ca.sqrt, "x", "Square root.", "6.25", 2.5)
hypot = _lift("hypot", ca.hypot, "x, y", "Length of a vector, ``√(x² + y²)``.", "3, -4", 5.0)
sign = _lift(
    "sign", ca.sign, "x", "−1, 0 or 1, as the number is below, at or above zero.", "-7", -1.0
)
absolute = _lift("absolute", ca.fabs, "x", "Absolute value.", "-2.5", 2.5)
floor = _lift("floor", ca.floor, "x", "The whole number below, or the number itself.", "-1.5", -2.0)
minimum = _lift("minimum", ca.fmin, "a, b", "The smaller of two numbers.")
maximum = _lift("maximum", ca.fmax, "a, b", "The larger of two numbers.")
where = _lift(
    *("where", _where, "condition, a, b", "``a`` where the condition holds, else ``b``."),
    *("da.sin(2.0) > 0, 1.5, 4.0", 1.5),
)
smooth_abs = _lift(
    *("smooth_abs", _smooth_abs, "x, width", "Absolute value with a round corner, ``√(x² + w²)``."),
    *("-3, 4", 5.0),
)

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
