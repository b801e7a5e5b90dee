"""How bodies rub where they touch: friction by normal force and speed of slip."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Scalar, quantity
from dalembert.elements.ingredient import Ingredient

AT_REST = 1e-6
"""Slip, relative to the transition speed, up to which its direction is smoothed."""


@dataclass(eq=False)
class Friction(Ingredient):
    """Force along the surface against the slip ``u``, ``T = −μ(|u|) N u/|u|``."""

    def sliding(self) -> ca.SX:
        """Coefficient of bodies that slide, for impacts of rigid ones."""
        raise NotImplementedError

    def force(self, press: ca.SX, slip: ca.SX) -> ca.SX:
        """(k,) force at a normal force [N] and a slip (k,) [m/s]."""
        raise NotImplementedError


@dataclass(eq=False)
class Coulomb(Friction):
    """Dry friction made smooth (Brown and McPhee 2016); with ``x = |u|/v_t``,

        μ = μ_d tanh 4x + (μ_s − μ_d) x / (x²/4 + 3/4)².

    Where it should stick it creeps, by about ``v_t T/(4 μ_d N)``.

    Parameters
    ----------
    dynamic : coefficient of sliding friction μ_d
    static : the largest coefficient μ_s, reached at the transition speed; as dynamic by default
    slip_speed : transition speed v_t [m/s]
    """

    dynamic: Scalar = quantity("", "coefficient of sliding friction", minimum=0.0)
    static: Scalar = quantity("", "largest coefficient of friction", default=None, minimum=0.0)
    slip_speed: Scalar = quantity("m/s", "transition speed", default=1e-3, above=0.0)

    @property
    def excess(self) -> ca.SX:
        """``μ_s − μ_d``."""
        return ca.SX(0) if self.static is None else self.static.sx - self.dynamic.sx

    def conditions(self) -> list[Condition]:
        return [*super().conditions(), (self.excess, "static= is below dynamic=")]

    def sliding(self) -> ca.SX:
        return self.dynamic.sx

    def coefficient(self, x: ca.SX) -> ca.SX:
        """``μ`` at a speed relative to the transition speed."""
        return self.dynamic.sx * ca.tanh(4 * x) + self.excess * x / (x**2 / 4 + 0.75) ** 2

    def force(self, press: ca.SX, slip: ca.SX) -> ca.SX:
        direction = slip / self.slip_speed.sx
        x = ca.sqrt(ca.sumsqr(direction) + AT_REST**2)
        return -press * self.coefficient(x) * direction / x


@dataclass(eq=False)
class Stribeck(Coulomb):
    """Friction that falls over a speed of its own, and grows again where it is lubricated,

        μ = (μ_d + (μ_s − μ_d) exp(−(u/v_s)²)) tanh 4x + η |u|,  x = |u|/v_t.

    Parameters
    ----------
    stribeck_speed : v_s, by which it has fallen [m/s]
    viscous : η [s/m]
    """

    stribeck_speed: Scalar = quantity("m/s", "Stribeck speed", default=1e-2, above=0.0)
    viscous: Scalar = quantity("s/m", "viscous part", default=0.0, minimum=0.0)

    def coefficient(self, x: ca.SX) -> ca.SX:
        speed = self.slip_speed.sx * x
        fallen = ca.exp(-((speed / self.stribeck_speed.sx) ** 2))
        dry = (self.dynamic.sx + self.excess * fallen) * ca.tanh(4 * x)
        return dry + self.viscous.sx * speed
