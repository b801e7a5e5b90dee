"""A number between bounds, and what they cost."""

from __future__ import annotations

from dataclasses import dataclass


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
    """

    name: str
    unit: str
    start: float
    value: float
    lower: float | None
    upper: float | None
    active: str = ""
    price: float = 0.0

    def cost(self, unit: str) -> str:
        """``this bound costs 3.1 N per mm`` for an objective in ``unit``."""
        if not self.active or self.price == 0:
            return ""
        price, per = (self.price / 1e3, "mm") if self.unit == "m" else (self.price, self.unit)
        one = per or "1"
        return f"{self.name} at its {self.active} bound costs {price:.4g} {unit}".rstrip() + (
            f" per {one}"
        )
