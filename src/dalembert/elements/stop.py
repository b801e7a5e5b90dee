"""Unilateral spring stops."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import ForceElement, Look, Powers, Rate, Scalar, power_unit, quantity
from dalembert.elements.look import Limit
from dalembert.errors import ModelError


@dataclass(eq=False)
class Stop(ForceElement):
    """Unilateral spring stops at the ends of a coordinate's range.

    At a penetration ``δ`` of a limit ``F = k δ^exponent (1 + c δ̇) ≥ 0`` (Hunt–Crossley damping,
    with which the force vanishes at zero penetration).

    Parameters
    ----------
    coordinate : formula of positions, e.g. ``slider.x``
    lower, upper : limits; at least one
    stiffness : [N/mⁿ] or [N m/radⁿ] with the exponent n; the unit of a text or a parameter is
        checked where n is a number
    damping : [s/m] or [s/rad]
    exponent : 1 linear, 1.5 Hertz

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("buffer", gravity=(0, -10))
    >>> lift = system.add(planar.Particle("lift", mass=50.0, position=(0, -0.02)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, lift.center, axis=(0, 1)))
    >>> buffer = system.add(planar.Stop("buffer", lift.y, lower=0.0, stiffness=1e5))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["lift.y"].item() * 1e3, 6)  # -m g/k [mm]
    -5.0
    """

    coordinate: Scalar = quantity("m | rad", "formula of positions that is limited")
    lower: Scalar = quantity("m | rad", "lower limit", default=None)
    upper: Scalar = quantity("m | rad", "upper limit", default=None)
    stiffness: Scalar = quantity("N/m^n | N m/rad^n", "stiffness", above=0.0, keyword=True)
    damping: Scalar = quantity("s/m | s/rad", "Hunt-Crossley damping", default=0.0, minimum=0.0)
    exponent: Scalar = quantity("", "exponent of the penetration", default=1.0, minimum=1.0)

    def _unit(self, field: str, unit: str | None) -> str | None:
        if field != "stiffness" or unit is None:
            return super()._unit(field, unit)
        return power_unit(unit, self.exponent, f"{self.name}.exponent")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.lower is None and self.upper is None:
            raise ModelError("give a lower or an upper limit", self.name)

    def penetrations(self) -> list[tuple[ca.SX, int]]:
        """(penetration, sign of its derivative by the coordinate) of each limit."""
        s = self.coordinate.sx
        penetrations = []
        if self.lower is not None:
            penetrations.append((self.lower.sx - s, -1))
        if self.upper is not None:
            penetrations.append((s - self.upper.sx, 1))
        return penetrations

    def force(self, rate: Rate) -> ca.SX:
        """Generalised force along the coordinate."""
        total = ca.SX(0)
        for depth, sense in self.penetrations():
            press = self._elastic(depth) * ca.fmax(0, 1 + self.damping.sx * rate(depth))
            total -= sense * press
        return total

    def _elastic(self, depth: ca.SX) -> ca.SX:
        inside = ca.if_else(depth > 0, depth, 1)  # keeps 0^(e−1) out of the derivative
        return ca.if_else(depth > 0, self.stiffness.sx * inside**self.exponent.sx, 0)

    def powers(self, rate: Rate) -> Powers:
        return [(rate(self.coordinate.sx), self.force(rate))]

    def contact_powers(self, rate: Rate, energy: float) -> Powers:
        s, k, e = self.coordinate.sx, self.stiffness.sx, self.exponent.sx
        depth = ((e + 1) * energy / k) ** (1 / (e + 1))
        elastic, viscous = e * k * depth ** (e - 1), self.damping.sx * k * depth**e
        return [(rate(s), -elastic * s - viscous * rate(s))]

    def look(self) -> list[Look]:
        s, limits = self.coordinate.sx, ((self.lower, False), (self.upper, True))
        return [Limit(s, value.sx, above) for value, above in limits if value is not None]

    def potential(self) -> ca.SX:
        e = self.exponent.sx + 1
        total = ca.SX(0)
        for depth, _ in self.penetrations():
            inside = ca.if_else(depth > 0, depth, 1)
            total += ca.if_else(depth > 0, self.stiffness.sx * inside**e / e, 0)
        return total

    def dissipation(self, rate: Rate) -> Powers:
        elastic = sum((-sense * self._elastic(d) for d, sense in self.penetrations()), ca.SX(0))
        return [(rate(self.coordinate.sx), self.force(rate) - elastic)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        turns = self.coordinate.unit == "rad"
        coordinate, force = ("rad", "N m") if turns else ("m", "N")
        return {"coordinate": (self.coordinate.sx, coordinate), "force": (self.force(rate), force)}
