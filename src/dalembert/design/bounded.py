"""Values with bounds at an optimum, and the prices of active bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from dalembert.units.unit import shown_in

STEPS = {"m": ("mm", 1e-3), "m^2": ("mm^2", 1e-6), "Pa": ("MPa", 1e6)}
"""Unit → increment of a bound for which its price is quoted, and its size in that unit."""


@dataclass(frozen=True)
class Bounded:
    """A parameter or a limited response at the optimum.

    Attributes
    ----------
    name, unit
    start, value : at the start and at the optimum
    lower, upper : bounds
    active : active side, ``"lower"``, ``"upper"`` or empty
    price : improvement of the objective per unit by which the active side is relaxed, ≥ 0
    given_unit : unit in which a parameter was declared, such as ``mm``
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
        """Copy in the first of ``units`` with its dimension, else in the unit of its declaration.

        ``objective`` is the factor and the unit of the objective.
        """
        declared = (self.given_unit,) if self.given_unit else ()
        factor, unit = shown_in(self.unit, (*units, *declared))

        def converted(number: float | None) -> float | None:
            return None if number is None else number / factor

        return replace(
            self,
            unit=unit,
            start=self.start / factor,
            value=self.value / factor,
            lower=converted(self.lower),
            upper=converted(self.upper),
            price=self.price * factor / objective[0],
        )

    def cost(self, unit: str) -> str:
        """``this bound costs 3.1 N per mm`` for an objective in ``unit``."""
        if not self.active or self.price == 0:
            return ""
        per, size = STEPS.get(self.unit, (self.unit or "unit", 1.0))
        price = f"{self.price * size:.4g} {unit}".rstrip()
        return f"{self.name} at its {self.active} bound costs {price} per {per}"
