"""Graphical primitives of elements.

``look()`` of an element returns primitives attached to its points and bodies. They state kind and
position, in the dimension of the points; the page decides how a primitive is drawn. Sizes are
formulas of parameters, loads and travels also of the motion; directions are in the axes of a body.
``look()`` of a structure returns one primitive for many alike elements, attached to its nodes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.base import Look
from dalembert.elements.body import BodyElement
from dalembert.elements.point import Point


# joints --------------------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Mark(Look):
    """Symbol at a joint; the base class is a generic one.

    Parameters
    ----------
    point : its position
    base : the point of the other body, or that body
    """

    point: Point
    base: Point | BodyElement


class Pin(Mark):
    """Rotates about an axis."""


class Socket(Mark):
    """Rotates about a point."""


class SlotPin(Mark):
    """A pin that slides."""


class Collar(SlotPin):
    """A sleeve on a shaft, rotates about it and slides along it."""


class Nut(SlotPin):
    """A nut on a spindle, slides as it rotates."""


class Cross(Pin):
    """Two perpendicular axes of rotation."""


class Table(Mark):
    """Slides and rotates on a plane."""


class Slider(Mark):
    """Slides without rotation."""


class Clamp(Mark):
    """Rigidly attached."""


@dataclass(frozen=True, eq=False)
class Mesh(Mark):
    """Two gears in mesh: ``point`` and ``base`` are the centres of their pitch circles."""

    radius: ca.SX
    base_radius: ca.SX
    internal: bool


@dataclass(frozen=True, eq=False)
class Contact(Look):
    """Contact point of two bodies; inertial axes."""

    place: ca.SX


# parts of a body ---------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Segment(Look):
    """A straight bar between two points of one body."""

    point_i: Point
    point_j: Point


@dataclass(frozen=True, eq=False)
class Ball(Look):
    """A small body at a point."""

    point: Point


@dataclass(frozen=True, eq=False)
class Disc(Look):
    """A wheel about a point."""

    point: Point
    radius: ca.SX


@dataclass(frozen=True, eq=False)
class Block(Look):
    """A slider about a point, along a direction in the axes of its body."""

    point: Point
    direction: ca.SX


@dataclass(frozen=True, eq=False)
class Rail(Look):
    """A straight line through a point of a body; its length follows from the travel along it."""

    point: Point
    direction: ca.SX
    travel: ca.SX


@dataclass(frozen=True, eq=False)
class Path(Look):
    """A curve on a body: ``position`` of the parameter, over its interval."""

    body: BodyElement
    position: Callable[[ca.SX], ca.SX]
    interval: tuple[float, float]
    closed: bool


# between two points ------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Link(Look):
    """A primitive between two points of variable distance."""

    point_i: Point
    point_j: Point


class Rod(Link):
    """A massless rigid link."""


class Strand(Link):
    """A segment of a flexible body between two nodes."""


class Coil(Link):
    """A spring."""


class Dashpot(Link):
    """A damper."""


class Cylinder(Link):
    """An actuator along the line of its ends."""


class Sleeve(Link):
    """An elastic bearing."""


class Tie(Link):
    """Two motions coupled by a fixed ratio."""


# about the axis of two bodies ---------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Rotary(Look):
    """A primitive about the axis of relative rotation of two bodies; None is the ground."""

    body_i: BodyElement | None
    body_j: BodyElement


class Spiral(Rotary):
    """A rotational spring."""


class Brake(Rotary):
    """A rotational damper."""


class Motor(Rotary):
    """Drives the rotation of the second body."""


@dataclass(frozen=True, eq=False)
class Belt(Rotary):
    """Couples the rotations of two wheels on a carrier; ``ratio`` is that of the radii i to j."""

    body_i: BodyElement
    ratio: ca.SX
    carrier: BodyElement | None


# motions and loads -------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Travel(Look):
    """Motion of a point along a direction in the axes of a body; None is the ground."""

    point: Point
    body: BodyElement | None
    direction: ca.SX


@dataclass(frozen=True, eq=False)
class Limit(Look):
    """Upper (``above``) or lower limit of a coordinate; ``slip`` is the velocity along it."""

    coordinate: ca.SX
    value: ca.SX
    above: bool
    slip: ca.SX | None = None


@dataclass(frozen=True, eq=False)
class Arrow(Look):
    """A force at a point, in inertial axes."""

    point: Point
    force: ca.SX


@dataclass(frozen=True, eq=False)
class Twist(Look):
    """A moment on a body; in space a vector in inertial axes."""

    body: BodyElement
    moment: ca.SX


# structures --------------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Cells(Look):
    """Alike finite elements, which move with their nodes and have the colours of a field.

    Parameters
    ----------
    vertices : (m, k) numbers of the nodes
    elements : (m,) numbers of the elements
    """

    vertices: np.ndarray
    elements: np.ndarray


class Bars(Cells):
    """Straight lines between two nodes."""


class Beams(Cells):
    """Lines between two nodes, bent by the rotations of their ends."""


class Coils(Cells):
    """Springs between two nodes."""


class Faces(Cells):
    """Outlines of flat cells."""


class SolidFaces(Cells):
    """Outlines of the faces of solid cells; those between two cells are hidden."""


class Dots(Cells):
    """Elements at one node."""


@dataclass(frozen=True)
class Diagram:
    """A measure along a line between two nodes, drawn across it.

    Parameters
    ----------
    start, end : measures at its ends
    sign : of the measure at the start; an end moment is opposite to the bending moment there
    across : axis of the element, y (1) or z (2), with the sign of its direction
    """

    start: str
    end: str
    sign: float = 1.0
    across: int = 1


@dataclass(frozen=True, eq=False)
class Support(Look):
    """A node with a prescribed displacement or rotation in a direction, such as ``"ux"``."""

    node: int
    direction: str
