"""Parameters: the numbers a run may change without rebuilding anything."""

from __future__ import annotations

import math

import casadi as ca

from dalembert.errors import ModelError
from dalembert.symbolic.expression import Expression


class Parameter(Expression):
    """A named number with unit, bounds and description.

    Parameters
    ----------
    name : str
        Identifier, usable in formulas.
    value : float
        Nominal value, in SI units.
    unit, description : str
        Shown in results and reports.
    bounds : (float, float), optional
        Lower and upper bound for design; None leaves a side open.

    Raises
    ------
    ModelError
        Value not finite, bounds in the wrong order, value outside its bounds.
    """

    __slots__ = ("bounds", "description", "value")

    def __init__(
        self,
        name: str,
        value: float,
        unit: str = "",
        bounds: tuple[float | None, float | None] | None = None,
        description: str = "",
    ):
        super().__init__(ca.SX.sym(name), name, unit)
        self.value = _finite(value, name, "value")
        lower, upper = bounds if bounds is not None else (None, None)
        self.bounds = (
            -math.inf if lower is None else float(lower),
            math.inf if upper is None else float(upper),
        )
        self.description = description
        if math.isnan(self.bounds[0]) or math.isnan(self.bounds[1]):
            raise ModelError(f"bounds {bounds} contain NaN; give numbers", name)
        if self.bounds[0] > self.bounds[1]:
            raise ModelError(f"lower bound {lower} is above upper bound {upper}; swap them", name)
        if not self.bounds[0] <= self.value <= self.bounds[1]:
            raise ModelError(f"value {value} lies outside its bounds [{lower}, {upper}]", name)


def _finite(value, name: str, what: str) -> float:
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ModelError(f"{what} {value!r} is not a number", name) from None
    if isinstance(value, bool) or not math.isfinite(number):
        raise ModelError(f"{what} {value} is not a finite number", name)
    return number
