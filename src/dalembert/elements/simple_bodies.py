"""Slender bars and point masses, common to planar and spatial mechanisms."""

from __future__ import annotations

import dataclasses
from typing import Any

import casadi as ca

from dalembert.elements.base import Look, Scalar
from dalembert.elements.body import BodyElement
from dalembert.elements.look import Ball, Segment
from dalembert.elements.point import Point
from dalembert.errors import ModelError


class SlenderBar(BodyElement):
    """Uniform bar along its x axis from ``start`` to ``end``; its centre is the origin."""

    length: Scalar
    start: Point
    end: Point

    def slender_inertia(self, mass: ca.SX) -> ca.SX:
        """``m l²/12``, the moment of inertia about a transverse axis [kg m²]."""
        return mass * self.length.sx**2 / 12

    def add_ends(self) -> None:
        half = self.length / 2  # one node, so that both ends share trigonometric functions
        transverse = (0.0,) * (self.dimension - 1)
        self.start = self.add_point("start", (-half, *transverse))
        self.end = self.add_point("end", (half, *transverse))

    def look(self) -> list[Look]:
        return [Segment(self.start, self.end)]


def unused() -> Any:
    """A field of bodies that particles do not have."""
    return dataclasses.field(init=False, default=None)


class PointMass(BodyElement):
    """A body without rotation, whose only point is its origin."""

    rotates = False

    def frame(self, *place: Any, **axes: Any) -> Any:
        """Refuse: a body without rotation has no axes.

        Raises
        ------
        ModelError
        """
        raise ModelError("a particle has no frame; use a Body", self.name)

    def look(self) -> list[Look]:
        return [Ball(self.center)]

    def point(self, x, y=None, z=None) -> Point:
        """The origin, the only point of a particle.

        Raises
        ------
        ModelError
            Any other point.
        """
        point = super().point(x, y, z)
        if not point.local.sx.is_zero():
            origin = ", ".join("0" * self.dimension)
            raise ModelError(f"a particle has no point but ({origin}); use a Body", self.name)
        return point
