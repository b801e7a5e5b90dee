"""What solids look like: primitives on a body, with their sizes as formulas of parameters."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.base import Look
from dalembert.elements.body import BodyElement
from dalembert.elements.look import Segment
from dalembert.elements.point import Point


@dataclass(frozen=True, eq=False)
class Cuboid(Look):
    """A box about a point, along the axes of its body."""

    center: Point
    size: ca.SX


@dataclass(frozen=True, eq=False)
class Orb(Look):
    """A ball of its true size about a point."""

    center: Point
    radius: ca.SX


@dataclass(frozen=True, eq=False)
class Round(Segment):
    """Something round about the line between two points of one body."""

    radius: ca.SX


class Drum(Round):
    """With plane ends at the points."""


class Pill(Round):
    """With half a ball beyond either point."""


@dataclass(frozen=True, eq=False)
class Surface(Look):
    """A closed surface in the axes of a body.

    Parameters
    ----------
    corners : (n, 3), to be multiplied by the scale [m]
    triangles : (m, 3) numbers of corners, anticlockwise from outside
    """

    body: BodyElement
    corners: np.ndarray
    triangles: np.ndarray
    scale: ca.SX
