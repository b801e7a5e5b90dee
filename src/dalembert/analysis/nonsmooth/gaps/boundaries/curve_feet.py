"""Contact points of smooth curves with points, straight lines and each other.

Candidates are local minima of the distance at samples; safeguarded Newton iterations on

    (c(u) − r)·c'(u) = 0,      n·c'(u) = 0,      c₁' × c₂' = 0 = (c₂ − c₁)·c₁'

lead to the contact points of a point, a line and another curve. Only local minima of the distance
are contact points. Points behind a curve count if no other part of the curve is nearer.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from dalembert.analysis.nonsmooth.gaps.boundaries.smooth_curve import SampledCurve, outward

HALVINGS, ITERATIONS = 60, 15
"""Upper limits of the iterations to a point, most of which halve an interval, and to a tangent
point of two curves."""
ACCURACY, ROUNDING = 1e-9, 1e-14
"""Error of a contact point along the curve, by its radius, and changes that count as rounding."""
DEPTH = 0.1
"""Depth up to which points behind an open curve touch it, by its radius."""

Slope = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""Function of the parameters and its derivative."""


def point_feet(
    curve: SampledCurve, places: np.ndarray, radii: np.ndarray, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Rows and parameters of the points of a curve nearest to balls.

    Parameters
    ----------
    places : (m, 2) centres, in the axes of the curve
    radii : (m,)
    reach : upper limit of the gaps
    """
    between = places[:, None] - curve.places
    distance = np.linalg.norm(between, axis=2)
    nearest, rows = distance.argmin(axis=1), np.arange(places.shape[0])
    behind = (between[rows, nearest] * curve.normals[nearest]).sum(axis=1) < 0
    candidates = curve.minima(distance) & (distance - radii[:, None] <= reach + curve.spacing)
    candidates[rows[behind], nearest[behind]] = True
    row, j = np.nonzero(candidates)

    def slope(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        place, tangent, second = curve(u)
        away = place - places[row]
        along = (tangent**2).sum(axis=1) + (away * second).sum(axis=1)
        return (away * tangent).sum(axis=1), along

    u, off, rate = _roots(curve, slope, j)
    place, tangent, _ = curve(u)
    speed = np.linalg.norm(tangent, axis=1)
    depth = -((places[row] - place) * outward(tangent)).sum(axis=1)
    valid = (rate > 0) & (np.abs(off) <= ACCURACY * curve.radius * speed)
    limit = distance[row, nearest[row]] * (1 + ACCURACY) + ROUNDING * curve.radius
    if not curve.curve.closed:
        limit = np.minimum(limit, DEPTH * curve.radius)
    return _distinct(curve, row, u, valid & (depth <= limit))


def line_feet(
    curve: SampledCurve, normals: np.ndarray, offsets: np.ndarray, reach: float
) -> tuple[np.ndarray, np.ndarray]:
    """Rows and parameters of the lowest points of a curve over lines ``n·r = offset``.

    Parameters
    ----------
    normals, offsets : (m, 2), (m,) in the axes of the curve
    reach : upper limit of the heights
    """
    heights = normals @ curve.places.T - offsets[:, None]
    slack = ROUNDING * (curve.radius + np.abs(offsets)[:, None])
    row, j = np.nonzero(curve.minima(heights, slack) & (heights <= reach + curve.spacing))

    def slope(u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        _, tangent, second = curve(u)
        return (tangent * normals[row]).sum(axis=1), (second * normals[row]).sum(axis=1)

    u, off, rate = _roots(curve, slope, j)
    speed = np.linalg.norm(curve(u)[1], axis=1)
    lowest = rate >= -ACCURACY * speed**2 / curve.radius  # straight parts, too
    return _distinct(curve, row, u, lowest & (np.abs(off) <= ACCURACY * speed))


def curve_feet(
    first: SampledCurve,
    second: SampledCurve,
    shift: np.ndarray,
    turn: np.ndarray,
    reach: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows and parameters of the contact points of two curves.

    Parameters
    ----------
    shift, turn : (m, 2), (m, 2, 2) position and rotation of the second curve in the axes of the
        first, of m pairs
    reach : upper limit of the gaps
    """
    back = np.swapaxes(turn, 1, 2)
    opposite = -(back @ shift[:, :, None])[..., 0]
    here = _starts(first, second, shift, turn, reach)
    there = _starts(second, first, opposite, back, reach)
    row = np.concatenate([here[0], there[0]])
    i, j = np.concatenate([here[1], there[2]]), np.concatenate([here[2], there[1]])
    u, w, accurate = _tangency(first, second, shift[row], turn[row], i, j)
    c, t, s = first(u)
    d, q, r = (np.einsum("nij,nj->ni", turn[row], x) for x in second(w))
    between = shift[row] + d - c
    gap = (between * outward(t)).sum(axis=1)
    bend, bow = _curvature(t, s), _curvature(q, r)
    lowest = (1 + gap * bend > 0) & (1 + gap * bow > 0) & (bend + bow + gap * bend * bow > 0)
    valid = accurate & lowest & ((t * q).sum(axis=1) < 0) & (gap <= reach)
    valid &= _inside(first, u) & _inside(second, w)
    deep = np.flatnonzero(valid & (gap < 0))
    for curve, places in (
        (first, shift[row] + d),
        (second, np.einsum("nij,ni->nj", turn[row], c - shift[row])),
    ):
        nearest = np.linalg.norm(places[deep, None] - curve.places, axis=2).min(axis=1, initial=1e9)
        valid[deep] &= -gap[deep] <= nearest * (1 + ACCURACY) + ROUNDING * curve.radius
        if not curve.curve.closed:
            valid[deep] &= -gap[deep] <= DEPTH * curve.radius
    row, u, w = row[valid], first.curve.wrapped(u[valid]), second.curve.wrapped(w[valid])
    rounded = np.round(np.stack([row, u / first.curve.period, w / second.curve.period]), 9)
    kept = np.sort(np.unique(rounded, axis=1, return_index=True)[1])
    return row[kept], u[kept], w[kept]


def _starts(
    first: SampledCurve, second: SampledCurve, shift: np.ndarray, turn: np.ndarray, reach: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows, samples of the first curve with a locally smallest distance from samples of the second
    one that face them, and these."""
    center = shift + (turn @ second.center)
    from_center = np.linalg.norm(first.places - center[:, None], axis=2)
    beside = from_center - second.radius - first.spacing <= reach
    row, i = np.nonzero(beside)
    distance = np.full(beside.shape, np.inf)
    partner = np.zeros(beside.shape, dtype=int)
    apart, nearest = np.zeros(row.size), np.zeros(row.size, dtype=int)
    back = np.swapaxes(turn, 1, 2)[row]
    places = np.einsum("nij,nj->ni", back, first.places[i] - shift[row])
    facing = np.einsum("nij,nj->ni", back, first.normals[i])
    block = max(1, 2**20 // second.places.shape[0])
    for k in range(0, row.size, block):
        part = slice(k, k + block)
        squared = ((places[part, None] - second.places) ** 2).sum(axis=2)
        squared[facing[part] @ second.normals.T >= 0] = np.inf
        nearest[part] = squared.argmin(axis=1)
        apart[part] = np.sqrt(squared[np.arange(squared.shape[0]), nearest[part]])
    distance[row, i], partner[row, i] = apart, nearest
    slack = first.spacing + second.spacing[partner]
    row, i = np.nonzero(first.minima(distance) & (distance <= reach + slack))
    return row, i, partner[row, i]


def _tangency(
    first: SampledCurve,
    second: SampledCurve,
    shift: np.ndarray,
    turn: np.ndarray,
    i: np.ndarray,
    j: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Parameters of points with opposite tangents and a common normal, by Newton's method with
    limited steps, and whether they are accurate."""
    (below, u, above), (under, w, over) = first.brackets(i), second.brackets(j)
    longest = above - below, over - under
    for _ in range(ITERATIONS):
        c, t, s = first(u)
        d, q, r = (np.einsum("nij,nj->ni", turn, x) for x in second(w))
        between = shift + d - c
        parallel, along = _cross(t, q), (between * t).sum(axis=1)
        matrix = np.empty((u.size, 2, 2))
        matrix[:, 0, 0], matrix[:, 0, 1] = _cross(s, q), _cross(t, r)
        matrix[:, 1, 0] = (between * s).sum(axis=1) - (t**2).sum(axis=1)
        matrix[:, 1, 1] = (t * q).sum(axis=1)
        divisor = matrix[:, 0, 0] * matrix[:, 1, 1] - matrix[:, 0, 1] * matrix[:, 1, 0]
        regular = divisor != 0
        divisor = np.where(regular, divisor, 1.0)
        du = (matrix[:, 0, 1] * along - matrix[:, 1, 1] * parallel) / divisor
        dw = (matrix[:, 1, 0] * parallel - matrix[:, 0, 0] * along) / divisor
        size = np.maximum(np.abs(du) / longest[0], np.abs(dw) / longest[1])
        factor = regular / np.maximum(size, 1.0)
        u, w = first.clipped(u + factor * du), second.clipped(w + factor * dw)
        if not (size > ROUNDING * 1e2).any():
            break
    t, q = first(u)[1], np.einsum("nij,nj->ni", turn, second(w)[1])
    lengths = np.linalg.norm(t, axis=1), np.linalg.norm(q, axis=1)
    between = shift + np.einsum("nij,nj->ni", turn, second(w)[0]) - first(u)[0]
    accurate = np.abs(_cross(t, q)) <= ACCURACY * lengths[0] * lengths[1]
    accurate &= np.abs((between * t).sum(axis=1)) <= ACCURACY * first.radius * lengths[0]
    return u, w, accurate & regular


def _roots(
    curve: SampledCurve, slope: Slope, j: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Zeros of increasing functions near samples ``j``, residuals and derivatives there.

    Newton's method, by halves where it leaves the interval in which the sign changes.
    """
    low, u, high = curve.brackets(j)
    width = high - low
    for _ in range(HALVINGS):
        value, rate = slope(u)
        low, high = np.where(value < 0, u, low), np.where(value > 0, u, high)
        newton = u - value / np.where(rate > 0, rate, np.inf)
        outside = (rate <= 0) | (newton < low) | (newton > high)
        following = np.where(outside & (value != 0), (low + high) / 2, newton)
        change, u = np.abs(following - u), following
        if not (change > ROUNDING * width).any():
            break
    value, rate = slope(u)
    return u, value, rate


def _inside(curve: SampledCurve, u: np.ndarray) -> np.ndarray:
    """Mask of parameters in the range of a curve."""
    c = curve.curve
    inside: np.ndarray = (u >= c.low) & (u <= c.low + c.period) | c.closed
    return inside


def _distinct(
    curve: SampledCurve, row: np.ndarray, u: np.ndarray, valid: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Valid contact points without duplicates."""
    valid = valid & _inside(curve, u)
    row, u = row[valid], curve.curve.wrapped(u[valid])
    rounded = np.round(np.stack([row, (u - curve.curve.low) / curve.curve.period]), 9)
    kept = np.sort(np.unique(rounded, axis=1, return_index=True)[1])
    return row[kept], u[kept]


def _curvature(tangent: np.ndarray, second: np.ndarray) -> np.ndarray:
    speed = np.linalg.norm(tangent, axis=1)
    curvature: np.ndarray = _cross(tangent, second) / np.where(speed > 0, speed, np.inf) ** 3
    return curvature


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    product: np.ndarray = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return product
