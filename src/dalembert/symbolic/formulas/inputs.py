"""Named inputs and outputs: quantities by which other programs drive and observe a model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.errors import ExpressionError, ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.formulas.parameter import Bounds, Parameter, coherent
from dalembert.units.grammar import amount_of


class Input(Parameter):
    """A quantity that acts on a model from outside: a force, a voltage, the height of a road.

    An input is a parameter, so that runs, batches and gradients treat it as one. With a formula of
    time, ``u = formula + value``, and the value, 0 by default, is the deviation from the formula.

    Parameters
    ----------
    name : str
    value : number, text with a unit, or a formula of ``t``, parameters and tables
    unit, bounds, description : as of a parameter; the unit of a formula is an SI unit

    Attributes
    ----------
    signal : Expression
        ``u`` in formulas.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("car on a road")
    >>> road = system.input("road", 0.01 * da.sin(2 * math.pi * da.t), unit="m")
    >>> car = system.add(planar.Particle("car", mass=1.0, position=(0, 1)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, car.center, axis=(0, 1)))
    >>> drive = system.add(planar.CoordinateDriver("tyre", car.center, 1 + road, direction=(0, 1)))
    >>> model = system.build()
    >>> list(model.inputs), round(da.solve_kinematics(model, 0.25)["car.y"][-1].item(), 4)
    (['road'], 1.01)
    >>> isinstance(model.inputs["road"], da.Input)
    True
    """

    __slots__ = ("signal",)
    role = "input"

    def __init__(
        self, name: str, value: Any = 0.0, unit: str = "", bounds: Bounds = None, description=""
    ):
        constant = not is_formula(value)
        super().__init__(name, value if constant else 0.0, unit, bounds, description)
        self.signal: Expression = self
        if not constant:
            formula = as_expression(value, name, coherent(unit, name) if unit else None)
            self.signal = (formula + self).named(name, self.unit)
            self.signal.splines = formula.splines

    @property
    def is_constant(self) -> bool:
        """Whether it changes only from outside."""
        return self.signal is self

    def check_symbols(self, parameters: ca.SX) -> None:
        """Check that the formula depends on time and declared parameters only.

        Raises
        ------
        ModelError
            It depends on a measure; names it.
        """
        others = ca.symvar(self.signal.sx)
        allowed = {s.element_hash() for s in ca.vertsplit(parameters)}
        wrong = [s.name() for s in others if s.element_hash() not in allowed]
        if wrong:
            raise ModelError(
                f"depends on {wrong[0]!r}; an input is a formula of t and parameters, and formulas "
                "of measures are written where the input acts",
                self.name,
            )


def is_formula(value: Any) -> bool:
    """Whether a value is an expression or the text of one, not a number or a number with a unit."""
    if not isinstance(value, str):
        return isinstance(value, Expression)
    try:
        amount_of(value)
    except ExpressionError:
        return True
    return False


@dataclass(frozen=True)
class Output:
    """A formula of measures under a name.

    Parameters
    ----------
    name : str
    formula : text or expression
    unit : SI unit; that of the formula by default
    description : str
    """

    name: str
    formula: str | Expression
    unit: str = ""
    description: str = ""
