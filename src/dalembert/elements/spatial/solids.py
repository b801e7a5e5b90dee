"""Graphical primitives of solids, with formulas of parameters as sizes."""

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
    """A closed surface in the axes of a body.

    Parameters
    ----------
    corners : (n, 3) in units of the scale
    triangles : (m, 3) indices of corners, anticlockwise from outside
    """

    body: BodyElement
    corners: np.ndarray
    triangles: np.ndarray
    scale: ca.SX
