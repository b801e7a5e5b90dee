"""Formulas of a file, each with the names that are allowed where it stands."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from typing import Any, Protocol

from dalembert.errors import ExpressionError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, t
from dalembert.symbolic.formulas.interpolation import Interpolation
from dalembert.symbolic.formulas.parser import parse_formula


class Scope(Enum):
    """What a formula may depend on."""

    PARAMETERS = "parameters"
    TIME = "parameters and t"
    MOTION = "parameters, t and measures"


class Names(Protocol):
    """What formulas may name; a ``System`` under construction is one."""

    @property
    def parameters(self) -> Mapping[str, Expression]: ...

    @property
    def derived_parameters(self) -> Mapping[str, Expression]: ...

    @property
    def tables(self) -> Mapping[str, Interpolation]: ...

    def lookup(self, name: str) -> Any: ...

    def measure_names(self) -> list[str]: ...


class ParameterNames:
    """Parameters and time alone.

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

    def lookup(self, name: str) -> Any:
        """The parameter, the table, or time."""
        found = self.parameters.get(name, t if name == "t" else None)
        return self.tables.get(name) if found is None else found

    def measure_names(self) -> list[str]:
        """There are none before anything is built."""
        return []


class Formulas:
    """Reads numbers and formulas for one model.

    Parameters
    ----------
    system : what they may name
    """

    def __init__(self, system: Names):
        self.system = system
        self.histories: dict[str, Expression] = {}
        """Unknown functions of time, by name."""

    def read(
        self,
        value: float | str,
        scope: Scope = Scope.PARAMETERS,
        local: Mapping[str, Expression] | None = None,
    ) -> float | Expression:
        """The number, or the expression behind the text.

        Raises
        ------
        ExpressionError
            Grammar, unknown names, or names that are not allowed in this scope.
        """
        if not isinstance(value, str):
            return value
        own = dict(local or {})

        def lookup(name: str) -> Any:
            if name in own:
                if name in self._parameters():
                    raise ExpressionError(
                        f"in formula {value[:60]!r}: {name!r} is a variable of this formula and a "
                        "parameter, too; rename the parameter"
                    )
                return own[name]
            if name in self.histories and scope is not Scope.PARAMETERS:
                return self.histories[name]
            found = self.system.lookup(name)
            if found is not None and not self._allowed(name, scope):
                raise ExpressionError(
                    f"in formula {value[:60]!r}: {name!r} changes during the motion, but only "
                    f"{scope.value} are allowed here"
                )
            return found

        found = parse_formula(value, lookup, lambda: self._known(scope, own))
        return found if found.is_parameter else as_expression(found, "")

    def _parameters(self) -> list[str]:
        known = self.system
        return [*known.parameters, *known.derived_parameters, *known.tables]

    def _allowed(self, name: str, scope: Scope) -> bool:
        if scope is Scope.MOTION or name in self._parameters():
            return True
        return name == "t" and scope is Scope.TIME

    def _known(self, scope: Scope, own: Mapping[str, Expression]) -> list[str]:
        known = [*own, *self._parameters()]
        if scope is not Scope.PARAMETERS:
            known += ["t", *self.histories]
        return known + (self.system.measure_names() if scope is Scope.MOTION else [])
