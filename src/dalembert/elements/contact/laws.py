"""Normal force laws: force as a function of the penetration and its rate.

A law states the force ``N(δ, δ̇) ≥ 0`` at a penetration ``δ > 0``, and the energy ``V(δ)`` stored in
its elastic part.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, power_unit, quantity
from dalembert.elements.component import Component
from dalembert.elements.contact.unilateral import at_most_one
from dalembert.errors import ModelError


@dataclass(eq=False)
class NormalLaw(Component):
    """Normal force law; its methods are evaluated at positive penetrations only."""

    def elastic(self, depth: ca.SX) -> ca.SX:
        """Elastic force, a function of the penetration only [N]."""
        raise NotImplementedError

    def stored(self, depth: ca.SX) -> ca.SX:
        """Energy of the elastic force [J]."""
        raise NotImplementedError

    def depth_storing(self, energy: float) -> ca.SX:
        """Penetration at a stored energy [m]."""
        raise NotImplementedError

    def force(self, depth: ca.SX, speed: ca.SX) -> ca.SX:
        """Force at a penetration and its rate; the elastic force by default [N]."""
        return self.elastic(depth)


@dataclass(eq=False)
class PowerLaw(NormalLaw):
    """``N = K δⁿ (1 + c δ̇) ≥ 0`` with the damping factor of a subclass.

    Parameters
    ----------
    stiffness : K [N/mⁿ]; the unit of a text or a parameter is checked where n is a number
    exponent : n; 1.5 for round bodies (Hertz), 1 for flat ones
    """

    stiffness: Scalar = quantity("N/m^n", "stiffness K", above=0.0, keyword=True)
    exponent: Scalar = quantity("", "exponent n of the depth", default=1.5, minimum=1.0)

    def _unit(self, field: str, unit: str | None) -> str | None:
        if field != "stiffness" or unit is None:
            return super()._unit(field, unit)
        return power_unit(unit, self.exponent, f"{type(self).__name__}.exponent")

    def elastic(self, depth: ca.SX) -> ca.SX:
        return self.stiffness.sx * depth**self.exponent.sx

    def stored(self, depth: ca.SX) -> ca.SX:
        power = self.exponent.sx + 1
        return self.stiffness.sx * depth**power / power

    def depth_storing(self, energy: float) -> ca.SX:
        power = self.exponent.sx + 1
        return (power * energy / self.stiffness.sx) ** (1 / power)

    def damping_factor(self) -> ca.SX:
        """``c`` [s/m]."""
        raise NotImplementedError

    def force(self, depth: ca.SX, speed: ca.SX) -> ca.SX:
        return self.elastic(depth) * ca.fmax(0, 1 + self.damping_factor() * speed)


@dataclass(eq=False)
class Hertz(PowerLaw):
    """Elastic contact, ``N = K δⁿ`` (Hertz 1882).

    For balls ``K = 4/3 E √R`` with ``1/R = 1/R_i + 1/R_j``,
    ``1/E = (1 − ν_i²)/E_i + (1 − ν_j²)/E_j``.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("ball on a table", gravity=(0, -10))
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, -1e-4)))
    >>> table, tip = contact.HalfPlane(system.ground.center), contact.Vertex(ball.center)
    >>> law = contact.Hertz(stiffness=1e7)
    >>> touch = system.add(planar.Contact("touch", table, tip, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["touch.penetration"].item() * 1e6, 3)  # (m g/K)^(2/3) [µm]
    100.0
    """

    def damping_factor(self) -> ca.SX:
        return ca.SX(0)


@dataclass(eq=False)
class RestitutionLaw(PowerLaw):
    """``N = K δⁿ (1 + d δ̇/v₀)`` with a published factor ``d(e)``.

    ``d`` holds for impacts at the speed ``v₀``; impacts at other speeds have another restitution.

    Parameters
    ----------
    restitution : e, as defined by the source
    impact_speed : v₀, speed of approach [m/s]
    """

    restitution: Scalar = quantity("", "coefficient of restitution e", default=None, minimum=0.0)
    impact_speed: Scalar = quantity("m/s", "speed of approach v₀", default=None, above=0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        self._complete()

    def _complete(self) -> None:
        """Check that the parameters determine the damping."""
        if self.restitution is None or self.impact_speed is None:
            raise ModelError(
                "give restitution= and impact_speed=, the speed of approach for which it holds",
                type(self).__name__,
            )

    def conditions(self):
        if self.restitution is None:
            return super().conditions()
        return [*super().conditions(), at_most_one(self.restitution.sx, "restitution")]

    def factor(self) -> ca.SX:
        """``d(e)``."""
        raise NotImplementedError

    def damping_factor(self) -> ca.SX:
        return self.factor() / self.impact_speed.sx


@dataclass(eq=False)
class HuntCrossley(RestitutionLaw):
    """``d = 1.5 (1 − e)`` (Hunt and Crossley 1975), or a damping ``c = d/v₀``.

    Parameters
    ----------
    damping : c, instead of ``restitution`` and ``impact_speed`` [s/m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("drop")
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 1e-3), velocity=(0, -2)))
    >>> floor, tip = contact.HalfPlane(system.ground.center), contact.Vertex(ball.center)
    >>> damping = contact.damping_factor(0.5) / 2.0
    >>> law = contact.HuntCrossley(stiffness=1e8, damping=damping)
    >>> touch = system.add(planar.Contact("touch", floor, tip, law=law))
    >>> motion = da.solve_dynamics(system.build(), 0.01, integrator=da.DormandPrince(1e-9, 1e-9))
    >>> round(motion["ball.vy"][-1].item(), 4)  # half the speed of approach
    1.0
    """

    damping: Scalar = quantity("s/m", "damping c", default=None, minimum=0.0)

    def _complete(self) -> None:
        if self.damping is None:
            return super()._complete()
        if self.restitution is not None or self.impact_speed is not None:
            raise ModelError(
                "give damping=, or restitution= and impact_speed=, not both", type(self).__name__
            )
        return None

    def factor(self) -> ca.SX:
        return 1.5 * (1 - self.restitution.sx)

    def damping_factor(self) -> ca.SX:
        return super().damping_factor() if self.damping is None else self.damping.sx


@dataclass(eq=False)
class LankaraniNikravesh(RestitutionLaw):
    """``d = ¾ (1 − e²)`` (Lankarani and Nikravesh 1990), for restitutions near one.

    Examples
    --------
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> law = contact.LankaraniNikravesh(stiffness=1e8, restitution=0.9, impact_speed=2.0)
    >>> [round(contact.achieved_restitution(3 / 4 * (1 - e**2)), 2) for e in (0.95, 0.9, 0.5)]
    [0.95, 0.91, 0.73]
    """

    def factor(self) -> ca.SX:
        return 0.75 * (1 - self.restitution.sx**2)


@dataclass(eq=False)
class Flores(RestitutionLaw):
    """``d = 8/5 (1 − e)/e`` (Flores, Machado, Silva and Martins 2011), for all restitutions.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("soft floor")
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 1e-3), velocity=(0, -2)))
    >>> floor, tip = contact.HalfPlane(system.ground.center), contact.Vertex(ball.center)
    >>> law = contact.Flores(stiffness=1e8, restitution=0.4, impact_speed=2.0)
    >>> touch = system.add(planar.Contact("touch", floor, tip, law=law))
    >>> motion = da.solve_dynamics(system.build(), 0.01, integrator=da.DormandPrince(1e-9, 1e-9))
    >>> round(motion["ball.vy"][-1].item() / 2, 3)
    0.363
    >>> round(contact.achieved_restitution(8 / 5 * (1 - 0.4) / 0.4), 3)
    0.363
    """

    def factor(self) -> ca.SX:
        return 1.6 * (1 - self.restitution.sx) / self.restitution.sx

    def conditions(self):
        e = self.restitution.sx
        wrong = "restitution is {:.3g}; it must be above zero in this law"
        return [*super().conditions(), (e - 1e-12, wrong, e)]


@dataclass(eq=False)
class KelvinVoigt(NormalLaw):
    """``N = k δ + c δ̇ ≥ 0``; at first contact the force jumps to ``c δ̇``.

    Parameters
    ----------
    stiffness : k [N/m]
    damping : c [N s/m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("crate", gravity=(0, -10))
    >>> crate = system.add(planar.Particle("crate", mass=40.0, position=(0, -1e-3)))
    >>> floor, tip = contact.HalfPlane(system.ground.center), contact.Vertex(crate.center)
    >>> law = contact.KelvinVoigt(stiffness=2e5, damping=100.0)
    >>> touch = system.add(planar.Contact("touch", floor, tip, law=law))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["touch.penetration"].item() * 1e3, 6)  # m g/k [mm]
    2.0
    """

    stiffness: Scalar = quantity("N/m", "stiffness k", above=0.0, keyword=True)
    damping: Scalar = quantity("N s/m", "damping c", default=0.0, minimum=0.0)

    def elastic(self, depth: ca.SX) -> ca.SX:
        return self.stiffness.sx * depth

    def stored(self, depth: ca.SX) -> ca.SX:
        return self.stiffness.sx * depth**2 / 2

    def depth_storing(self, energy: float) -> ca.SX:
        return ca.sqrt(2 * energy / self.stiffness.sx)

    def force(self, depth: ca.SX, speed: ca.SX) -> ca.SX:
        return ca.fmax(0, self.elastic(depth) + self.damping.sx * speed)


@dataclass(eq=False)
class Restitution(Component):
    """Rigid contact with instantaneous impacts, ``ġ⁺ = −e ġ⁻`` (Newton), without a force law.

    Parameters
    ----------
    e : coefficient of restitution along the gap
    tangential : coefficient of restitution of the slip

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> contact = planar.contact
    >>> system = da.System("bounce", gravity=(0, -10))
    >>> ball = system.add(planar.Body("ball", mass=1.0, inertia=0.004, position=(0, 0.3)))
    >>> floor, rim = contact.HalfPlane(system.ground.center), contact.Circle(ball.center, 0.1)
    >>> law = contact.Restitution(0.5)
    >>> touch = system.add(planar.Contact("touch", floor, rim, law=law))
    >>> motion = da.solve_dynamics(system.build(), 0.3, step=0.01)
    >>> round(motion["ball.y"][-1].item(), 6)  # rises at half of 2 m/s for 0.1 s
    0.15
    """

    e: Scalar = quantity("", "coefficient of restitution", default=0.0, minimum=0.0)
    tangential: Scalar = quantity("", "of the slip", default=0.0, minimum=0.0)

    def conditions(self):
        coefficients = {"e": self.e.sx, "tangential": self.tangential.sx}
        conditions = [at_most_one(coefficient, name) for name, coefficient in coefficients.items()]
        return [*super().conditions(), *conditions]
