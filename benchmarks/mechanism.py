"""Mechanisms in neutral words, so that every solver gets the same physics."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

GROUND = -1
Vector = Sequence[float]


@dataclass(frozen=True)
class Body:
    """A rigid body; everything in inertial axes at the start but the inertia.

    Attributes
    ----------
    inertia : (3,) principal moments about the mass centre, in body axes
    rotation : (3, 3) body axes
    """

    mass: float
    inertia: Vector
    position: Vector
    rotation: np.ndarray = field(default_factory=lambda: np.eye(3))
    velocity: Vector = (0.0, 0.0, 0.0)
    spin: Vector = (0.0, 0.0, 0.0)

    def local(self, place: Vector) -> np.ndarray:
        """A place of the start in body axes."""
        return self.rotation.T @ (np.asarray(place, float) - np.asarray(self.position, float))


@dataclass(frozen=True)
class Joint:
    """A joint of two bodies, by number.

    Attributes
    ----------
    kind : revolute, prismatic (both about or along z of the axes), spherical, or universal, whose
        cross has its arms along x in the first body and along y in the second one
    """

    kind: str
    first: int
    second: int
    place: Vector
    axes: np.ndarray = field(default_factory=lambda: np.eye(3))


@dataclass(frozen=True)
class Mechanism:
    """Bodies and joints, and a point whose motion is compared.

    Attributes
    ----------
    observed : number of a body, place of its point at the start
    planar : all bodies move in the plane x, y, and turn about z; all joints are pins
    redundant : there are dependent constraints
    """

    name: str
    gravity: Vector
    bodies: list[Body]
    joints: list[Joint]
    observed: tuple[int, Vector]
    planar: bool = False
    redundant: bool = False

    def body(self, number: int) -> Body:
        return Body(1.0, (1, 1, 1), (0, 0, 0)) if number == GROUND else self.bodies[number]

    @property
    def tree(self) -> bool:
        """Every body hangs on one hinge of an earlier one."""
        hinges = all(j.kind == "revolute" and j.first < j.second for j in self.joints)
        return hinges and len(self.joints) == len(self.bodies)


def along(axis: Vector) -> np.ndarray:
    """(3, 3) axes whose z is given."""
    z = np.asarray(axis, float) / np.linalg.norm(axis)
    x = np.cross(np.eye(3)[np.argmin(np.abs(z))], z)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])
