"""Formulas of a file, with the names that are allowed in their context."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import Any, Protocol

from dalembert.errors import ExpressionError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, t
from dalembert.symbolic.formulas.inputs import Input
from dalembert.symbolic.formulas.interpolation import Interpolation
from dalembert.symbolic.formulas.parser import parse_formula


class Scope(Enum):
    """Quantities that a formula may depend on."""

    PARAMETERS = "parameters"
    TIME = "parameters and t"
    MOTION = "parameters, t and measures"


class Namespace(Protocol):
    """Names available to formulas; a ``System`` under construction is one."""

    @property
    def parameters(self) -> Mapping[str, Expression]: ...

    @property
    def derived_parameters(self) -> Mapping[str, Expression]: ...

    @property
    def tables(self) -> Mapping[str, Interpolation]: ...

    def lookup(self, name: str) -> Expression | Interpolation | None: ...

    def measure_names(self) -> list[str]: ...


class ParameterNames:
    """Namespace of parameters, tables and time.

    Parameters
    ----------
    parameters : name → Parameter
    tables : name → table
    """

    def __init__(
        self,
        parameters: Mapping[str, Expression],
        tables: Mapping[str, Interpolation] | None = None,
    ):
        self.parameters = parameters
        self.tables: Mapping[str, Interpolation] = {} if tables is None else tables
        self.derived_parameters: Mapping[str, Expression] = {}

    def lookup(self, name: str) -> Expression | Interpolation | None:
        """The parameter, the table, or time."""
        value = self.parameters.get(name, t if name == "t" else None)
        return self.tables.get(name) if value is None else value

    def measure_names(self) -> list[str]:
        """Empty: no measures exist before the model is built."""
        return []


class Formulas:
    """Parser of the numbers and formulas of one model.

    Parameters
    ----------
    system : namespace of the formulas
    """

    def __init__(self, system: Namespace):
        self.system = system
        self.histories: dict[str, Expression] = {}
        """Unknown functions of time, by name."""

    def read(
        self,
        value: float | str,
        scope: Scope = Scope.PARAMETERS,
        local: Mapping[str, Expression] | None = None,
    ) -> float | Expression:
        """Convert a number or the text of a formula.

        Raises
        ------
        ExpressionError
            Grammar, unknown names, or names that are not allowed in this scope.
        """
        if not isinstance(value, str):
            return value
        variables = dict(local or {})

        def lookup(name: str) -> Any:
            if name in variables:
                if name in self._parameters():
                    raise ExpressionError(
                        f"in formula {value[:60]!r}: {name!r} is a variable of this formula and a "
                        "parameter, too; rename the parameter"
                    )
                return variables[name]
            if name in self.histories and scope is not Scope.PARAMETERS:
                return self.histories[name]
            entry = self.system.lookup(name)
            if entry is not None and not self._allowed(name, scope):
                raise ExpressionError(
                    f"in formula {value[:60]!r}: {name!r} changes during the motion, but only "
                    f"{scope.value} are allowed here"
                )
            return entry

        parsed = parse_formula(value, lookup, lambda: self._known(scope, variables))
        return parsed if parsed.is_parameter else as_expression(parsed, "")

    def _parameters(self) -> list[str]:
        system = self.system
        return [*system.parameters, *system.derived_parameters, *system.tables]

    def _allowed(self, name: str, scope: Scope) -> bool:
        if scope is Scope.MOTION:
            return True
        parameter = self.system.parameters.get(name)
        if isinstance(parameter, Input) and not parameter.is_constant:
            return scope is Scope.TIME
        if name in self._parameters():
            return True
        return name == "t" and scope is Scope.TIME

    def _known(self, scope: Scope, variables: Mapping[str, Expression]) -> list[str]:
        names = [*variables, *self._parameters()]
        if scope is not Scope.PARAMETERS:
            names += ["t", *self.histories]
        return names + (self.system.measure_names() if scope is Scope.MOTION else [])
