"""Contact points of boundaries as formulas of the positions of their parts."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.boundaries.boundary_search import Touch
from dalembert.analysis.nonsmooth.gaps.boundaries.smooth_curve import SmoothCurve
from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature, gap_function

ITERATIONS = 8
"""Newton iterations from the nearest sample; the last one has the exact derivatives."""
FLAT, FAR = 1e-12, 1e300
"""Lower limit of the derivatives that Newton's method divides by; squared distance of samples that
do not face each other [m²]."""
FRAME = 5
"""Numbers of the frame of a boundary: origin and first axis of its body."""
SIZES = {Touch.SIDE: FRAME + 4, Touch.WALL: 9, Touch.EDGE: 10, Touch.ARC: FRAME + 4}
"""Numbers of a straight line after which the kinds are named: of a side its frame and two vertices
on the body, of a wall its point, normal and origin, of an edge its corners, radius and origin."""
BALL = 7
"""Numbers of a corner of a hull: its position, radius and origin."""

Point = tuple[ca.SX, ca.SX]
"""Position, and outward normal, inertial."""


class Arc:
    """Arc of a smooth curve on a body.

    Parameters
    ----------
    curve : SmoothCurve
    number : of the arc

    Attributes
    ----------
    symbols : SX column: origin and first axis of the body, and the parameters of the curve
    samples : parameters of its samples
    """

    def __init__(self, curve: SmoothCurve, number: int):
        self.curve, self.samples = curve, curve.samples_of(number)
        self.symbols = ca.SX.sym("arc", FRAME + curve.parameters.size)
        self.origin, self.axes = _frame(self.symbols)
        self._p = ca.SX.zeros(curve.function.numel_in(1))
        for k, parameter in enumerate(curve.parameters):
            self._p[int(parameter)] = self.symbols[FRAME + k]

    def local(self, u: ca.SX | float) -> list[ca.SX]:
        """Position, first and second derivative on the body."""
        return ca.vertsplit(self.curve.function(u, self._p), 2)

    def placed(self, u: ca.SX | float) -> list[ca.SX]:
        """Inertial position, first and second derivative."""
        place, *slopes = self.local(u)
        return [
            self.origin + ca.mtimes(self.axes, place),
            *(ca.mtimes(self.axes, slope) for slope in slopes),
        ]

    def point(self, u: ca.SX) -> Point:
        """Inertial position and normal."""
        place, tangent, _ = self.placed(u)
        return place, _outward(tangent)

    def below(self, center: ca.SX) -> Point:
        """The point nearest to the centre of a ball."""
        local = ca.mtimes(self.axes.T, center - self.origin)
        distances = [ca.sumsqr(self.local(float(v))[0] - local) for v in self.samples]
        u = _smallest(distances, self.samples)
        for _ in range(ITERATIONS):
            place, tangent, second = self.local(u)
            away, square = place - local, ca.sumsqr(tangent)
            u -= ca.dot(away, tangent) / ca.fmax(square + ca.dot(away, second), FLAT * square)
        return self.point(u)

    def lowest(self, normal: ca.SX) -> ca.SX:
        """The lowest point along a normal."""
        local = ca.mtimes(self.axes.T, normal)
        heights = [ca.dot(self.local(float(v))[0], local) for v in self.samples]
        u = _smallest(heights, self.samples)
        for _ in range(ITERATIONS):
            _, tangent, second = self.local(u)
            rate = ca.fmax(ca.dot(local, second), FLAT * ca.sumsqr(tangent))
            u -= ca.dot(local, tangent) / rate
        return self.point(u)[0]


def touch_function(
    kind: Touch, first: Arc | None, second: Arc | None, turns: bool = False
) -> ca.Function:
    """``(first and second part) → g, ∂u/∂twists, place, directions``.

    Parameters
    ----------
    kind : parts that touch
    first, second : arcs; None for a straight line, and for a corner
    turns : whether ``u`` includes the relative rotation
    """
    own = first.symbols if first else ca.SX.sym("line", SIZES[kind])
    other = second.symbols if second else ca.SX.sym("corner", BALL)
    radius, origin = ca.SX(0), own[-3:]
    if first and second:
        surface, place = _tangency(first, second)
    elif second:
        surface = _line(kind, own)
        place = second.lowest(surface[1])
    else:
        place, radius = other[:2], other[3]
        surface = first.below(place) if first else _line(kind, own)
    if first or kind in (Touch.SIDE, Touch.ARC):
        origin = own[:3]
    there = other[:3] if second else other[4:]
    wall = ca.vertcat(surface[0], 0, surface[1], 0, 0, origin)
    ball = ca.vertcat(place, 0, radius, there)
    gap = gap_function(Feature.WALL, 2, turns)(wall, ball)
    return ca.Function("touch", [own, other], [ca.densify(out) for out in gap], {"cse": True})


def _frame(symbols: ca.SX) -> Point:
    """Origin and axes of a body."""
    x = symbols[3:5]
    return symbols[:2], ca.horzcat(x, ca.vertcat(-x[1], x[0]))


def _line(kind: Touch, symbols: ca.SX) -> Point:
    """Point and normal of a straight line."""
    if kind is Touch.WALL:
        return symbols[:2], symbols[3:5]
    if kind is Touch.EDGE:
        normal = _outward(symbols[3:5] - symbols[:2])
        return symbols[:2] + symbols[6] * normal, normal
    origin, axes = _frame(symbols)
    begin, end = (origin + ca.mtimes(axes, symbols[FRAME + k : FRAME + k + 2]) for k in (0, 2))
    return begin, _outward(end - begin)


def _tangency(first: Arc, second: Arc) -> tuple[Point, ca.SX]:
    """Point and normal of the first arc, and the point of the second one."""
    u, w = _nearest_samples(first, second)
    for _ in range(ITERATIONS):
        (c, t, s), (d, q, r) = first.placed(u), second.placed(w)
        between = d - c
        parallel, along = _cross(t, q), ca.dot(between, t)
        a, b = _cross(s, q), _cross(t, r)
        e, f = ca.dot(between, s) - ca.sumsqr(t), ca.dot(t, q)
        divisor = a * f - b * e
        u += (b * along - f * parallel) / divisor
        w += (e * parallel - a * along) / divisor
    return first.point(u), second.point(w)[0]


def _nearest_samples(*arcs: Arc) -> tuple[ca.SX, ca.SX]:
    """Parameters of the nearest samples of two arcs that face each other."""
    samples, places, normals = [arc.samples for arc in arcs], [], []
    for arc in arcs:
        points = [arc.point(ca.SX(float(v))) for v in arc.samples]
        places.append(ca.horzcat(*(place for place, _ in points)))
        normals.append(ca.horzcat(*(normal for _, normal in points)))
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
