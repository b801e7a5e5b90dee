"""Gaps of pairs of features: walls, faces, edges and corners of rounded hulls, ends and rims of
cylinders."""

from __future__ import annotations

from enum import IntEnum
from functools import cache

import casadi as ca

from dalembert.analysis.nonsmooth.gaps.cylinders.rims import (
    Rim,
    contact_of_rims,
    contact_with_corner,
    contact_with_edge,
    contact_with_line,
    contact_with_plane,
)
from dalembert.analysis.nonsmooth.gaps.shape_velocities import TWIST
from dalembert.elements.contact.contact_point import (
    ContactPoint,
    contact_at_wall,
    contact_of_balls,
)

TRAILING = 4
"""Inputs after the points of a feature: radius and reference point of the body."""


class Feature(IntEnum):
    """Pair of features: that of the first body, and a corner or an edge of the second."""

    WALL = 0
    """Half-plane or half-space, and a corner."""
    FACE = 1
    """Face of a spatial hull or edge of a planar one, and a corner."""
    CORNERS = 2
    """Two corners; one of the hulls is rounded."""
    EDGES = 3
    """Two edges that cross."""
    EDGE = 4
    """Edge of a spatial hull and a corner; one of the hulls is rounded."""
    CAP = 5
    """End of a cylinder, and a corner."""
    WALL_RIM = 6
    """Half-space, and the rim of a cylinder."""
    FACE_RIM = 7
    """Face of a spatial hull, and a rim."""
    CAP_RIM = 8
    """End of a cylinder, and a rim."""
    RIM_CORNER = 9
    """Rim, and a corner."""
    RIM_EDGE = 10
    """Rim, and a sharp edge that crosses it."""
    RIM_LINE = 11
    """Rim, and the axis of a capsule or of another cylinder."""
    RIM_RIM = 12
    """Two rims that cross."""


WALLS = Feature.WALL, Feature.WALL_RIM
"""Features whose first shape is a wall."""
RIM_POINTS = 4
"""Number of points of a rim with a start for its angle."""


@cache
def point_counts(feature: Feature, dimension: int) -> tuple[int, int]:
    """Number of points that define both features.

    A wall has a point and a normal; an end of a cylinder the ends of its axis; a rim that needs a
    start for its angle these, a point on the rim and a direction.
    """
    faces = 2 if dimension == 2 else 3
    counts = {Feature.WALL: (2, 1), Feature.FACE: (faces, 1), Feature.CORNERS: (1, 1)}
    counts |= {Feature.EDGES: (2, 2), Feature.EDGE: (2, 1), Feature.CAP: (2, 1)}
    counts |= {Feature.WALL_RIM: (2, 2), Feature.FACE_RIM: (3, 2), Feature.CAP_RIM: (2, 2)}
    counts |= {Feature.RIM_CORNER: (2, 1), Feature.RIM_EDGE: (4, 2), Feature.RIM_LINE: (4, 2)}
    counts |= {Feature.RIM_RIM: (4, 4)}
    return counts[feature]


def contact_point(
    feature: Feature, first: list[ca.SX], radius_i: ca.SX, second: list[ca.SX], radius_j: ca.SX
) -> ContactPoint:
    """The contact point of two features, given by points, of hulls with radii."""
    if feature is Feature.WALL:
        return contact_at_wall(first[0], first[1], second[0], radius_j)
    if feature is Feature.FACE:
        normal = _face_normal(first)
        return contact_at_wall(first[0] + radius_i * normal, normal, second[0], radius_j)
    if feature is Feature.CORNERS:
        return contact_of_balls(first[0], radius_i, second[0], radius_j)
    if feature > Feature.EDGE:
        return _contact_of_cylinder(feature, first, radius_i, second, radius_j)
    if feature is Feature.EDGE:
        start, axis = first[0], first[1] - first[0]
        foot = start + ca.dot(second[0] - start, axis) / ca.sumsqr(axis) * axis
        return contact_of_balls(foot, radius_i, second[0], radius_j)
    return _contact_of_edges(first, radius_i, second, radius_j)


def _contact_of_cylinder(
    feature: Feature, first: list[ca.SX], radius_i: ca.SX, second: list[ca.SX], radius_j: ca.SX
) -> ContactPoint:
    """The contact point of an end or rim of a cylinder."""
    if feature is Feature.CAP:
        return contact_at_wall(first[0], Rim.of(first, radius_i).outward, second[0], radius_j)
    if feature is Feature.WALL_RIM:
        return contact_with_plane(first[0], first[1], Rim.of(second, radius_j))
    if feature is Feature.FACE_RIM:
        return contact_with_plane(first[0], _face_normal(first), Rim.of(second, radius_j))
    rim = Rim.of(first, radius_i)
    if feature is Feature.CAP_RIM:
        return contact_with_plane(first[0], rim.outward, Rim.of(second, radius_j))
    if feature is Feature.RIM_CORNER:
        return contact_with_corner(rim, second[0], radius_j)
    if feature is Feature.RIM_EDGE:
        return contact_with_edge(rim, second)
    if feature is Feature.RIM_LINE:
        return contact_with_line(rim, second, radius_j)
    return contact_of_rims(rim, Rim.of(second, radius_j))


def _face_normal(points: list[ca.SX]) -> ca.SX:
    edge = points[1] - points[0]
    if edge.numel() == 2:
        return ca.vertcat(edge[1], -edge[0]) / ca.norm_2(edge)
    normal = ca.cross(edge, points[2] - points[1])
    return normal / ca.norm_2(normal)


def _contact_of_edges(
    first: list[ca.SX], radius_i: ca.SX, second: list[ca.SX], radius_j: ca.SX
) -> ContactPoint:
    """Contact of two lines; the normal is along the cross product of their directions."""
    along_i, along_j, between = first[1] - first[0], second[1] - second[0], second[0] - first[0]
    across = ca.cross(along_i, along_j)
    normal = across / ca.norm_2(across)
    gap = ca.dot(normal, between) - radius_i - radius_j
    fraction = ca.dot(ca.cross(between, along_j), across) / ca.sumsqr(across)
    place = first[0] + fraction * along_i + normal * (radius_i + gap / 2)
    return ContactPoint(gap, normal, place)


@cache
def gap_function(feature: Feature, dimension: int, turns: bool = False) -> ca.Function:
    """``(features of both bodies) → g, ∂u/∂twists, place, directions``.

    A feature is the column of its points, the radius of its hull and the reference point of its
    body, whose velocity is in the twist. With ``turns``, ``u`` includes the relative rotation.
    """
    counts = point_counts(feature, dimension)
    columns = [ca.SX.sym(name, 3 * n + TRAILING) for name, n in zip("ij", counts, strict=True)]
    points = [
        [column[3 * k : 3 * k + dimension] for k in range(n)]
        for column, n in zip(columns, counts, strict=True)
    ]
    radii = [column[3 * n] for column, n in zip(columns, counts, strict=True)]
    point = contact_point(feature, points[0], radii[0], points[1], radii[1])
    twist, origins = ca.SX.sym("twist", 2 * TWIST), [column[-3:] for column in columns]
    speed = point.speeds(
        lambda place: twist[:3] + ca.cross(twist[3:6], place - origins[0]),
        lambda place: twist[6:9] + ca.cross(twist[9:], place - origins[1]),
    )
    if turns:
        speed = ca.vertcat(speed, point.turning(twist[3:6], twist[9:]))
    blocks = ca.jacobian(speed, twist)
    rest = ca.SX.zeros(3 - dimension)
    place = ca.vertcat(point.place, rest)
    directions = ca.vertcat(point.directions, ca.SX.zeros(3 - dimension, dimension))
    outputs = [ca.densify(out) for out in (point.distance, blocks, place, directions)]
    return ca.Function("gap", columns, outputs, {"cse": True})
