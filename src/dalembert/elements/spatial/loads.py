"""Spatial applied loads."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Vector, option, quantity
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.loads import Couple, PointForce, distinct, in_inertial_axes
from dalembert.elements.pair import need_body
from dalembert.errors import ModelError


def refuse_without_axes(follows: BodyElement | None, owner: str) -> None:
    """Refuse components in the axes of a particle."""
    if follows is not None and not need_body(follows, owner, "follows").rotates:
        raise ModelError(f"follows {follows.name}, a particle, which has no axes", owner)


@dataclass(eq=False)
class Force(PointForce):
    """Force at a point of a body.

    Parameters
    ----------
    point : point of application
    vector : (3,) components [N]; formulas of t, parameters and measures are allowed
    follows : body in whose axes the components are; inertial axes by default

    Raises
    ------
    ModelError
        A point of the plane, axes of a particle.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("rocket")
    >>> rocket = system.add(spatial.Body("rocket", mass=2.0, inertia=(1, 1, 0.1)))
    >>> thrust = spatial.Force("thrust", rocket.point(0, 0, -1), (0, 0, 8 * da.t), follows=rocket)
    >>> engine = system.add(thrust)
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> round(motion["rocket.vz"][-1].item(), 6)  # F t/(2 m)
    2.0
    """

    vector: Vector = quantity("N", "components", size=3)
    follows: BodyElement = option("body whose axes the components are in", default=None)

    def __post_init__(self) -> None:
        super().__post_init__()
        refuse_without_axes(self.follows, self.name)
        if self.point.dimension < 3:
            name = self.point.body.name
            raise ModelError(
                f"acts in space, and the point of {name} lies in a plane; give three coordinates, "
                f"{name}.point(x, y, z)",
                self.name,
            )

    def axes(self) -> BodyElement | None:
        return self.follows


@dataclass(eq=False)
class Torque(Couple):
    """Moment on a body, with its reaction on an optional second one: a rotary actuator.

    Parameters
    ----------
    body : body it acts on
    vector : (3,) components [N m]; formulas of t, parameters and measures are allowed
    reaction_on : body that carries the reaction; the ground by default
    follows : body in whose axes the components are; inertial axes by default

    Raises
    ------
    ModelError
        One of the bodies is a particle.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("satellite")
    >>> satellite = system.add(spatial.Body("satellite", mass=10.0, inertia=(2, 3, 4)))
    >>> thrusters = system.add(spatial.Torque("thrusters", satellite, (0, 0, 1 - da.t)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.5)
    >>> motion["satellite.angular_velocity"][:, 2].values.round(6)  # (t - t²/2)/J
    array([0.     , 0.09375, 0.125  , 0.09375, 0.     ])
    """

    body: BodyElement
    vector: Vector = quantity("N m", "components", size=3)
    reaction_on: BodyElement = option("body that carries the reaction", default=None)
    follows: BodyElement = option("body whose axes the components are in", default=None)
    measured = "torque"

    def __post_init__(self) -> None:
        super().__post_init__()
        refuse_without_axes(self.follows, self.name)

    def components(self) -> ca.SX:
        return in_inertial_axes(self.vector.sx, self.follows)

    def parts(self) -> list[Coordinates]:
        return distinct([self.body, self.reaction_on, self.follows])
