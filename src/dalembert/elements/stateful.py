"""Elements with states of first order, and inputs that may be assigned after the construction."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca

from dalembert.elements.base import Element, option, quantity
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.states import States
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression

SIGNAL = "signal"
"""Key of the metadata of inputs."""


def signal(unit: str | None, description: str, default: Any = None) -> Any:
    """Field for a formula of measures, which may also be assigned after the construction."""
    field = quantity(unit, description, default=default)
    field.metadata = {**field.metadata, SIGNAL: True}
    return field


def signals(description: str) -> Any:
    """Field for several formulas of measures, which may also be assigned later."""
    field = option(description, default=())
    field.metadata = {**field.metadata, SIGNAL: True}
    return field


@dataclass(eq=False)
class Stateful(Element):
    """States ``ẋ = f(t, y, v, x, u)`` with inputs ``u``, formulas of measures.

    As inputs may be assigned after the construction, elements can depend on each other. A new
    element states ``state_names``, ``rates`` and ``initial_states``.

    Parameters
    ----------
    steady : start where the rates of the states are zero
    """

    steady: bool = option(
        "start where the rates of the states are zero", default=False, keyword=True
    )

    fixed_states: ClassVar[tuple[str, ...]] = ()
    """Names of the states of a class whose elements all have the same."""

    def __post_init__(self) -> None:
        super().__post_init__()
        names, units = self.state_names(), self.state_units()
        start = [None] * len(names) if self.steady else self.initial_states()
        self.states = States(self.name, names, units, self._rates_if_connected, start)

    def __setattr__(self, name: str, value: Any) -> None:
        meta = next((m for field, m in self.quantities() if field == name and SIGNAL in m), None)
        if meta is not None and value is not None:
            value = as_expression(value, f"{self.name}.{name}", meta["unit"], meta["size"])
        super().__setattr__(name, value)

    def state_names(self) -> Sequence[str]:
        """Names of the states."""
        return self.fixed_states

    def state_units(self) -> Sequence[str]:
        """Units of the states; none by default."""
        return ("",) * len(self.state_names())

    def initial_states(self) -> Sequence[ca.SX | None]:
        """Values of the states at the start, None where they begin at rest; zero by default."""
        return [ca.SX(0)] * len(self.state_names())

    def rates(self) -> ca.SX:
        """(n,) ``f``."""
        return ca.SX(0, 1)

    def _rates_if_connected(self) -> ca.SX:
        """``f``; zero while inputs are missing, without which a model is not built."""
        return self.rates() if self.connected else ca.SX.zeros(len(self.state_names()))

    def input_of(self, field: str) -> ca.SX:
        """Formula of an input.

        Raises
        ------
        ModelError
            It is missing.
        """
        formula = getattr(self, field)
        if formula is None:
            raise ModelError(f"has no {field}; give {field}=..., or assign it", self.name)
        return formula.sx  # type: ignore[no-any-return]

    @property
    def connected(self) -> bool:
        """Whether all inputs are present."""
        inputs = [getattr(self, f.name) for f in dataclasses.fields(self) if SIGNAL in f.metadata]
        return not any(
            value is None or (isinstance(value, tuple) and not value) for value in inputs
        )

    def state_measures(self) -> dict[str, tuple[ca.SX, str]]:
        """States: name → (symbol, unit)."""
        states = self.states
        entries = zip(states.coordinate_names, states.coordinate_units, strict=True)
        return {name: (states.pose[k], unit) for k, (name, unit) in enumerate(entries)}

    def state(self, name: str) -> Expression:
        """A state in formulas.

        Raises
        ------
        ModelError
            There is none of this name.
        """
        own = self.state_measures()
        if name not in own:
            raise ModelError(f"has no state {name!r}; it has {', '.join(own)}", self.name)
        return Expression(own[name][0], f"{self.name}.{name}", own[name][1])

    def own_coordinates(self) -> list[Coordinates]:
        return [self.states] if self.states.coordinate_names else []
