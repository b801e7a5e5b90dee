"""Formulas of a file, each with the names that are allowed where it stands."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum

from dalembert.errors import ExpressionError
from dalembert.model.system import System
from dalembert.symbolic.expression import Expression, as_expression
from dalembert.symbolic.parser import parse_formula


class Scope(Enum):
    """What a formula may depend on."""

    PARAMETERS = "parameters"
    TIME = "parameters and t"
    MOTION = "parameters, t and measures"


class Formulas:
    """Reads numbers and formulas for one system.

    Parameters
    ----------
    system : System under construction
    """

    def __init__(self, system: System):
        self.system = system

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

        def lookup(name: str) -> Expression | None:
            if name in own:
                return own[name]
            found = self.system.lookup(name)
            if found is not None and not self._allowed(name, scope):
                raise ExpressionError(
                    f"in formula {value[:60]!r}: {name!r} changes during the motion, but only "
                    f"{scope.value} are allowed here"
                )
            return found

        return as_expression(parse_formula(value, lookup, lambda: self._known(scope, own)), "")

    def _parameters(self) -> list[str]:
        return [*self.system.parameters, *self.system.derived_parameters]

    def _allowed(self, name: str, scope: Scope) -> bool:
        if scope is Scope.MOTION or name in self._parameters():
            return True
        return name == "t" and scope is Scope.TIME

    def _known(self, scope: Scope, own: Mapping[str, Expression]) -> list[str]:
        known = [*own, *self._parameters()]
        if scope is not Scope.PARAMETERS:
            known.append("t")
        return known + (self.system.measure_names() if scope is Scope.MOTION else [])
