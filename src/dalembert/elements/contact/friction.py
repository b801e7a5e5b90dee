"""Friction laws: force as a function of normal force and slip."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Scalar, quantity
from dalembert.elements.component import Component

AT_REST = 1e-6
"""Slip over the transition speed below which the direction of slip is regularised [-]."""


@dataclass(eq=False)
class Friction(Component):
    """Force along the surface against the slip ``u``, ``T = −μ(|u|) N u/|u|``."""

    def sliding_coefficient(self) -> ca.SX:
        """Coefficient of sliding friction, for impacts of rigid bodies."""
        raise NotImplementedError

    def state_rate(self, slip: ca.SX, state: ca.SX) -> ca.SX | None:
        """(k,) rate of the state (k,); None for a law without state."""
        return None

    def force(self, normal: ca.SX, slip: ca.SX, state: ca.SX) -> ca.SX:
        """(k,) force at a normal force [N] and a slip (k,) [m/s], with its state if it has one."""
        raise NotImplementedError


@dataclass(eq=False)
class DryFriction(Friction):
    """Friction with a maximum at the onset of sliding.

    Parameters
    ----------
    dynamic : coefficient of sliding friction μ_d
    static : maximum coefficient μ_s; equal to ``dynamic`` by default
    """

    dynamic: Scalar = quantity("", "coefficient of sliding friction", minimum=0.0)
    static: Scalar = quantity("", "largest coefficient of friction", default=None, minimum=0.0)

    @property
    def excess(self) -> ca.SX:
        """``μ_s − μ_d``."""
        return ca.SX(0) if self.static is None else self.static.sx - self.dynamic.sx

    def conditions(self) -> list[Condition]:
        wrong = "static= is below dynamic=: {:.6g} and {:.6g}; increase or omit static="
        coefficients = ca.vertcat(self.dynamic.sx + self.excess, self.dynamic.sx)
        return [*super().conditions(), (self.excess, wrong, coefficients)]

    def sliding_coefficient(self) -> ca.SX:
        return self.dynamic.sx


@dataclass(eq=False)
class Coulomb(DryFriction):
    """Smooth dry friction (Brown and McPhee 2016); with ``x = |u|/v_t``,

        μ = μ_d tanh 4x + (μ_s − μ_d) x / (x²/4 + 3/4)².

    Instead of sticking it creeps at about ``v_t T/(4 μ_d N)``.

    Parameters
    ----------
    slip_speed : transition speed v_t [m/s]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("sliding box", gravity=(0, -10))
    >>> box = system.add(planar.Particle("box", mass=2.0, position=(0, -2e-4), velocity=(3, 0)))
    >>> floor, tip = contact.HalfPlane(system.ground.center), contact.Vertex(box.center)
    >>> law, rub = contact.KelvinVoigt(stiffness=1e5), contact.Coulomb(0.4)
    >>> touch = system.add(planar.Contact("touch", floor, tip, law=law, friction=rub))
    >>> motion = da.solve_dynamics(system.build(), 0.5, step=1e-3)
    >>> round(motion["box.vx"][-1].item(), 3)  # reduced by μ g t
    1.0
    """

    slip_speed: Scalar = quantity("m/s", "transition speed", default=1e-3, above=0.0)

    def coefficient(self, x: ca.SX) -> ca.SX:
        """``μ`` at a speed over the transition speed."""
        return self.dynamic.sx * ca.tanh(4 * x) + self.excess * x / (x**2 / 4 + 0.75) ** 2

    def force(self, normal: ca.SX, slip: ca.SX, state: ca.SX) -> ca.SX:
        direction = slip / self.slip_speed.sx
        x = ca.sqrt(ca.sumsqr(direction) + AT_REST**2)
        return -normal * self.coefficient(x) * direction / x


@dataclass(eq=False)
class Stribeck(Coulomb):
    """Friction that decreases with speed (Stribeck effect), with a viscous part,

        μ = (μ_d + (μ_s − μ_d) exp(−(u/v_s)²)) tanh 4x + η |u|,  x = |u|/v_t.

    Parameters
    ----------
    stribeck_speed : v_s, speed scale of the decrease [m/s]
    viscous : η [s/m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("oiled guide", gravity=(0, -10))
    >>> box = system.add(planar.Particle("box", mass=2.0, position=(0, -2e-4), velocity=(3, 0)))
    >>> floor, tip = contact.HalfPlane(system.ground.center), contact.Vertex(box.center)
    >>> law, rub = contact.KelvinVoigt(stiffness=1e5), contact.Stribeck(0.3, viscous=0.05)
    >>> touch = system.add(planar.Contact("touch", floor, tip, law=law, friction=rub))
    >>> motion = da.solve_dynamics(system.build(), 0.01, step=1e-3)
    >>> round(motion["box.ax"][0].item(), 6)  # -(μ_d + η u) g
    -4.5
    """

    stribeck_speed: Scalar = quantity("m/s", "Stribeck speed", default=1e-2, above=0.0)
    viscous: Scalar = quantity("s/m", "viscous part", default=0.0, minimum=0.0)

    def coefficient(self, x: ca.SX) -> ca.SX:
        speed = self.slip_speed.sx * x
        decay = ca.exp(-((speed / self.stribeck_speed.sx) ** 2))
        dry = (self.dynamic.sx + self.excess * decay) * ca.tanh(4 * x)
        return dry + self.viscous.sx * speed


@dataclass(eq=False)
class LuGre(DryFriction):
    """Bristle friction (Canudas de Wit, Olsson, Åström, Lischinsky 1995):

        T = −N (σ0 z + σ1 ż + σ2 u),  ż = u − σ0 |u|/g z,  g = μ_d + (μ_s − μ_d) exp(−(u/v_s)²).

    It sticks: bodies at rest stay at rest, on bristles of the stiffness ``σ0 N``. The state is
    ``σ0 z/μ_d``, which is 1 in steady sliding.

    Parameters
    ----------
    dynamic : above 0
    stiffness : σ0, stiffness of the bristles over the normal force [1/m]
    damping : σ1, damping of the bristles over the normal force [s/m]
    viscous : σ2 [s/m]
    stribeck_speed : v_s [m/s]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("box on a slope", gravity=(3, -10))
    >>> box = system.add(planar.Particle("box", mass=2.0, position=(0, -2e-4)))
    >>> floor, tip = contact.HalfPlane(system.ground.center), contact.Vertex(box.center)
    >>> law, rub = contact.KelvinVoigt(1e2, stiffness=1e5), contact.LuGre(0.5, damping=1e2)
    >>> touch = system.add(planar.Contact("touch", floor, tip, law=law, friction=rub))
    >>> motion = da.solve_dynamics(system.build(), 0.5, step=1e-3)
    >>> bool(0 < motion["box.x"][-1] < 1e-5)  # sticks; bristles deflect by micrometres
    True
    """

    dynamic: Scalar = quantity("", "coefficient of sliding friction", above=0.0)
    stiffness: Scalar = quantity("1/m", "stiffness σ0 of the bristles", default=1e5, above=0.0)
    damping: Scalar = quantity("s/m", "their damping σ1", default=0.0, minimum=0.0)
    viscous: Scalar = quantity("s/m", "viscous part σ2", default=0.0, minimum=0.0)
    stribeck_speed: Scalar = quantity("m/s", "Stribeck speed", default=1e-2, above=0.0)

    def state_rate(self, slip: ca.SX, state: ca.SX) -> ca.SX:
        small = AT_REST * self.stribeck_speed.sx
        size = ca.sqrt(ca.sumsqr(slip) + small**2)
        decay = ca.exp(-ca.sumsqr(slip) / self.stribeck_speed.sx**2)
        limit = 1 + self.excess / self.dynamic.sx * decay
        return self.stiffness.sx / self.dynamic.sx * (slip - (size - small) / limit * state)

    def force(self, normal: ca.SX, slip: ca.SX, state: ca.SX) -> ca.SX:
        spring = self.dynamic.sx * state
        rate = self.dynamic.sx / self.stiffness.sx * self.state_rate(slip, state)
        return -normal * (spring + self.damping.sx * rate + self.viscous.sx * slip)
