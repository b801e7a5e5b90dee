"""What elements look like: the primitives that pictures of mechanisms are made of.

An element answers ``look()`` with some of them, tied to the points and bodies it ties. They say
what is there and where, in as many dimensions as the points have, and nothing of pixels: how a pin
is drawn is known to the page alone. Sizes are formulas of parameters, loads and travels of the
motion too; directions are in the axes of a body.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Look
from dalembert.elements.body import BodyElement
from dalembert.elements.point import Point


# where two bodies meet ---------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Mark(Look):
    """A sign at a point, where a joint holds it on another body; as such, one of no special kind.

    Parameters
    ----------
    point : where it is
    base : the point of the other body, or that body
    """

    point: Point
    base: Point | BodyElement


class Pin(Mark):
    """Turns about an axis."""


class Socket(Mark):
    """Turns about a point."""


class SlotPin(Mark):
    """A pin that slides."""


class Collar(SlotPin):
    """A sleeve on a shaft, turns about it and slides along it."""


class Nut(SlotPin):
    """A sleeve on a spindle, slides as it turns."""


class Cross(Pin):
    """Two arms, each an axis to turn about."""


class Table(Mark):
    """Slides and turns on a plane."""


class Slider(Mark):
    """Slides without turning."""


class Clamp(Mark):
    """Held fast."""


@dataclass(frozen=True, eq=False)
class Mesh(Mark):
    """Two gears in mesh: ``point`` and ``base`` are the centres of their pitch circles."""

    radius: ca.SX
    base_radius: ca.SX
    internal: bool


@dataclass(frozen=True, eq=False)
class Contact(Look):
    """Two bodies touch at a place that wanders over both; inertial axes."""

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
    """A straight line through a point of a body, as long as the travel along it asks for."""

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
    """Something between two points, which may come closer or part."""

    point_i: Point
    point_j: Point


class Rod(Link):
    """Rigid, without mass."""


class Strand(Link):
    """A piece of something that bends, between two of its nodes."""


class Coil(Link):
    """A spring."""


class Dashpot(Link):
    """A damper."""


class Cylinder(Link):
    """Pushes its ends apart."""


class Sleeve(Link):
    """An elastic bearing."""


class Tie(Link):
    """Two motions that go together in a fixed ratio, by whatever means."""


# about the axis of two bodies ---------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Rotary(Look):
    """Something about the axis on which two bodies turn against each other; None is the ground."""

    body_i: BodyElement | None
    body_j: BodyElement


class Spiral(Rotary):
    """A rotational spring."""


class Brake(Rotary):
    """A rotational damper."""


class Motor(Rotary):
    """Turns the second body."""


@dataclass(frozen=True, eq=False)
class Belt(Rotary):
    """Couples the rotations of two wheels on a carrier, by radii in the ratio i to j."""

    ratio: ca.SX
    carrier: BodyElement | None


# motions and loads -------------------------------------------------------------------------
@dataclass(frozen=True, eq=False)
class Travel(Look):
    """A point is moved along a direction in the axes of a body; None is the ground."""

    point: Point
    body: BodyElement | None
    direction: ca.SX


@dataclass(frozen=True, eq=False)
class Limit(Look):
    """A coordinate of the bodies that goes no further than a value, from below or from above."""

    coordinate: ca.SX
    value: ca.SX
    above: bool


@dataclass(frozen=True, eq=False)
class Arrow(Look):
    """A force on a point, in inertial axes."""

    point: Point
    force: ca.SX


@dataclass(frozen=True, eq=False)
class Twist(Look):
    """A moment on a body, about its axis; in space a vector in inertial axes."""

    body: BodyElement
    moment: ca.SX
