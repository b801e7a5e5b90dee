"""Homogeneous bodies: box, cylinder, sphere, capsule, bar."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look, Scalar, Vector, quantity
from dalembert.elements.point import Point
from dalembert.elements.simple_bodies import SlenderBar
from dalembert.elements.spatial.look import Cuboid, Drum, Orb, Pill
from dalembert.elements.spatial.shape import Shape, moments
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression


@dataclass(eq=False)
class Box(Shape):
    """Box centred at the origin of its body frame.

    Parameters
    ----------
    size : (3,) lengths along x, y and z [m]

    Examples
    --------
    >>> from dalembert import spatial
    >>> brick = spatial.Box("brick", size=(0.2, 0.1, 0.05), density=2000.0)
    >>> corner = brick.point(0.1, 0.05, 0.025)  # relative to the centre
    >>> round(float(brick.mass), 9)
    2.0
    """

    size: Vector = quantity("m", "lengths along x, y, z", size=3, above=0.0, keyword=True)

    def volume(self) -> ca.SX:
        x, y, z = ca.vertsplit(self.size.sx)
        return x * y * z

    def gyration(self) -> ca.SX:
        x, y, z = ca.vertsplit(self.size.sx**2 / 12)
        return moments(y + z, x + z, x + y)

    def look(self) -> list[Look]:
        return [Cuboid(self.center, self.size.sx)]


@dataclass(eq=False)
class Cylinder(Shape):
    """Solid cylinder or tube about the z axis of its body frame; the origin is its centre.

    Parameters
    ----------
    radius, length : [m]
    inner_radius : of a tube [m]

    Examples
    --------
    >>> import math
    >>> from dalembert import spatial
    >>> tube = spatial.Cylinder("tube", radius=0.05, inner_radius=0.03, length=0.4, density=7850.0)
    >>> round(float(tube.mass) / (7850 * 0.4), 9) == round(math.pi * (0.05**2 - 0.03**2), 9)
    True
    """

    radius: Scalar = quantity("m", "radius", above=0.0, keyword=True)
    length: Scalar = quantity("m", "length along z", above=0.0, keyword=True)
    inner_radius: Scalar = quantity("m", "inner radius of a tube", default=0.0, minimum=0.0)

    def volume(self) -> ca.SX:
        return math.pi * (self.radius.sx**2 - self.inner_radius.sx**2) * self.length.sx

    def gyration(self) -> ca.SX:
        axial = (self.radius.sx**2 + self.inner_radius.sx**2) / 2
        transverse = axial / 2 + self.length.sx**2 / 12
        return moments(transverse, transverse, axial)

    def differences(self) -> dict[str, Expression]:
        return {"radius − inner_radius": self.radius - self.inner_radius}

    def look(self) -> list[Look]:
        return [Drum(*ends_of(self), self.radius.sx)]


@dataclass(eq=False)
class Sphere(Shape):
    """Ball centred at the origin of its body frame.

    Parameters
    ----------
    radius : [m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("ball")
    >>> ball = system.add(spatial.Sphere("ball", radius=0.1, mass=5.0, angular_velocity=(0, 0, 10)))
    >>> motion = da.solve_dynamics(system.build(), 0.1, step=0.1)
    >>> round(motion["ball.kinetic_energy"][0].item(), 6)  # J ω²/2 with J = 2 m r²/5
    1.0
    """

    radius: Scalar = quantity("m", "radius", above=0.0, keyword=True)

    def volume(self) -> ca.SX:
        return 4 / 3 * math.pi * self.radius.sx**3

    def gyration(self) -> ca.SX:
        moment = 2 / 5 * self.radius.sx**2
        return moments(moment, moment, moment)

    def look(self) -> list[Look]:
        return [Orb(self.center, self.radius.sx)]


@dataclass(eq=False)
class Capsule(Shape):
    """Cylinder about the z axis with hemispherical ends; the origin is its centre.

    Parameters
    ----------
    radius : of the cylinder and the hemispheres [m]
    length : of the cylinder, between the centres of the hemispheres [m]

    Examples
    --------
    >>> import math
    >>> from dalembert import spatial
    >>> pill = spatial.Capsule("pill", radius=0.1, length=0.3, density=1000.0)
    >>> volume = math.pi * 0.1**2 * (0.3 + 4 / 3 * 0.1)
    >>> round(float(pill.mass) / volume, 6)  # a cylinder and a ball
    1000.0
    """

    radius: Scalar = quantity("m", "radius", above=0.0, keyword=True)
    length: Scalar = quantity("m", "length between its ends' centres", above=0.0, keyword=True)

    def _volumes(self) -> tuple[ca.SX, ca.SX]:
        """Volumes of the cylinder and of the two ends together."""
        disc = math.pi * self.radius.sx**2
        return disc * self.length.sx, 4 / 3 * disc * self.radius.sx

    def volume(self) -> ca.SX:
        cylinder, ends = self._volumes()
        return cylinder + ends

    def gyration(self) -> ca.SX:
        r, l, (cylinder, ends) = self.radius.sx, self.length.sx, self._volumes()
        axial = cylinder * r**2 / 2 + ends * 2 / 5 * r**2
        transverse = cylinder * (r**2 / 4 + l**2 / 12)
        transverse += ends * (2 / 5 * r**2 + l**2 / 4 + 3 / 8 * l * r)
        return moments(transverse, transverse, axial) / (cylinder + ends)

    def look(self) -> list[Look]:
        return [Pill(*ends_of(self), self.radius.sx)]


def ends_of(body: Cylinder | Capsule) -> tuple[Point, Point]:
    """End points of its length on the z axis."""
    half = body.length / 2
    return Point(body, (0.0, 0.0, -half)), Point(body, (0.0, 0.0, half))


@dataclass(eq=False)
class Bar(SlenderBar, Shape):
    """Uniform round bar along its x axis from ``start`` to ``end``; the origin is its mass centre.

    Without a radius it is slender, with the transverse moments ``m l²/12`` and none about its axis:
    then joints must prevent the rotation about the axis.

    Parameters
    ----------
    length : [m]
    radius : [m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("pendulum", gravity=(0, 0, -9.81))
    >>> rod = system.add(spatial.Bar("rod", length=1.5, mass=2.0))
    >>> pin = system.ground.frame(axis=(0, 1, 0)), rod.frame((-0.75, 0, 0), axis=(0, 1, 0))
    >>> hinge = system.add(spatial.Revolute("O", *pin))
    >>> motion = da.solve_dynamics(system.build(), 0.01, step=0.01)  # released horizontally
    >>> round(motion["rod.az"][0].item(), 6)  # its centre: -3/4 g
    -7.3575
    """

    length: Scalar = quantity("m", "length along x", above=0.0, keyword=True)
    radius: Scalar = quantity("m", "radius; 0 if slender", default=0.0, minimum=0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.density is not None and self.radius.sx.is_zero():
            raise ModelError("density= needs a radius; or give mass=", self.name)
        self.add_ends()

    def volume(self) -> ca.SX:
        return math.pi * self.radius.sx**2 * self.length.sx

    def gyration(self) -> ca.SX:
        axial = self.radius.sx**2 / 2
        transverse = axial / 2 + self.slender_inertia(ca.SX(1))
        return moments(axial, transverse, transverse)

    def look(self) -> list[Look]:
        if self.radius.sx.is_zero():
            return super().look()
        return [Drum(self.start, self.end, self.radius.sx)]
