"""Parameters: the numbers a run may change without rebuilding anything."""

from __future__ import annotations

import math
from collections.abc import Mapping

import casadi as ca
import numpy as np

from dalembert.errors import ModelError
from dalembert.symbolic.expression import Expression, refuse_unusable
from dalembert.text import plain_text


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
        A name that is no identifier, a value not finite or outside its bounds, bounds in the
        wrong order.
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
        if not isinstance(name, str) or not name.isidentifier():
            raise ModelError(
                f"{name!r} is not an identifier; use letters, digits and '_'", "parameter"
            )
        super().__init__(ca.SX.sym(name), name, plain_text(unit, f"{name}.unit"))
        self.value = _finite(value, name, "value")
        lower, upper = bounds if bounds is not None else (None, None)
        self.bounds = (
            -math.inf if lower is None else float(lower),
            math.inf if upper is None else float(upper),
        )
        self.description = plain_text(description, f"{name}.description")
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
    refuse_unusable(number, name)
    return number


def parameter_vector(
    parameters: Mapping[str, Parameter], given: Mapping[str, float] | None, owner: str
) -> np.ndarray:
    """Values of all parameters, some replaced by given ones.

    Raises
    ------
    ModelError
        Unknown parameter or a value that is not finite; names the owner or the parameter.
    """
    values = {name: parameter.value for name, parameter in parameters.items()}
    for name, value in (given or {}).items():
        if name not in values:
            known = ", ".join(values) or "none"
            raise ModelError(f"unknown parameter {name!r} (known: {known})", owner)
        values[name] = _finite(value, name, "value")
    return np.array(list(values.values()), dtype=float)
