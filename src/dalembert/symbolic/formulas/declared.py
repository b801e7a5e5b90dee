"""What is declared by name for formulas: parameters and tables of values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from dalembert.errors import ModelError
from dalembert.symbolic.formulas.interpolation import Interpolation
from dalembert.symbolic.formulas.parameter import Bounds, Parameter
from dalembert.text.spelling import spelled

CONSTANTS = {"pi": "the number π"}
"""Names that mean something else in every formula, and what."""
VARIABLES = CONSTANTS | {
    "t": "the time",
    "time": "the time",
    **{f"{kind}energy": "a measure of the whole" for kind in ("", "kinetic_", "potential_")},
    **{f"{kind}_power": "a measure of the whole" for kind in ("dissipated", "input")},
}
"""The same of a mechanism."""


def check_free(name: str, meanings: Mapping[str, str], owner: str, kind: str = "formulas") -> None:
    """Refuse a name that has a meaning of its own.

    Raises
    ------
    ModelError
        Names the meaning.
    """
    if name in meanings:
        raise ModelError(
            f"the name {name!r} is reserved: in {kind} it is {meanings[name]}; choose another",
            owner,
        )


class Declared:
    """A builder of something that depends on parameters.

    Names that stand in formulas by themselves, of parameters and tables, are different from each
    other; so are those of elements, whose quantities have a dot in formulas.
    """

    meanings: ClassVar[Mapping[str, str]] = CONSTANTS
    """Names that parameters and tables cannot have, and what they mean."""

    name: str
    parameters: dict[str, Parameter]
    tables: dict[str, Interpolation]

    @spelled
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
        made = Parameter(name, value, unit, bounds, description)
        self.parameters[name] = made
        return made

    @spelled
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
        """Declare a table of values, to be called like a function, see ``Interpolation``.

        Texts of formulas name it: ``interp(piston.x, gas)``.
        """
        self._declare(name)
        made = Interpolation(x, y, kind, outside, units, name, ends)
        self.tables[name] = made
        return made

    @property
    def _values(self) -> tuple[Mapping[str, Any], ...]:
        """All that stands in formulas by its name alone."""
        return self.parameters, self.tables

    @property
    def _parts(self) -> tuple[Mapping[str, Any], ...]:
        """All whose quantities stand in formulas, after a dot."""
        raise NotImplementedError

    def _declare(self, name: str) -> None:
        """Claim a name that stands in formulas by itself."""
        check_free(name, self.meanings, self.name)
        _refuse_taken(name, self._values)

    def _claim(self, name: str) -> None:
        """Claim the name of an element or node."""
        _refuse_taken(name, self._parts)


def _refuse_taken(name: str, sections: Sequence[Mapping[str, Any]]) -> None:
    if any(name in section for section in sections):
        raise ModelError("the name is already used; choose a different one", name)
