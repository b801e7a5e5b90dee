"""Components of elements with quantities: laws, shapes."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from dalembert.elements.base import Condition
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.arguments import CheckedArguments


@dataclass(eq=False)
class Component(CheckedArguments):
    """A component of an element without a name, with quantities like an element."""

    def __post_init__(self) -> None:
        for field in self._quantity_fields():
            value, meta = getattr(self, field.name), field.metadata
            entity = f"{type(self).__name__}.{field.name}"
            if value is None and field.default is not None:
                optional = field.default is not dataclasses.MISSING
                remedy = "give a number, or leave it out" if optional else "give a number"
                raise ModelError(f"is None; {remedy}", entity)
            if value is not None:
                unit = self._unit(field.name, meta["unit"])
                setattr(self, field.name, as_expression(value, entity, unit, meta["size"]))

    def _unit(self, field: str, unit: str | None) -> str | None:
        """Expected unit of a quantity; subclasses override it where other fields determine it."""
        return unit

    def _quantity_fields(self) -> list[dataclasses.Field[Any]]:
        return [f for f in dataclasses.fields(self) if f.metadata.get("kind") == "quantity"]

    def conditions(self) -> list[Condition]:
        """Conditions at the values of the parameters, as ``Element.conditions``."""
        return []

    def checked_quantities(self, owner: str) -> list[tuple[str, Expression, Mapping]]:
        """(``owner.field``, formula, metadata) of the quantities, checked by the build."""
        return [
            (f"{owner}.{field.name}", getattr(self, field.name), field.metadata)
            for field in self._quantity_fields()
            if isinstance(getattr(self, field.name), Expression)
        ]
