"""Spatial drivers of free motions of joints and of points."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Constraint, Look, Vector, option, quantity
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.driver import AlongDirection, Driver
from dalembert.elements.laws.base import GivenLaw
from dalembert.elements.look import Motor, Travel
from dalembert.elements.pair import Pair
from dalembert.elements.point import Point
from dalembert.elements.spatial.frame_pair import Turn
from dalembert.elements.spatial.joint import SpatialJoint, slide_of, turn_of
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import t


class JointDriver(Driver, Pair):
    """Prescribed free motion of a joint between frames."""

    joint: SpatialJoint
    motion: str | None
    relative = True

    def __post_init__(self) -> None:
        if not isinstance(self.joint, Constraint):
            raise ModelError(
                "joint must be a joint, such as a spatial.Revolute between two frames, in "
                f"{type(self).__name__}(name, joint, law); got {type(self.joint).__name__}",
                self.name,
            )
        super().__post_init__()

    def ends(self):
        return self.joint.ends()

    def parts(self) -> list[Coordinates]:
        return self.joint.parts()

    def place(self) -> ca.SX:
        return self.joint.place()


@dataclass(eq=False)
class RotationalDriver(JointDriver):
    """Prescribed rotation of a joint, ``Φ = angle − f(t)``, for any number of revolutions.

    The angle is measured relative to the law, ``Φ = atan2(s cos f − c sin f, c cos f + s sin f)``
    with its cosine c and sine s, so that the measure ``coordinate`` is continuous over revolutions.

    Parameters
    ----------
    joint : joint between frames with a free rotation
    law : Law, number or formula in t [rad]
    motion : name of the rotation if the joint has several (``angle_i`` or ``angle_j``)

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("rotor")
    >>> rotor = system.add(spatial.Body("rotor", mass=1.0, inertia=(0.1, 0.1, 0.2)))
    >>> axle = system.add(spatial.Revolute("axle", system.ground.frame(), rotor.frame()))
    >>> motor = system.add(spatial.RotationalDriver("motor", axle, 5 * da.t**2))
    >>> motion = da.solve_inverse_dynamics(system.build(), 1.0, step=0.5)
    >>> motion["motor.effort"].values.round(6)  # J α
    array([2., 2., 2.])
    """

    joint: SpatialJoint
    law: GivenLaw = option("motion law")
    motion: str = option("name of the free motion, if the joint has several", default=None)
    prescribes = "rad"

    def coordinate(self) -> ca.SX:
        return self.law.value(t.sx) + self.deviation()

    def deviation(self) -> ca.SX:
        """Rotation relative to the law, less than half a turn."""
        prescribed = Turn.of(self.law.value(t.sx))
        return turn_of(self.joint, self.motion, self.name).relative_to(prescribed).angle

    def units(self) -> list[str]:
        return ["rad"]

    def look(self) -> list[Look]:
        return [Motor(*self.ends())]


@dataclass(eq=False)
class TranslationalDriver(JointDriver):
    """Prescribed displacement of a joint, ``Φ = displacement − f(t)``.

    Parameters
    ----------
    joint : joint between frames with a free displacement
    law : Law, number or formula in t [m]
    motion : name of the displacement if the joint has several (``displacement_x`` …)

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("press", gravity=(0, 0, -10))
    >>> ram = system.add(spatial.Body("ram", mass=200.0, inertia=(1, 1, 1)))
    >>> guide = system.add(spatial.Prismatic("guide", system.ground.frame(), ram.frame()))
    >>> crank = system.add(spatial.TranslationalDriver("crank", guide, da.Harmonic(0.05, 10.0)))
    >>> motion = da.solve_inverse_dynamics(system.build(), "pi/20", step="pi/20")
    >>> motion["crank.effort"].values.round(6)  # m g; at the top m (g - 0.05 ω²)
    array([2000., 1000.])
    """

    joint: SpatialJoint
    law: GivenLaw = option("motion law")
    motion: str = option("name of the free motion, if the joint has several", default=None)

    @property
    def axis(self) -> int:
        """Index of the axis of the first frame."""
        return slide_of(self.joint, self.motion, self.name)

    def coordinate(self) -> ca.SX:
        axis = self.axis  # raises first if the joint has no such motion
        return self.joint.travel[axis]

    def look(self) -> list[Look]:
        frame = self.joint.frame_i
        return [Travel(self.joint.end, frame.body, frame.local_axes[:, self.axis])]


@dataclass(eq=False)
class CoordinateDriver(AlongDirection):
    """Prescribed coordinate of a point, ``Φ = uᵀ r_P − f(t)``.

    Parameters
    ----------
    point : point of a body
    law : Law, number or formula in t [m]
    direction : (3,) direction in inertial axes

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("table")
    >>> table = system.add(spatial.Body("table"))
    >>> rail = system.add(spatial.Prismatic("rail", system.ground.frame(), table.frame()))
    >>> lift = spatial.CoordinateDriver("lift", table.center, 0.1 * da.t**2, direction=(0, 0, 1))
    >>> driver = system.add(lift)
    >>> motion = da.solve_kinematics(system.build(), 1.0, step=0.5)
    >>> motion["table.vz"].values.round(6)  # 0.2 t
    array([0. , 0.1, 0.2])
    """

    point: Point
    law: GivenLaw = option("motion law")
    direction: Vector = quantity("", "direction in inertial axes", default=(1.0, 0.0, 0.0), size=3)
