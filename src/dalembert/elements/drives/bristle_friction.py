"""Friction in a joint by elastic bristles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Constraint, Powers, Rate, Scalar, option, quantity
from dalembert.elements.coordinates import Coordinates, rate_of
from dalembert.elements.joint_forces import AlongJoint
from dalembert.elements.stateful import Stateful
from dalembert.symbolic.formulas.expression import t

AT_REST = 1e-6
"""Speed over the transition speed below which its magnitude is regularised [-]."""


@dataclass(eq=False)
class BristleFriction(Stateful, AlongJoint):
    """LuGre friction along a free motion ``s`` of a joint.

        Q = −(σ0 z + σ1 ż + σ2 ṡ),   ż = ṡ − σ0 |ṡ|/g z,   g = Q_C + (Q_S − Q_C) exp(−(ṡ/v_S)²)

    (Canudas de Wit, Olsson, Åström & Lischinsky 1995). It sticks: at rest the bristles hold up to
    ``Q_S``. The state is ``deflection = σ0 z``, the force of the bristles.

    Parameters
    ----------
    joint : joint with a free motion
    coulomb : ``Q_C`` [N] or [N m]
    static : ``Q_S``; ``Q_C`` by default [N] or [N m]
    stiffness : ``σ0`` [N/m] or [N m/rad]
    damping : ``σ1`` of the bristles [N s/m] or [N m s/rad]
    viscous : ``σ2`` [N s/m] or [N m s/rad]
    stribeck_speed : ``v_S`` [m/s] or [rad/s]
    motion : name of the free motion if the joint has several

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("sledge")
    >>> sledge = system.add(planar.Body("sledge", mass=2.0, inertia=0.1))
    >>> rail = system.add(planar.Prismatic("rail", system.ground.center, sledge.center))
    >>> numbers = dict(coulomb=5.0, stiffness=1e5, damping=300.0)
    >>> rub = system.add(planar.BristleFriction("rub", rail, **numbers))
    >>> pull = system.add(planar.Force("pull", sledge.center, (4.0, 0)))
    >>> motion = da.solve_dynamics(system.build(), 1.0)
    >>> bool(abs(motion["sledge.vx"][-1].item()) < 1e-6)  # sticks
    True
    """

    fixed_states = ("deflection",)

    joint: Constraint  # type: ignore[misc]  # after a keyword of the base class
    coulomb: Scalar = quantity("N | N m", "sliding friction", default=1.0, above=0.0)
    static: Scalar = quantity("N | N m", "friction at rest", default=None, above=0.0)
    stiffness: Scalar = quantity("N/m | N m/rad", "of the bristles", default=1e5, above=0.0)
    damping: Scalar = quantity("N s/m | N m s/rad", "of the bristles", default=0.0, minimum=0.0)
    viscous: Scalar = quantity("N s/m | N m s/rad", "viscous friction", default=0.0, minimum=0.0)
    stribeck_speed: Scalar = quantity("m/s | rad/s", "Stribeck speed", default=1e-2, above=0.0)
    motion: str = option("name of the free motion, if the joint has several", default=None)

    not_drawn = "it acts in a joint, which is drawn"

    def state_units(self) -> Sequence[str]:
        return ("N m" if self.free_unit == "rad" else "N",)

    def rates(self) -> ca.SX:
        return self._rate(rate_of(self.free_coordinate, self.joint.parts(), t.sx))

    def _rate(self, speed: ca.SX) -> ca.SX:
        """Rate of the force of the bristles."""
        small = AT_REST * self.stribeck_speed.sx
        size = ca.sqrt(speed**2 + small**2) - small
        static = self.coulomb if self.static is None else self.static
        decay = ca.exp(-((speed / self.stribeck_speed.sx) ** 2))
        limit = self.coulomb.sx + (static.sx - self.coulomb.sx) * decay
        return self.stiffness.sx * (speed - size / limit * self.states.pose)

    def effort(self, speed: ca.SX) -> ca.SX:
        bending = self.damping.sx / self.stiffness.sx * self._rate(speed)
        return -(self.states.pose + bending + self.viscous.sx * speed)

    def dissipation(self, rate: Rate) -> Powers:
        """All of its power, as in other friction; bristles store little energy."""
        return self.powers(rate)

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        return {**super().measures(rate), **self.state_measures()}

    def parts(self) -> list[Coordinates]:
        return [*super().parts(), self.states]
