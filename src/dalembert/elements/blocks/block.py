"""Base class of blocks: signals computed from others by equations of first order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.base import Condition, Scalar
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.stateful import Stateful
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression

Coefficients = tuple[Scalar, ...]
"""Numbers or formulas."""
Signals = dict[str, tuple[ca.SX, str]]
"""Name → (expression, unit)."""


@dataclass(eq=False)
class Block(Stateful):
    """Outputs ``w = g(t, x, u)`` of states ``ẋ = f(t, x, u)``; ``u`` are formulas of measures.

    A new block states ``state_names``, ``rates`` and ``outputs``.
    """

    not_drawn = "a signal has no place"

    def outputs(self) -> Signals:
        """Outputs: name → (expression, unit); states alone need no input."""
        raise NotImplementedError

    def measures(self) -> Signals:
        """States, and outputs if all inputs are present."""
        own = self.state_measures()
        return own | self.outputs() if self.connected else own

    def measure(self, name: str) -> Expression:
        """A state or output in formulas.

        Raises
        ------
        ModelError
            There is none of this name, or an input is missing.
        """
        states = self.state_measures()
        if name in states:
            return self.state(name)
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


def ordered_limits(lower: Scalar | None, upper: Scalar | None) -> list[Condition]:
    """Condition that an upper limit is not below a lower one."""
    if lower is None or upper is None:
        return []
    limits = ca.vertcat(upper.sx, lower.sx)
    text = "upper is {:.6g}, below lower, which is {:.6g}; exchange them"
    return [(upper.sx - lower.sx, text, limits)]


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
