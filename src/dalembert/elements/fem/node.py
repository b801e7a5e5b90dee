"""Nodes of finite elements, which become bodies where joints and forces are attached."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from dalembert.elements.base import Element, Vector
from dalembert.elements.fem.nodal import Nodal
from dalembert.elements.planar import node as planar
from dalembert.elements.rotation import identity
from dalembert.elements.spatial import node as spatial
from dalembert.errors import ModelError, UnsupportedError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression


@dataclass(frozen=True)
class RigidMotion:
    """Initial velocities of nodes that move as a rigid body.

    Attributes
    ----------
    velocity : (d,) of the point at the origin [m/s]
    spin : angular velocity, one number in the plane, three in space [rad/s]
    """

    velocity: Expression
    spin: Expression

    @classmethod
    def of(cls, entity: str, dimension: int, velocity: Any, spin: Any) -> RigidMotion:
        """Motion from numbers or formulas; None is zero."""
        rotations = 3 if dimension == 3 else 1
        still = {1: 0.0, 2: (0.0, 0.0), 3: (0.0, 0.0, 0.0)}
        velocity = still[dimension] if velocity is None else velocity
        spin = still[rotations] if spin is None else spin
        return cls(
            as_expression(velocity, f"{entity}.velocity", "m/s", dimension),
            as_expression(spin, f"{entity}.angular_velocity", "rad/s", rotations),
        )

    def at(self, place: ca.SX) -> Expression:
        """(d,) velocity ``v + ω × r`` of a point."""
        velocity, spin = self.velocity.sx, self.spin.sx
        if place.numel() == 2:
            return Expression(velocity + spin * ca.vertcat(-place[1], place[0]))
        return Expression(velocity + ca.cross(spin, place))


def node_body(name: str, place: ca.SX, rotates: bool, motion: RigidMotion | None) -> Any:
    """A node as a body.

    Parameters
    ----------
    place : (d,) stress-free position
    rotates : whether it has a rotation

    Raises
    ------
    UnsupportedError
        One coordinate.
    """
    if place.numel() == 1:
        raise UnsupportedError(
            f"{name}: a node with one coordinate is no body of a mechanism; give it two or three"
        )
    in_plane = place.numel() == 2
    kinds = planar if in_plane else spatial
    initial: dict[str, Any] = {}
    if rotates:
        initial = {"angle": 0.0} if in_plane else {"rotation": identity()}
    if motion is not None:
        initial["velocity"] = motion.at(place)
        if rotates:
            initial["angular_velocity"] = motion.spin
    kind = kinds.ElementNode if rotates else kinds.ElementPointNode
    return kind(name, position=Expression(place), **initial)


@dataclass(eq=False)
class Node(Nodal, Element):
    """A node of finite elements.

    In a mechanism it is a body, to which joints and forces may be attached; it rotates if an
    element rotates it.

    Parameters
    ----------
    position : (d,) stress-free coordinates [m], numbers or formulas; all nodes of a system have
        the same number of coordinates

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> frame = da.Structure("portal")
    >>> height = frame.parameter("height", 3.0, unit="m")
    >>> corner = frame.node("corner", 0, height)  # a structures.Node
    >>> isinstance(corner, structures.Node), corner.name
    (True, 'corner')
    """

    position: Vector

    def __post_init__(self) -> None:
        super().__post_init__()
        coordinates = (
            self.position if isinstance(self.position, (tuple, list)) else (self.position,)
        )
        size = len(coordinates)
        if size not in (1, 2, 3):
            raise ModelError(f"needs 1, 2 or 3 coordinates, got {size}", self.name)
        value = coordinates if size > 1 else coordinates[0]
        self.position = as_expression(value, f"{self.name}.position", "m", size)
        self.rotates = False
        self.motion: RigidMotion | None = None

    @property
    def natural(self) -> ca.SX:  # type: ignore[override]
        return self.position.sx

    @property
    def dimension(self) -> int:  # type: ignore[override]
        """Number of coordinates."""
        return len(self.position)

    @cached_property
    def body(self) -> Any:  # type: ignore[override]
        """The node as a body."""
        return node_body(self.name, self.natural, self.rotates, self.motion)

    @property
    def bodies(self) -> list[Any]:
        """The node as a body, in a list."""
        return [self.body]

    def rotate(self, entity: str) -> None:
        """Give the node a rotation, for an element.

        Raises
        ------
        ModelError
            It is already the body of a joint or force, without rotation.
        """
        if not self.rotates and "body" in vars(self):
            raise ModelError(
                f"rotates its node {self.name}, which is already a point of a joint, force or "
                "formula; add the element before these",
                entity,
            )
        self.rotates = True
