"""Where two shapes meet: the spots of one, and their distances from the other."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.contact.shapes import Shape, Spot
from dalembert.errors import ModelError


@dataclass(frozen=True, eq=False)
class Meeting:
    """A place where two bodies may touch.

    Attributes
    ----------
    distance : positive while apart [m]
    normal : unit vector from the first body to the second, inertial components
    place : halfway between the two surfaces
    """

    distance: ca.SX
    normal: ca.SX
    place: ca.SX

    def slip(self, body_i, body_j) -> ca.SX:
        """(1,) or (2,) velocity of the second body along the surface of the first."""
        n = self.normal.numel()
        here = ca.vertcat(self.place, ca.SX.zeros(3 - n))
        between = (body_j.velocity_at(here) - body_i.velocity_at(here))[:n]
        return ca.mtimes(tangents(self.normal).T, between)


def meetings(shape_i: Shape, shape_j: Shape, owner: str) -> list[Meeting]:
    """Every place where two shapes may touch.

    Raises
    ------
    ModelError
        Nothing is known of how these two touch.
    """
    found: list[Meeting] = []
    if isinstance(shape_j, shape_i.feels):
        found += [_meeting(shape_i, spot, 1) for spot in shape_j.spots()]
    if isinstance(shape_i, shape_j.feels) and (not found or shape_i.mutual):
        found += [_meeting(shape_j, spot, -1) for spot in shape_i.spots()]
    if not found:
        i, j = (type(shape).__name__ for shape in (shape_i, shape_j))
        known = ", ".join(known_pairs(shape_i.dimension))
        raise ModelError(f"no contact of {i} and {j} is known; there are {known}", owner)
    return found


def known_pairs(dimension: int) -> list[str]:
    """The pairs of shapes there are in the plane, or in space."""
    kinds = [kind for kind in _below(Shape) if kind.space in (0, dimension)]
    pressing = [kind for kind in kinds if kind.spots is not Shape.spots]
    pairs = {
        frozenset((felt, other)): f"{felt.__name__}–{other.__name__}"
        for felt in kinds
        for other in pressing
        if issubclass(other, felt.feels)
    }
    return list(pairs.values())


def _below(kind: type[Shape]) -> list[type[Shape]]:
    """The classes made of a class that no others are made of."""
    found = [last for made in kind.__subclasses__() for last in _below(made)]
    return list(dict.fromkeys(found)) or [kind]


def _meeting(felt: Shape, spot: Spot, sense: int) -> Meeting:
    """Of a spot with a shape, whose outward normal is the gradient of the distance from it."""
    place = spot.point.position.sx
    symbol = ca.SX.sym("place", place.numel())
    distance = felt.distance(symbol, sharp=spot.radius.is_zero())
    outward = ca.gradient(distance, symbol)
    distance, outward = ca.substitute([distance, outward], [symbol], [place])
    gap = distance - spot.radius
    return Meeting(gap, sense * outward, place - outward * (spot.radius + gap / 2))


def tangents(normal: ca.SX) -> ca.SX:
    """(n, n−1) directions along a surface; in space after Duff et al. (2017)."""
    if normal.numel() == 2:
        return ca.vertcat(normal[1], -normal[0])
    x, y, z = ca.vertsplit(normal)
    sign = ca.if_else(z < 0, -1, 1)
    a = -1 / (sign + z)
    first = ca.vertcat(1 + sign * x**2 * a, sign * x * y * a, -sign * x)
    return ca.horzcat(first, ca.vertcat(x * y * a, sign + y**2 * a, -y))
