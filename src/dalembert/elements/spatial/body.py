"""Rigid bodies in space.

A body's coordinates are the position of its mass centre and its Euler parameters,
``y = (r_C, e)``; its speeds are ``v = (ṙ_C, ω')`` with the angular velocity in body axes (Ch. 2).
A point fixed in the body is at ``r_P = r_C + R(e) (s' − c')``. By Newton and Euler

    m r̈_C = f,      J' ω̇' + ω' × J' ω' = m'.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Scalar, Vector, option, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates, rate_of, second_rate_of
from dalembert.elements.frame import Frames
from dalembert.elements.point import components
from dalembert.elements.point_mass import PointMass
from dalembert.elements.rotation import Orientation, as_orientation
from dalembert.elements.spatial.attitude import Attitude
from dalembert.elements.spatial.inertia_tensor import as_moments, physical, tensor
from dalembert.errors import ModelError
from dalembert.symbolic import rotation
from dalembert.symbolic.expression import Expression, t


@dataclass(eq=False)
class Body(BodyElement):
    """Rigid body in space.

    Poses and speeds are guesses that assembly corrects; after construction the attributes
    ``position``, ``rotation``, ``angular_velocity`` … are the body's measures.

    Parameters
    ----------
    mass : [kg]
    inertia : about the mass centre in body axes [kg m²]: ``(Ixx, Iyy, Izz)``, or these with
        ``Ixy, Iyz, Ixz`` behind, entries of the matrix (Ixy = −∫xy dm), or the matrix itself
    center_of_mass : (3,) in the body frame [m]
    position : (3,) initial position of the origin of the body frame [m]
    rotation : initial orientation: made by ``da.rotation``, a matrix, or SciPy's ``Rotation``
    velocity : (3,) initial velocity of the origin, inertial axes [m/s]
    angular_velocity : (3,) initial, inertial axes [rad/s]
    points : name → (3,) coordinates in the body frame [m]
    frames : name → keywords of ``frame``: place, axis, x, axes, rotation

    Raises
    ------
    ModelError
        A mass without inertia, an inertia that no body has, a bad name or number.
    """

    mass: Scalar = quantity("kg", "mass", default=None, minimum=0.0)
    inertia: Vector = quantity(
        "kg m^2",
        "about the mass centre: Ixx, Iyy, Izz, Ixy, Iyz, Ixz",
        default=None,
        size=6,
        least=3,
    )
    center_of_mass: Vector = quantity("m", "mass centre in the body frame", default=None, size=3)
    position: Vector = quantity("m", "initial position of the origin", default=None, size=3)
    rotation: Orientation = option("initial orientation", default=None)
    velocity: Vector = quantity("m/s", "initial velocity of the origin", default=None, size=3)
    angular_velocity: Vector = quantity(
        "rad/s", "initial angular velocity, inertial axes", default=None, size=3
    )
    points: dict[str, Vector] = None  # type: ignore[assignment]
    frames: Frames = None  # type: ignore[assignment]

    dimension = 3
    initial_fields = ("position", "rotation", "velocity", "angular_velocity")

    def __post_init__(self) -> None:
        if self.inertia is not None:
            self.inertia = as_moments(self.inertia, f"{self.name}.inertia")
        if self.rotation is not None:
            self.rotation = as_orientation(self.rotation, f"{self.name}.rotation")
        super().__post_init__()
        if self.rotates and self.mass is not None and self.inertia is None:
            raise ModelError(
                "mass is given but inertia is missing; give inertia=(Ixx, Iyy, Izz) about the mass "
                "centre, or use a Particle",
                self.name,
            )
        points, frames = dict(self.points or {}), dict(self.frames or {})
        self.initial = (self.position, self.rotation, self.velocity, self.angular_velocity)
        self.mass = self.mass if self.mass is not None else Expression(0)
        self.inertia = self.inertia if self.inertia is not None else Expression(ca.SX.zeros(6))
        if self.center_of_mass is None:
            self.center_of_mass = Expression(ca.SX.zeros(3))
        self._make_coordinates()
        self._declare(points)
        for name, keys in frames.items():
            self.add_frame(name, **keys)

    def _make_coordinates(self) -> None:
        place, turn = Coordinates(), Attitude(self.name) if self.rotates else Coordinates()
        place.name = turn.name = self.name
        place.make_symbols(("x", "y", "z"), ("m",) * 3)
        if not self.rotates:
            turn.make_symbols((), ())
        self.coordinate_names = place.coordinate_names + turn.coordinate_names
        self.coordinate_units = place.coordinate_units + turn.coordinate_units
        self.speed_names = place.speed_names + turn.speed_names
        self.speed_units = place.speed_units + turn.speed_units
        self.rest = place.rest + turn.rest
        self.pose, self.twist, self.acceleration_symbols, self.pose_rate = (
            ca.vertcat(*both)
            for both in (
                (place.pose, turn.pose),
                (place.twist, turn.twist),
                (place.acceleration_symbols, turn.acceleration_symbols),
                (place.pose_rate, turn.pose_rate),
            )
        )
        self._turn, self.mass_center, self.e, self.spin = turn, place.pose, turn.pose, turn.twist
        self.axes = rotation.matrix(self.e) if self.rotates else ca.SX.eye(3)

    def _declare(self, points: Mapping[str, Vector]) -> None:
        place = self.locate(ca.SX.zeros(3))
        velocity = rate_of(place, [self], t.sx)
        acceleration = second_rate_of(place, [self], t.sx)
        named = {
            "position": (place, "m"),
            "velocity": (velocity, "m/s"),
            "acceleration": (acceleration, "m/s^2"),
            **components("", place, "m"),
            **components("v", velocity, "m/s"),
            **components("a", acceleration, "m/s^2"),
        }
        if self.rotates:
            accelerated = self.acceleration_symbols[3:]
            named |= {
                "euler_parameters": (self.e, "1"),
                "rotation": (ca.vec(self.axes.T), "1"),
                "bryant": (rotation.angles(self.axes, "xyz"), "rad"),
                "angular_velocity": (self.turning, "rad/s"),
                "angular_velocity_local": (self.spin, "rad/s"),
                "angular_acceleration": (ca.mtimes(self.axes, accelerated), "rad/s^2"),
            }
        self.declare(named, points)

    def euler(self, sequence: str) -> Expression:
        """(3,) angles of turns about body axes that lead to its orientation, such as ``"zxz"``.

        The second is in [−π/2, π/2], of ``zxz`` and its like in [0, π]. At the ends of that range,
        the singular attitude, the first and the third are not determined and change fast nearby.

        Raises
        ------
        ModelError
            Other than three axes, or one twice in a row.
        """
        return Expression(rotation.angles(self.axes, sequence), f"{self.name}.{sequence}", "rad")

    # a manifold -------------------------------------------------------------------------------
    @property
    def flat(self) -> bool:
        return not self.rotates

    def retract(self, pose: ca.SX, displacement: ca.SX) -> ca.SX:
        turned = self._turn.retract(pose[3:], displacement[3:])
        return ca.vertcat(pose[:3] + displacement[:3], turned)

    def displacement(self, pose: ca.SX, other: ca.SX) -> ca.SX:
        return ca.vertcat(other[:3] - pose[:3], self._turn.displacement(pose[3:], other[3:]))

    def bounds(self, pose: ca.SX) -> ca.SX:
        return self._turn.bounds(pose[3:])

    @contextmanager
    def enriched(self) -> Iterator[tuple[ca.SX, ca.SX]]:
        """By the axes, whose rates ``Ṙ = R ω̃'`` need no Euler parameters."""
        if not self.rotates:
            with super().enriched() as nothing:
                yield nothing
            return
        pose, rate, axes = self.pose, self.pose_rate, self.axes
        symbols = ca.SX.sym(f"{self.name}.R", 3, 3)
        turning = ca.mtimes(symbols, rotation.skew(self.spin))
        self.axes, self.followers = symbols, (ca.vec(symbols), ca.vec(axes))
        self.pose, self.pose_rate = (
            ca.vertcat(pose, ca.vec(symbols)),
            ca.vertcat(rate, ca.vec(turning)),
        )
        try:
            yield self.followers
        finally:
            self.pose, self.pose_rate, self.axes = pose, rate, axes
            del self.followers

    # mechanics --------------------------------------------------------------------------------
    def locate(self, local: ca.SX) -> ca.SX:
        return self.mass_center + self.turned(local - self.center_of_mass.sx)

    def turned(self, local: ca.SX) -> ca.SX:
        return ca.mtimes(self.axes, local)

    @property
    def orientation(self) -> ca.SX:
        return self.e if self.rotates else ca.SX(list(rotation.IDENTITY))

    @property
    def turning(self) -> ca.SX:
        return self.turned(self.spin) if self.rotates else ca.SX.zeros(3)

    def velocity_at(self, place: ca.SX) -> ca.SX:
        return self.twist[:3] + ca.cross(self.turning, place - self.mass_center)

    def wrench(self, effort: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
        moment = self.turned(effort[3:]) if self.rotates else ca.SX.zeros(3)
        return effort[:3], moment, self.mass_center

    def inertia_by_speeds(self) -> tuple[ca.SX, ca.SX]:
        mass = self.mass.sx * ca.SX.eye(3)
        if not self.rotates:
            return mass, ca.SX(3, 1)
        inertia = tensor(self.inertia.sx)
        gyroscopic = ca.cross(self.spin, ca.mtimes(inertia, self.spin))
        return ca.diagcat(mass, inertia), ca.vertcat(ca.SX(3, 1), gyroscopic)

    # the start --------------------------------------------------------------------------------
    def guesses(self) -> tuple[list, list]:
        position, orientation, velocity, angular_velocity = self.initial
        first = ca.SX(list(rotation.IDENTITY)) if orientation is None else orientation.sx
        arm = ca.mtimes(rotation.matrix(first), self.center_of_mass.sx)
        spin = ca.SX.zeros(3) if angular_velocity is None else angular_velocity.sx
        swing = ca.cross(spin, self.turned(self.center_of_mass.sx))
        pose = [None] * 3 if position is None else ca.vertsplit(position.sx + arm)
        twist = [None] * 3 if velocity is None else ca.vertsplit(velocity.sx + swing)
        if self.rotates:
            pose = [*pose, *([None] * 4 if orientation is None else ca.vertsplit(first))]
            local = ca.mtimes(self.axes.T, spin)
            twist = [*twist, *([None] * 3 if angular_velocity is None else ca.vertsplit(local))]
        return pose, twist

    def guessed(self) -> list[bool]:
        position, orientation, *_ = self.initial
        turns = [orientation is not None] * 3 if self.rotates else []
        return [position is not None] * 3 + turns

    def doubts(self) -> list[Condition]:
        return [] if self.initial[1] is None else self.initial[1].doubts

    def conditions(self) -> list[Condition]:
        turned = [] if self.initial[1] is None else self.initial[1].conditions()
        return [*super().conditions(), *physical(self.inertia.sx), *turned]


@dataclass(eq=False)
class Particle(PointMass, Body):
    """Point mass in space: three coordinates, no rotation."""

    needless = ("inertia", "rotation", "angular_velocity", "center_of_mass", "frames")
