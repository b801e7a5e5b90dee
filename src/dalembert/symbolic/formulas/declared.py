"""Named declarations for formulas: parameters, derived parameters and tables of values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar, Protocol

import casadi as ca

from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, t
from dalembert.symbolic.formulas.inputs import Input, Output
from dalembert.symbolic.formulas.interpolation import Interpolation
from dalembert.symbolic.formulas.parameter import Bounds, Parameter, coherent
from dalembert.text.arguments import check_arguments
from dalembert.text.wording import check_length, plain_text, table

CONSTANTS = {"pi": "the number π"}
"""Reserved names of all formulas, with their meaning."""
VARIABLES = CONSTANTS | {
    "t": "the time",
    "time": "the time",
    **{f"{kind}energy": "a measure of the whole" for kind in ("", "kinetic_", "potential_")},
    **{f"{kind}_power": "a measure of the whole" for kind in ("dissipated", "input")},
}
"""Reserved names of formulas of a mechanism, with their meaning."""


def check_free(name: str, meanings: Mapping[str, str], owner: str, kind: str = "formulas") -> None:
    """Check that a name is not reserved.

    Raises
    ------
    ModelError
        The name is reserved; the message states its meaning.
    """
    if name in meanings:
        raise ModelError(
            f"the name {name!r} is reserved: in {kind} it is {meanings[name]}; choose another",
            owner,
        )


class Declared:
    """A builder of a parametric model.

    Names of parameters, derived parameters and tables, which formulas use without a dot, are
    unique; so are names of elements and nodes, whose quantities follow a dot.

    Parameters
    ----------
    name : str
    description : str
    """

    meanings: ClassVar[Mapping[str, str]] = CONSTANTS
    """Reserved names of parameters and tables, with their meaning."""

    def __init__(self, name: str, description: str = ""):
        kind = type(self).__name__.lower()
        self.name = plain_text(name, f"name of the {kind}")
        self.description = plain_text(description, f"description of the {kind}")
        self.parameters: dict[str, Parameter] = {}
        self.derived_parameters: dict[str, Expression] = {}
        self.tables: dict[str, Interpolation] = {}
        self.outputs: dict[str, Output] = {}

    @check_arguments
    def parameter(
        self,
        name: str,
        value: float | str,
        unit: str = "",
        bounds: Bounds = None,
        description: str = "",
    ) -> Parameter:
        """Declare a parameter; use it in formulas wherever a number is accepted.

        See ``Parameter``; value and bounds are in ``unit``, or texts such as ``"45 mm"``.
        """
        self._declare(name)
        parameter = Parameter(name, value, unit, bounds, description)
        self.parameters[name] = parameter
        return parameter

    @check_arguments
    def derived(self, name: str, formula, unit: str = "", description: str = "") -> Expression:
        """Name a formula of parameters; it is listed with the parameters.

        Without a ``unit`` it has the unit of the formula, if that is known.
        """
        self._declare(name)
        expression = as_expression(formula, name, coherent(unit, name) if unit else None)
        if not unit:
            expression.unit = getattr(formula, "unit", "")
        expression.name = name
        self.derived_parameters[name] = expression
        return expression

    @check_arguments
    def input(
        self,
        name: str,
        value: float | str | Expression = 0.0,
        unit: str = "",
        bounds: Bounds = None,
        description: str = "",
    ) -> Expression:
        """Declare an input, a parameter by which other programs act on the model; see ``Input``.

        Returns
        -------
        Expression
            The input in formulas.
        """
        self._declare(name)
        new = Input(name, value, unit, bounds, description)
        symbols = [t.sx, new.sx, *(p.sx for p in self.parameters.values())]
        new.check_symbols(ca.vertcat(*symbols))
        self.parameters[name] = new
        return new.signal

    @check_arguments
    def output(
        self, name: str, formula: str | Expression, unit: str = "", description: str = ""
    ) -> None:
        """Name a formula of measures, a quantity that other programs observe.

        Results contain it under this name. Without a ``unit`` it has the unit of the formula, if
        that is known.
        """
        self._declare(name)
        unit = coherent(unit, name) if unit else ""
        self.outputs[name] = Output(name, formula, unit, description)

    @check_arguments
    def table(
        self,
        name: str,
        x: Sequence[Any],
        y: Sequence[Any],
        kind: str = "spline",
        outside: str = "error",
        units: tuple[str, str] = ("", ""),
        ends: str = "not-a-knot",
    ) -> Interpolation:
        """Declare a table of values, called like a function; see ``Interpolation``.

        In the text of a formula: ``interp(piston.x, gas)``.
        """
        self._declare(name)
        table = Interpolation(x, y, kind, outside, units, name, ends)
        self.tables[name] = table
        return table

    @property
    def _parts(self) -> tuple[Mapping[str, Any], ...]:
        """Sections whose quantities are used in formulas after a dot."""
        raise NotImplementedError

    def _declare(self, name: str) -> None:
        """Claim a name that formulas use without a dot."""
        if isinstance(name, str):
            check_length(name, self.name)
        check_free(name, self.meanings, self.name)
        _check_unused(name, (self.parameters, self.derived_parameters, self.tables, self.outputs))

    def _claim(self, name: str) -> None:
        """Claim the name of an element or node."""
        _check_unused(name, self._parts)


class Declarations(Protocol):
    """Holder of declared values, such as a builder or a frozen description."""

    parameters: dict[str, Parameter]
    derived_parameters: dict[str, Expression]
    tables: dict[str, Interpolation]


def declared(owner: Declarations, name: str) -> Any:
    """The parameter, derived parameter, table or time of this name; None for others."""
    parameter = owner.parameters.get(name)
    if isinstance(parameter, Input):
        return parameter.signal
    for section in (owner.parameters, owner.derived_parameters, owner.tables):
        if name in section:
            return section[name]
    return t if name == "t" else None


def parameter_table(parameters: Mapping[str, Parameter]) -> str:
    """Parameters as an HTML table, for notebooks."""
    rows = [
        (p.name, float(p.value), p.unit or "–", _bounds_text(p.bounds), p.description)
        for p in parameters.values()
    ]
    return table(rows, ("parameter", "value", "unit", "bounds", ""))


def _bounds_text(bounds: tuple[float | None, float | None]) -> str:
    low, high = ("" if value is None else f"{value:g}" for value in bounds)
    return f"{low} … {high}" if low or high else "–"


def _check_unused(name: str, sections: Sequence[Mapping[str, Any]]) -> None:
    if any(name in section for section in sections):
        raise ModelError("the name is already used; choose a different one", name)
