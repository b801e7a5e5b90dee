"""What a motion law is: a function of time with quantities like any element."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.symbolic.expression import Expression, as_expression, t


@dataclass(eq=False)
class Law:
    """Prescribed value ``f(t)``; differentiable twice for velocities and accelerations."""

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if field.metadata.get("kind") == "quantity" and value is not None:
                entity = f"{type(self).__name__}.{field.name}"
                meta = field.metadata
                setattr(self, field.name, as_expression(value, entity, meta["unit"], meta["size"]))

    def value(self, time: ca.SX) -> ca.SX:
        """``f(t)`` as an expression."""
        raise NotImplementedError

    def conditions(self) -> list[tuple[ca.SX, str]]:
        """(expression of parameters that must not be negative, what is wrong if it is)."""
        return []

    def checked_quantities(self, owner: str) -> list[tuple[str, Expression, Mapping]]:
        return [
            (f"{owner}.{field.name}", getattr(self, field.name), field.metadata)
            for field in dataclasses.fields(self)
            if isinstance(getattr(self, field.name), Expression)
            and field.metadata.get("kind") == "quantity"
        ]


@dataclass(eq=False)
class Formula(Law):
    """``f(t)`` as written by the user, in ``t`` and parameters."""

    formula: Scalar = quantity("", "formula in t and parameters")

    def value(self, time: ca.SX) -> ca.SX:
        return ca.substitute(self.formula.sx, t.sx, time)


def as_law(value, entity: str) -> Law:
    """A law as it is, or a number or formula in ``t`` made into one."""
    if isinstance(value, Law):
        return value
    return Formula(as_expression(value, entity))
