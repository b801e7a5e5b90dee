"""What NumPy calls the operators and functions of formulas."""

from __future__ import annotations

import operator

import casadi as ca

OPERATORS = {
    "add": operator.add,
    "subtract": operator.sub,
    "multiply": operator.mul,
    "divide": operator.truediv,
    "true_divide": operator.truediv,
    "power": operator.pow,
    "less": operator.lt,
    "less_equal": operator.le,
    "greater": operator.gt,
    "greater_equal": operator.ge,
}
"""What NumPy calls the operators."""
FUNCTIONS = {
    **{name: getattr(ca, name) for name in "sin cos tan sinh cosh tanh exp log sqrt".split()},
    **{f"arc{name}": getattr(ca, f"a{name}") for name in ("sin", "cos", "tan", "tan2")},
    "hypot": ca.hypot,
    "absolute": ca.fabs,
    "fabs": ca.fabs,
    "sign": ca.sign,
    "floor": ca.floor,
    "minimum": ca.fmin,
    "maximum": ca.fmax,
    "negative": operator.neg,
}
"""What NumPy calls the functions of formulas."""
