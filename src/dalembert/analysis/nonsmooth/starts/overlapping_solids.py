"""Spatial solids that overlap so deeply at the start that no gap may be negative.

The search for features of a cylinder has a bound of the separation at depths above a tenth of its
diameter, and finds none where this is positive. Two convex solids A and B overlap by the distance
of the origin from the boundary of their Minkowski difference B − A (Cameron & Culley 1986). Points
that are farthest in a direction decide this: a direction in which none is beyond the origin
separates the solids (Gilbert, SIAM J. Control 4, 1966), and facets of their convex hull about the
origin are a lower bound of the depth (van den Bergen 2001).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.analysis.nonsmooth.gaps.bounding_balls import bounding_balls, near_balls
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.hulls.hull_gaps import HullGaps
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import HullGeometry
from dalembert.analysis.nonsmooth.gaps.positions import Positions
from dalembert.analysis.nonsmooth.gaps.searched_gaps import LastPosition

STEPS, REFINEMENTS = 60, 60
"""Upper limits of the steps towards a separating direction, and of the points of a hull."""
AGREEMENT = 0.02
"""Relative difference of the bounds of a depth that ends its refinement [-]."""
NEAR = 0.05
"""Distance of touching shapes whose normals are tested first, by the smallest radius [-]."""
LEVEL = 1e-12
"""Sine of the angle of a direction and the axis of a cylinder that counts as zero."""

CUBE = np.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)])
DIRECTIONS = CUBE[np.abs(CUBE).sum(axis=1) > 0].astype(float)
"""(26, 3) directions of the first points of a hull."""

Overlap = tuple[int, int, float]
"""Numbers of two shapes, and a depth to which they overlap at least."""


@dataclass(frozen=True, eq=False)
class SupportPoints:
    """Farthest points of convex solids.

    Attributes
    ----------
    geometry : of the shapes
    at : their positions
    """

    geometry: HullGeometry
    at: Positions

    def farthest(self, hulls: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """(m, 3) points of solids (m,) farthest along unit vectors (m, 3)."""
        starts, flat = self.geometry.starts, self.geometry.flat_ends[hulls]
        counts = np.where(flat, 2, starts[hulls + 1] - starts[hulls])
        first = np.cumsum(counts) - counts
        row = np.repeat(np.arange(hulls.size), counts)
        corner = starts[hulls][row] + np.arange(row.size) - first[row]
        along = (self.at.corners[corner] * directions[row]).sum(axis=1)
        highest = np.flatnonzero(along == np.maximum.reduceat(along, first)[row])
        chosen = highest[np.unique(row[highest], return_index=True)[1]]
        radial = directions.copy()
        ends = self.at.corners[starts[hulls[flat]][:, None] + [0, 1]]
        axis = ends[:, 0] - ends[:, 1]
        axis /= np.linalg.norm(axis, axis=1, keepdims=True)
        across = radial[flat] - (radial[flat] * axis).sum(axis=1, keepdims=True) * axis
        length = np.linalg.norm(across, axis=1, keepdims=True)
        radial[flat] = np.where(length > LEVEL, across / np.maximum(length, LEVEL), 0.0)
        points: np.ndarray = self.at.corners[corner[chosen]]
        return points + self.at.radii[hulls][:, None] * radial

    def differences(
        self, first: np.ndarray, second: np.ndarray, directions: np.ndarray
    ) -> np.ndarray:
        """(m, 3) points of the differences of solids, farthest along unit vectors."""
        return self.farthest(second, directions) - self.farthest(first, -directions)

    def separable(self, first: np.ndarray, second: np.ndarray, tolerance: np.ndarray) -> np.ndarray:
        """Mask of pairs (m,) with a direction along which they overlap by the tolerance or less;
        some pairs that hardly overlap may be missing."""
        separable, rows = np.zeros(first.size, dtype=bool), np.arange(first.size)
        nearest = self.differences(first, second, np.tile([1.0, 0.0, 0.0], (first.size, 1)))
        for _ in range(STEPS):
            if not rows.size:
                break
            length = np.linalg.norm(nearest[rows], axis=1)
            rows, length = rows[length > 0], length[length > 0]
            unit = nearest[rows] / length[:, None]
            point = self.differences(first[rows], second[rows], -unit)
            separable[rows] = apart = (point * unit).sum(axis=1) >= -tolerance[rows]
            rows, point = rows[~apart], point[~apart]
            line = point - nearest[rows]
            square = np.maximum((line**2).sum(axis=1), np.finfo(float).tiny)
            fraction = np.clip(-(nearest[rows] * line).sum(axis=1) / square, 0.0, 1.0)
            nearest[rows] += fraction[:, None] * line
        return separable

    def depth(self, first: int, second: int, tolerance: float) -> float:
        """Lower bound of the depth of an overlap, within a few per cent of it; zero if that does
        not exceed the tolerance."""
        from scipy.spatial import ConvexHull, QhullError

        def points(directions: np.ndarray) -> np.ndarray:
            count = len(directions)
            return self.differences(np.full(count, first), np.full(count, second), directions)

        places = points(DIRECTIONS / np.linalg.norm(DIRECTIONS, axis=1, keepdims=True))
        above, below = np.inf, 0.0
        for _ in range(REFINEMENTS):
            try:
                facets = ConvexHull(places).equations
            except QhullError:  # no volume
                break
            nearest = facets[(-facets[:, 3]).argmin()]
            place = points(nearest[None, :3])
            above = min(above, float((place @ nearest[:3])[0]))
            below = max(below, -float(nearest[3]))
            if above <= max(tolerance, (1 + AGREEMENT) * below):
                break
            places = np.vstack([places, place])
        return below if above > tolerance else 0.0


def overlapping_solids(
    source: HullGaps, configuration: Configuration, tolerances: np.ndarray
) -> Overlap | None:
    """The deepest overlap of cylinders with each other or other solids; None without one.

    Parameters
    ----------
    source : gaps of spatial hulls
    configuration : Configuration
    tolerances : (s,) depth of an overlap of each shape that counts as rounded input [m]
    """
    geometry = source.geometry
    at, flat = geometry.positions(configuration), geometry.flat_ends
    solids = np.setdiff1d(np.arange(len(geometry.hulls)), geometry.terrains)
    if not flat.any() or solids.size < 2:
        return None
    centers, radii = bounding_balls(at.corners, geometry.starts)
    radii = radii + np.where(flat, 0.0, at.radii)[: radii.size]
    first, second = solids[near_balls(centers[solids], radii[solids], 0.0)]
    possible = (flat[first] | flat[second]) & geometry.may_touch(first, second)
    possible &= ~geometry.compliant(first, second)
    first, second = first[possible], second[possible]
    tolerance = np.minimum(tolerances[first], tolerances[second])
    support = SupportPoints(geometry, at)
    reach = NEAR * float(radii[solids].min())
    rest = ~_separated(source, configuration, reach, support, (first, second, tolerance))
    first, second, tolerance = first[rest], second[rest], tolerance[rest]
    rest = ~support.separable(first, second, tolerance)
    deepest: Overlap | None = None
    for i, j, least in zip(first[rest], second[rest], tolerance[rest], strict=True):
        depth = support.depth(int(i), int(j), float(least))
        if depth > (deepest[2] if deepest else 0.0):
            deepest = int(i), int(j), depth
    return deepest


def _separated(
    source: HullGaps,
    configuration: Configuration,
    reach: float,
    support: SupportPoints,
    pairs: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> np.ndarray:
    """Mask of pairs that overlap by the tolerance or less along the normal of one of their gaps."""
    first, second, tolerance = pairs
    last = LastPosition(source.geometry, configuration, support.at, reach)
    separated = np.zeros(first.size, dtype=bool)
    count = len(source.geometry.shapes)
    order = np.argsort(numbers := first * count + second)
    for gaps in source.within(last):
        low, high = np.sort(np.stack([gaps.first, gaps.second]), axis=0)
        row = np.searchsorted(numbers, low * count + high, sorter=order)
        row = order[np.minimum(row, order.size - 1)] if order.size else row
        own = np.flatnonzero(order.size and numbers[row] == low * count + high)
        if own.size:
            row, key = row[own], gaps.key[own]
            normals = source.points(configuration, key)[1][:, :, 0]
            for side in (normals, -normals):
                heights = (support.differences(first[row], second[row], side) * side).sum(axis=1)
                separated[row[heights <= tolerance[row]]] = True
    return separated
