"""Graphical primitives of solids."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.base import Look
from dalembert.elements.body import BodyElement
from dalembert.elements.frame import Frame
from dalembert.elements.look import Segment
from dalembert.elements.point import Point


@dataclass(frozen=True, eq=False)
class Cuboid(Look):
    """A box about a point, along the axes of its body."""

    center: Point
    size: ca.SX


@dataclass(frozen=True, eq=False)
class Orb(Look):
    """A ball of true size about a point."""

    center: Point
    radius: ca.SX


@dataclass(frozen=True, eq=False)
class Round(Segment):
    """A solid of revolution about the line between two points of one body."""

    radius: ca.SX


class Drum(Round):
    """A cylinder."""


class Pill(Round):
    """A cylinder with hemispherical ends beyond the points."""


@dataclass(frozen=True, eq=False)
class Surface(Look):
    """A surface in the axes of a body.

    Parameters
    ----------
    corners : (n, 3) in units of the scale
    triangles : (m, 3) indices of corners, anticlockwise from outside
    """

    body: BodyElement
    corners: np.ndarray
    triangles: np.ndarray
    scale: ca.SX


@dataclass(frozen=True, eq=False)
class Sheet(Look):
    """A surface visible from one side, in the axes of a body.

    Parameters
    ----------
    vertices : (3, n) formulas of parameters
    triangles : (m, 3) indices of vertices, anticlockwise from the visible side
    """

    body: BodyElement
    vertices: ca.SX
    triangles: np.ndarray


@dataclass(frozen=True, eq=False)
class Floor(Look):
    """Material below the x-y plane of a frame; its size follows from the travels over it.

    Parameters
    ----------
    travels : (2, m) coordinates along x and y that it contains
    """

    frame: Frame
    travels: ca.SX
