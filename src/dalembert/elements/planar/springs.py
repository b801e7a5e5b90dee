"""Planar rotational springs and bushings."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import ForceElement, Look, Scalar, Vector, quantity
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Brake, Sleeve, Spiral
from dalembert.elements.pair import BetweenPoints
from dalembert.elements.planar.body import rotation
from dalembert.elements.planar.joint import BetweenAngles, InPlane
from dalembert.elements.springs import AngularSpring, ElasticBearing


@dataclass(eq=False)
class BodyPair(BetweenAngles, ForceElement):
    """Force element between the angles of two bodies; the coordinate is ``φ_j − φ_i``."""

    def parts(self) -> list[Coordinates]:
        return list(self.ends())

    def coordinate(self) -> ca.SX:
        return self.body_j.pose_angle - self.body_i.pose_angle


@dataclass(eq=False)
class TorsionSpring(AngularSpring, BodyPair):
    """Rotational spring and damper between two bodies; the coordinate is ``φ_j − φ_i``.

    Parameters
    ----------
    stiffness : [N m/rad]
    damping : [N m s/rad]
    free_angle : [rad]
    law : function (extension, rate) → additional moment [N m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("torsion pendulum")
    >>> wheel = system.add(planar.Body("wheel", mass=1.0, inertia=0.25))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, wheel.center))
    >>> wire = system.add(planar.TorsionSpring("wire", system.ground, wheel, stiffness=4.0))
    >>> modes = da.linearize(system.build())
    >>> modes.eigenvalues.imag.round(6)  # √(k/J)
    array([4.])
    """

    def look(self) -> list[Look]:
        return self.primitives(Spiral, Brake, self.body_i, self.body_j)


@dataclass(eq=False)
class Bushing(InPlane, ElasticBearing, BetweenPoints):
    """Elastic bearing: stiffness and damping along two axes of body i and about the pin.

    Parameters
    ----------
    stiffness : (2,) along the axes of body i [N/m]
    damping : (2,) [N s/m]
    rotational_stiffness, rotational_damping : [N m/rad], [N m s/rad]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("mount", gravity=(0, -9.81))
    >>> engine = system.add(planar.Body("engine", mass=80.0, inertia=3.0))
    >>> mount = system.add(planar.Bushing("mount", system.ground.center, engine.center,
    ...     stiffness=(1e6, 2e5), rotational_stiffness=1e3))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["engine.y"].item() * 1e3, 3)  # -m g/k [mm]
    -3.924
    """

    stiffness: Vector = quantity("N/m", "stiffness along the axes of body i", size=2)
    damping: Vector = quantity("N s/m", "damping", default=(0.0, 0.0), size=2)
    rotational_stiffness: Scalar = quantity("N m/rad", "rotational stiffness", default=0.0)
    rotational_damping: Scalar = quantity("N m s/rad", "rotational damping", default=0.0)

    def deformation(self) -> ca.SX:
        axes = rotation(self.point_i.body.pose_angle)
        rotated = self.point_j.body.pose_angle - self.point_i.body.pose_angle
        return ca.vertcat(ca.mtimes(axes.T, self.between), rotated)

    def look(self) -> list[Look]:
        return [Sleeve(self.point_i, self.point_j)]
