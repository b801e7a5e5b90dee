"""A number between bounds, and what they cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from dalembert.units.unit import shown_in

STEPS = {"m": ("mm", 1e-3), "m^2": ("mm^2", 1e-6), "Pa": ("MPa", 1e6)}
"""Unit → what a bound in it is let out by, and its size."""


@dataclass(frozen=True)
class Bounded:
    """A parameter or a limited response at the optimum.

    Attributes
    ----------
    name, unit
    start, value : at the start and at the optimum
    lower, upper : what it may not leave
    active : the side that it stands at, ``"lower"`` or ``"upper"``, or none
    price : what the objective gains for each unit by which that side is let out, not negative
    given_unit : the unit in which a parameter was declared, such as ``mm``
    """

    name: str
    unit: str
    start: float
    value: float
    lower: float | None
    upper: float | None
    active: str = ""
    price: float = 0.0
    given_unit: str = ""

    def shown_in(self, units: Sequence[str], objective: tuple[float, str]) -> Bounded:
        """The same in the first of these units of its dimension, else in that of its declaration.

        ``objective`` is the factor and the unit of the objective.
        """
        own = (self.given_unit,) if self.given_unit else ()
        factor, unit = shown_in(self.unit, (*units, *own))

        def of(number: float | None) -> float | None:
            return None if number is None else number / factor

        return replace(
            self,
            unit=unit,
            start=self.start / factor,
            value=self.value / factor,
            lower=of(self.lower),
            upper=of(self.upper),
            price=self.price * factor / objective[0],
        )

    def cost(self, unit: str) -> str:
        """``this bound costs 3.1 N per mm`` for an objective in ``unit``."""
        if not self.active or self.price == 0:
            return ""
        per, size = STEPS.get(self.unit, (self.unit or "unit", 1.0))
        price = f"{self.price * size:.4g} {unit}".rstrip()
        return f"{self.name} at its {self.active} bound costs {price} per {per}"
