"""What is declared by name for formulas: parameters and tables of values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from dalembert.errors import ModelError
from dalembert.symbolic.formulas.interpolation import Interpolation
from dalembert.symbolic.formulas.parameter import Bounds, Parameter

RESERVED = {"t", "u", "pi", "e", "ground", "system", "extension", "rate"}
"""Names that mean something else in formulas."""


class Declared:
    """A builder of something that depends on parameters; no name is given twice."""

    name: str
    parameters: dict[str, Parameter]
    tables: dict[str, Interpolation]

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
    def _named(self) -> tuple[Mapping[str, Any], ...]:
        """All that has a name."""
        raise NotImplementedError

    def _declare(self, name: str) -> None:
        """Claim a name that stands in formulas by itself."""
        if name in RESERVED:
            raise ModelError(f"the name {name!r} is reserved; choose another", self.name)
        self._claim(name)

    def _claim(self, name: str) -> None:
        if any(name in section for section in self._named):
            raise ModelError("the name is already used; choose a different one", name)
