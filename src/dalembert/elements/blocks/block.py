"""Base class of blocks: signals computed from others by equations of first order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from dalembert.elements.base import Element, Scalar, option, quantity
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.states import States
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression

Coefficients = tuple[Scalar, ...]
"""Numbers or formulas."""
Signals = dict[str, tuple[ca.SX, str]]
"""Name → (expression, unit)."""


SIGNAL = "signal"
"""Key of the metadata of inputs."""


def signal(unit: str, description: str, default: Any = None) -> Any:
    """Field for a formula of measures, which may also be assigned after the construction."""
    field = quantity(unit, description, default=default)
    field.metadata = {**field.metadata, SIGNAL: True}
    return field


@dataclass(eq=False)
class Block(Element):
    """Outputs ``w = g(t, x, u)`` of states ``ẋ = f(t, x, u)``; ``u`` are formulas of measures.

    Inputs may be assigned after the construction, so that blocks and forces can depend on each
    other. A new block states ``state_names``, ``rates`` and ``outputs``.
    """

    steady: bool = option("start where the rates of the states are zero", default=False, keyword=True)

    not_drawn: ClassVar[str] = "a signal has no place"

    def __post_init__(self) -> None:
        super().__post_init__()
        names, units = self.state_names(), self.state_units()
        start = [None] * len(names) if self.steady else self.initial_states()
        self.states = States(self.name, names, units, self.rates, start)

    def __setattr__(self, name: str, value: Any) -> None:
        meta = next((m for field, m in self.quantities() if field == name and SIGNAL in m), None)
        if meta is not None and value is not None:
            value = as_expression(value, f"{self.name}.{name}", meta["unit"], meta["size"])
        super().__setattr__(name, value)

    def state_names(self) -> Sequence[str]:
        """Names of the states; none by default."""
        return ()

    def state_units(self) -> Sequence[str]:
        """Units of the states; none by default."""
        return ("",) * len(self.state_names())

    def initial_states(self) -> list[ca.SX]:
        """Values of the states at the start; zero by default."""
        return [ca.SX(0)] * len(self.state_names())

    def rates(self) -> ca.SX:
        """(n,) ``f``."""
        return ca.SX(0, 1)

    def outputs(self) -> Signals:
        """Outputs: name → (expression, unit); states alone need no input."""
        raise NotImplementedError

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

    def measures(self) -> Signals:
        """States and outputs."""
        states = self.states
        entries = zip(states.coordinate_names, states.coordinate_units, strict=True)
        own = {name: (states.pose[k], unit) for k, (name, unit) in enumerate(entries)}
        return own | self.outputs()

    def measure(self, name: str) -> Expression:
        """A state or output in formulas.

        Raises
        ------
        ModelError
            There is none of this name, or an input is missing.
        """
        states = self.states.coordinate_names
        if name in states:
            k = states.index(name)
            unit = self.states.coordinate_units[k]
            return Expression(self.states.pose[k], f"{self.name}.{name}", unit)
        measures = self.outputs()
        if name not in measures:
            names = ", ".join([*states, *measures])
            raise ModelError(f"has no {name!r}; it has {names}", self.name)
        sx, unit = measures[name]
        return Expression(sx, f"{self.name}.{name}", unit)

    @property
    def output(self) -> Expression:
        """The output of a block with one."""
        return self.measure("output")

    def parts(self) -> list[Coordinates]:
        return []

    def own_coordinates(self) -> list[Coordinates]:
        return [self.states] if self.states.coordinate_names else []


def coefficients(values: Coefficients, entity: str) -> tuple[Expression, ...]:
    """Several numbers or formulas.

    Raises
    ------
    ModelError
        Not a list, or an empty one.
    """
    if isinstance(values, (str, Expression)) or not isinstance(values, (Sequence, np.ndarray)):
        raise ModelError(f"is {values!r:.60}; give a list of numbers or formulas", entity)
    if not len(values):
        raise ModelError("is empty; give at least one number", entity)
    return tuple(as_expression(value, f"{entity}[{k}]") for k, value in enumerate(values))
