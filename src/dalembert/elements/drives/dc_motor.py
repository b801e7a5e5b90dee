"""Direct-current motor with inductance and gear."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Constraint, Look, Powers, Rate, Scalar, option, quantity
from dalembert.elements.coordinates import Coordinates, rate_of
from dalembert.elements.joint_forces import AlongJoint
from dalembert.elements.look import Motor
from dalembert.elements.pair import Pair
from dalembert.elements.stateful import Stateful, signal
from dalembert.symbolic.formulas.expression import Expression, t


@dataclass(eq=False)
class DCMotor(Stateful, AlongJoint):
    """Direct-current motor with a gear along a free motion ``s`` of a joint.

        L i' = V − R i − K n ṡ,      Q = n (K i − b n ṡ) − J n² s̈

    with the current ``i``, the constant ``K`` of torque and voltage, the ratio ``n`` of the gear,
    and inertia ``J`` and damping ``b`` of the rotor (Franklin, Powell & Emami-Naeini, Feedback
    Control of Dynamic Systems, 2.3). The rotor turns about the axis of the joint relative to the
    first body; its gyroscopic effects are neglected.

    Parameters
    ----------
    joint : joint with a free motion
    voltage : ``V``, formula of t, parameters and measures; may be assigned later [V]
    constant : ``K`` [N m/A] or [V s/rad]
    resistance : ``R`` [Ω]
    inductance : ``L`` [H]
    ratio : ``n``, rotor angle per motion; for a sliding joint in [rad/m]
    inertia : ``J`` of the rotor [kg m²]
    damping : ``b`` of the rotor [N m s/rad]
    start : current at the start [A]
    motion : name of the free motion if the joint has several

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("fan")
    >>> rotor = system.add(planar.Body("rotor", mass=1.0, inertia=0.01))
    >>> hinge = system.add(planar.Revolute("hinge", system.ground.center, rotor.center))
    >>> numbers = dict(constant=0.1, resistance=1.0, inductance=1e-3)
    >>> motor = system.add(planar.DCMotor("motor", hinge, voltage=12.0, **numbers))
    >>> motion = da.solve_dynamics(system.build(), 20.0)
    >>> round(motion["rotor.angular_velocity"][-1].item(), 3)  # V/K without load
    120.0
    """

    fixed_states = ("current",)

    joint: Constraint  # type: ignore[misc]  # after a keyword of the base class
    voltage: Scalar = signal("V", "voltage, a formula of t, parameters and measures")
    constant: Scalar = quantity("N m/A", "constant of torque and voltage", default=0.0)
    resistance: Scalar = quantity("Ω", "resistance", default=1.0, above=0.0)
    inductance: Scalar = quantity("H", "inductance", default=1e-3, above=0.0)
    ratio: Scalar = quantity("rad/m | 1", "rotor angle per motion of the joint", default=1.0)
    inertia: Scalar = quantity("kg m^2", "moment of inertia of the rotor", default=0.0, minimum=0.0)
    damping: Scalar = quantity("N m s/rad", "viscous damping", default=0.0, minimum=0.0)
    start: Scalar = quantity("A", "current at the start", default=0.0)
    motion: str = option("name of the free motion, if the joint has several", default=None)

    not_drawn = "the motion it drives has no two points"

    def state_units(self) -> Sequence[str]:
        return ("A",)

    def initial_states(self) -> list[ca.SX]:
        return [self.start.sx]

    @property
    def current(self) -> Expression:
        """The current in formulas."""
        return self.state("current")

    def rates(self) -> ca.SX:
        speed = rate_of(self.free_coordinate, self.joint.parts(), t.sx)
        induced = self.constant.sx * self.ratio.sx * speed
        drop = self.resistance.sx * self.states.pose
        return (self.input_of("voltage") - drop - induced) / self.inductance.sx

    def effort(self, speed: ca.SX) -> ca.SX:
        ratio = self.ratio.sx
        return ratio * (self.constant.sx * self.states.pose - self.damping.sx * ratio * speed)

    @property
    def rotor(self) -> ca.SX:
        return self.inertia.sx * self.ratio.sx**2

    def potential(self) -> ca.SX:
        """Energy of the magnetic field."""
        return self.inductance.sx * self.states.pose**2 / 2

    def dissipation(self, rate: Rate) -> Powers:
        speed, current = rate(self.free_coordinate), self.states.pose
        rubbing = -self.damping.sx * self.ratio.sx**2 * speed
        return [(speed, rubbing), (current, -self.resistance.sx * current)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        own = {**super().measures(rate), **self.state_measures()}
        if self.connected:
            voltage = self.input_of("voltage")
            own |= {"voltage": (voltage, "V"), "power": (voltage * self.states.pose, "W")}
        return own

    def parts(self) -> list[Coordinates]:
        return [*super().parts(), self.states]

    def look(self) -> list[Look]:
        if self.free_unit == "rad" and isinstance(self.joint, Pair):
            return [Motor(*self.joint.ends())]
        return []
