"""Contact points of boundaries as formulas of the positions."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.boundaries import Boundaries
from dalembert.analysis.nonsmooth.boundary_search import Touch
from dalembert.analysis.nonsmooth.hull_geometry import HullGeometry
from dalembert.analysis.nonsmooth.smooth_curve import SmoothCurve

ITERATIONS = 8
"""Newton iterations from the nearest sample; the last one has the exact derivatives."""
FLAT, FAR = 1e-12, 1e300
"""Lower limit of the derivatives that Newton's method divides by; squared distance of samples that
do not face each other [m²]."""

Point = tuple[ca.SX, ca.SX]
"""Position, and outward normal, inertial."""


class BoundaryFormulas:
    """Arguments of the gap function of a wall and a ball at a contact point.

    Parameters
    ----------
    geometry, boundaries : of one element
    """

    def __init__(self, geometry: HullGeometry, boundaries: Boundaries):
        self.geometry, self.boundaries = geometry, boundaries
        self.corners, self.walls, self.radii, self.origins, _, self._axes = geometry.symbols
        self.first_shape = len(geometry.shapes) - len(geometry.boundaries)
        self.p = geometry.p

    def columns(self, kind: Touch, first: int, second: int, own: int, other: int) -> list[ca.SX]:
        """Surface of the first shape, and ball or point of the second one."""
        radius = ca.SX(0)
        if kind in (Touch.CORNER, Touch.SIDE):
            center = self.corners[:2, int(self.geometry.starts[second]) + other]
            radius = self.radii[second]
            surface = self._surface(kind, first, own, center)
            place = center
        elif kind is Touch.ARCS:
            surface, place = self._tangency(first, second, own, other)
        else:
            surface = self._line(kind, first, own)
            place = self._lowest(second, other, surface[1])
        zero = ca.SX(0)
        return [
            ca.vertcat(surface[0], zero, surface[1], zero, zero, self.origins[:, first]),
            ca.vertcat(place, zero, radius, self.origins[:, second]),
        ]

    # frames --------------------------------------------------------------------------------------
    def _frame(self, shape: int) -> Point:
        """Origin and axes of the body of a boundary."""
        x = self._axes[:, shape - self.first_shape]
        return self.origins[:2, shape], ca.horzcat(x, ca.vertcat(-x[1], x[0]))

    def _curve(self, shape: int) -> SmoothCurve:
        return self.boundaries.curves[self.boundaries.curve_of[shape - self.first_shape]]

    def _at(self, curve: SmoothCurve, u: ca.SX) -> list[ca.SX]:
        """Position, first and second derivative."""
        return ca.vertsplit(curve.function(u, self.p), 2)

    def _on_curve(self, shape: int, u: ca.SX) -> Point:
        origin, axes = self._frame(shape)
        place, tangent, _ = self._at(self._curve(shape), u)
        return origin + ca.mtimes(axes, place), ca.mtimes(axes, _outward(tangent))

    # surfaces ------------------------------------------------------------------------------------
    def _surface(self, kind: Touch, shape: int, own: int, center: ca.SX) -> Point:
        """Point and normal of a boundary below the centre of a ball."""
        if kind is Touch.SIDE:
            return self._line(kind, shape, own)
        curve, (origin, axes) = self._curve(shape), self._frame(shape)
        local = ca.mtimes(axes.T, center - origin)
        samples = [self._at(curve, ca.SX(u)) for u in curve.samples_of(own)]
        distances = [ca.sumsqr(place - local) for place, *_ in samples]
        u = _smallest(distances, curve.samples_of(own))
        for _ in range(ITERATIONS):
            place, tangent, second = self._at(curve, u)
            away = place - local
            square = ca.sumsqr(tangent)
            u -= ca.dot(away, tangent) / ca.fmax(square + ca.dot(away, second), FLAT * square)
        return self._on_curve(shape, u)

    def _line(self, kind: Touch, shape: int, own: int) -> Point:
        """Point and normal of a straight line."""
        if kind is Touch.WALL:
            wall = self.walls[:, shape - len(self.geometry.hulls)]
            return wall[:2], wall[3:5]
        if kind is Touch.EDGE:
            first = int(self.geometry.starts[shape])
            count = len(self.geometry.hulls[shape].corners)
            ends = [self.corners[:2, first + k % count] for k in (own, own + 1)]
            normal = _outward(ends[1] - ends[0])
            return ends[0] + self.radii[shape] * normal, normal
        b = shape - self.first_shape
        start, count = self.boundaries.starts[b], self.boundaries.counts[b]
        origin, axes = self._frame(shape)
        local = [self.boundaries.vertices[int(start + k % count)] for k in (own, own + 1)]
        begin, end = (origin + ca.mtimes(axes, vertex) for vertex in local)
        return begin, _outward(end - begin)

    # points of curves ----------------------------------------------------------------------------
    def _lowest(self, shape: int, arc: int, normal: ca.SX) -> ca.SX:
        """Lowest point of a curve along a normal."""
        curve, (_, axes) = self._curve(shape), self._frame(shape)
        local = ca.mtimes(axes.T, normal)
        numbers = curve.samples_of(arc)
        u = _smallest([ca.dot(self._at(curve, ca.SX(v))[0], local) for v in numbers], numbers)
        for _ in range(ITERATIONS):
            _, tangent, second = self._at(curve, u)
            rate = ca.fmax(ca.dot(local, second), FLAT * ca.sumsqr(tangent))
            u -= ca.dot(local, tangent) / rate
        return self._on_curve(shape, u)[0]

    def _tangency(self, first: int, second: int, own: int, other: int) -> tuple[Point, ca.SX]:
        """Point and normal of the first curve, and the point of the second one."""
        u, w = self._nearest_samples((first, second), (own, other))
        for _ in range(ITERATIONS):
            (c, t, s), (d, q, r) = self._placed(first, u), self._placed(second, w)
            between = d - c
            parallel, along = _cross(t, q), ca.dot(between, t)
            a, b = _cross(s, q), _cross(t, r)
            e, f = ca.dot(between, s) - ca.sumsqr(t), ca.dot(t, q)
            divisor = a * f - b * e
            u += (b * along - f * parallel) / divisor
            w += (e * parallel - a * along) / divisor
        return self._on_curve(first, u), self._on_curve(second, w)[0]

    def _placed(self, shape: int, u: ca.SX) -> list[ca.SX]:
        """Inertial position, first and second derivative."""
        origin, axes = self._frame(shape)
        place, *slopes = self._at(self._curve(shape), u)
        return [origin + ca.mtimes(axes, place), *(ca.mtimes(axes, slope) for slope in slopes)]

    def _nearest_samples(
        self, shapes: tuple[int, int], arcs: tuple[int, int]
    ) -> tuple[ca.SX, ca.SX]:
        """Parameters of the nearest samples of two arcs that face each other."""
        samples, places, normals = [], [], []
        for shape, arc in zip(shapes, arcs, strict=True):
            samples.append(self._curve(shape).samples_of(arc))
            at = [self._placed(shape, ca.SX(v)) for v in samples[-1]]
            places.append(ca.horzcat(*(place for place, *_ in at)))
            normals.append(ca.horzcat(*(_outward(slope) for _, slope, _ in at)))
        count = samples[0].size
        nearest, partner = ca.SX(count, 1) + FAR, ca.SX(count, 1)
        for k, v in enumerate(samples[1]):
            away = places[0] - ca.repmat(places[1][:, k], 1, count)
            facing = ca.mtimes(normals[0].T, normals[1][:, k]) < 0
            squared = ca.if_else(facing, ca.sum1(away**2).T, FAR)
            partner = ca.if_else(squared < nearest, v, partner)
            nearest = ca.fmin(nearest, squared)
        number = _smallest(ca.vertsplit(nearest), np.arange(count))
        u, w = ca.SX(0), ca.SX(0)
        for k in range(count):
            u = ca.if_else(number == k, float(samples[0][k]), u)
            w = ca.if_else(number == k, partner[k], w)
        return u, w


def _smallest(values: list[ca.SX], numbers: np.ndarray) -> ca.SX:
    """The number with the smallest value."""
    smallest, number = values[0], ca.SX(float(numbers[0]))
    for value, following in zip(values[1:], numbers[1:], strict=True):
        number = ca.if_else(value < smallest, float(following), number)
        smallest = ca.fmin(smallest, value)
    return number


def _outward(tangent: ca.SX) -> ca.SX:
    return ca.vertcat(tangent[1], -tangent[0]) / ca.norm_2(tangent)


def _cross(a: ca.SX, b: ca.SX) -> ca.SX:
    return a[0] * b[1] - a[1] * b[0]
