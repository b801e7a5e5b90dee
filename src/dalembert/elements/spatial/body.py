"""Spatial rigid bodies.

A body's coordinates are the position of its mass centre and its Euler parameters,
``y = (r_C, e)``; its speeds are ``v = (ṙ_C, ω')`` with the angular velocity in body axes (Ch. 2).
A point fixed in the body is at ``r_P = r_C + R(e) (s' − c')``. By Newton and Euler

    m r̈_C = f,      J' ω̇' + ω' × J' ω' = m'.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.base import Condition, Look, Scalar, Vector, option, quantity
from dalembert.elements.frame import Frames
from dalembert.elements.rotation import Orientation, as_orientation
from dalembert.elements.simple_bodies import PointMass, unused
from dalembert.elements.spatial.frame import SpatialFrame
from dalembert.elements.spatial.geometry import Geometry
from dalembert.elements.spatial.inertia_tensor import as_moments, physical, tensor
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression


@dataclass(eq=False)
class Body(SpatialFrame):
    """Spatial rigid body.

    Poses and speeds are guesses that assembly corrects; after construction the attributes
    ``position``, ``rotation``, ``angular_velocity`` … are the body's measures.

    Parameters
    ----------
    mass : [kg]
    inertia : about the mass centre in body axes [kg m²]: ``(Ixx, Iyy, Izz)``, these followed by
        ``Ixy, Iyz, Ixz``, entries of the matrix (Ixy = −∫xy dm), or the matrix itself
    center_of_mass : (3,) in the body frame [m]
    position : (3,) initial position of the origin of the body frame [m]
    rotation : initial orientation: from ``da.rotation``, a matrix, or SciPy's ``Rotation``
    velocity : (3,) initial velocity of the origin, inertial axes [m/s]
    angular_velocity : (3,) initial, inertial axes [rad/s]
    points : name → (3,) coordinates in the body frame [m]
    frames : name → keywords of ``frame``: place, axis, x, axes, rotation
    geometry : solids that pictures show, by default the ellipsoid of the inertia

    Raises
    ------
    ModelError
        A mass without inertia, an impossible inertia, an invalid name or number.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("plate", gravity=(0, 0, -9.81))
    >>> quarter = da.rotation.axis_angle((0, 0, 1), math.pi / 2)
    >>> plate = system.add(spatial.Body("plate", mass=2.0, inertia=(0.01, 0.02, 0.03),
    ...     rotation=quarter, velocity=(1, 0, 0), points={"corner": (0.3, 0, 0)}))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> motion["plate.corner.position"][-1].values.round(6)  # v t, rotated 0.3, -g t²/2
    array([ 1.   ,  0.3  , -4.905])
    """

    mass: Scalar = quantity("kg", "mass", default=None, minimum=0.0)
    inertia: Vector = quantity(
        "kg m^2",
        "about the mass centre: Ixx, Iyy, Izz, Ixy, Iyz, Ixz",
        default=None,
        size=6,
        minimum_size=3,
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
    geometry: Sequence[Geometry] = option("solids that pictures show", default=())

    not_drawn = "a plate over its points is drawn, or the ellipsoid of its inertia"

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
        points, frames = self.named("points"), self.named("frames")
        self.initial = (self.position, self.rotation, self.velocity, self.angular_velocity)
        self.mass = self.mass if self.mass is not None else Expression(0)
        self.inertia = self.inertia if self.inertia is not None else Expression(ca.SX.zeros(6))
        if self.center_of_mass is None:
            self.center_of_mass = Expression(ca.SX.zeros(3))
        self._make_coordinates()
        self.mass_center = self.origin
        self.declare(self.motion_measures(), points)
        for name, keys in frames.items():
            self.add_frame(name, **keys)

    # mechanics --------------------------------------------------------------------------------
    @property
    def offset(self) -> ca.SX:
        return self.center_of_mass.sx

    def inertia_by_speeds(self) -> tuple[ca.SX, ca.SX]:
        mass = self.mass.sx * ca.SX.eye(3)
        if not self.rotates:
            return mass, ca.SX(3, 1)
        inertia = tensor(self.inertia.sx)
        gyroscopic = ca.cross(self.spin, ca.mtimes(inertia, self.spin))
        return ca.diagcat(mass, inertia), ca.vertcat(ca.SX(3, 1), gyroscopic)

    def look(self) -> list[Look]:
        return [look for solid in self.geometry or () for look in solid.look(self)]

    def conditions(self) -> list[Condition]:
        return [*super().conditions(), *physical(self.inertia.sx)]


@dataclass(eq=False)
class Particle(PointMass, Body):
    """Spatial point mass: three coordinates, no rotation.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("throw", gravity=(0, 0, -9.81))
    >>> stone = system.add(spatial.Particle("stone", mass=0.2, velocity=(3, 4, 9.81)))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> motion["stone.position"][-1].values.round(6)  # v t + g t²/2
    array([3.   , 4.   , 4.905])
    """

    inertia: Any = unused()
    center_of_mass: Any = unused()
    rotation: Any = unused()
    angular_velocity: Any = unused()
    frames: Any = unused()
    geometry: Any = unused()
