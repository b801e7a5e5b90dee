"""Planar shapes that overlap so deeply at the start that no gap is negative.

A curve or a polygon with dents touches other shapes at local minima of the distance. Where two
shapes cross each other, all of these may be outside.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from dalembert.analysis.nonsmooth.gaps.boundaries.boundaries import PlacedBoundaries
from dalembert.analysis.nonsmooth.gaps.boundaries.boundary_gaps import BoundaryGaps
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import HullGeometry
from dalembert.analysis.nonsmooth.gaps.positions import Positions

PARTS = 128
"""Points of the perimeter of a shape that are tested."""
SHARE, SAGITTA = 0.05, 0.0025
"""Least depth of an overlap, by the thickness of the thinner shape, and by the extent of the larger
one, which the chords of its concave arcs exceed by less [-]."""


@dataclass(frozen=True, eq=False)
class Outlined:
    """A shape whose material is within a polygon.

    Attributes
    ----------
    shape : its number
    corners : (n, 2) anticlockwise, inertial
    """

    shape: int
    corners: np.ndarray

    @property
    def extent(self) -> float:
        """The larger one of its extents [m]."""
        return float(np.ptp(self.corners, axis=0).max())

    @property
    def thickness(self) -> float:
        """Four times its area by its perimeter: the diameter of a circle [m]."""
        x, y = (self.corners - self.corners.mean(axis=0)).T
        area = (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2
        sides = np.roll(self.corners, -1, axis=0) - self.corners
        return float(4 * area / np.linalg.norm(sides, axis=1).sum())

    @property
    def marks(self) -> np.ndarray:
        """(m, 2) its corners, and points between them."""
        following = np.roll(self.corners, -1, axis=0)
        length = np.linalg.norm(following - self.corners, axis=1)
        counts = np.maximum(np.ceil(PARTS * length / max(length.sum(), 1e-300)), 1).astype(int)
        side = np.repeat(np.arange(counts.size), counts)
        part = np.arange(side.size) - np.repeat(np.cumsum(counts) - counts, counts)
        fraction = (part / counts[side])[:, None]
        marks: np.ndarray = (1 - fraction) * self.corners[side] + fraction * following[side]
        return marks

    def depths(self, places: np.ndarray) -> np.ndarray:
        """(m,) depths of places (m, 2) in the material; zero outside."""
        start, end = self.corners, np.roll(self.corners, -1, axis=0)
        side, relative = end - start, places[:, None] - start
        square = np.where((side**2).sum(axis=1) > 0, (side**2).sum(axis=1), 1.0)
        fraction = np.clip((relative * side).sum(axis=2) / square, 0.0, 1.0)
        distance = np.linalg.norm(relative - fraction[..., None] * side, axis=2).min(axis=1)
        above = places[:, None, 1] < start[:, 1], places[:, None, 1] < end[:, 1]
        crossed = above[0] != above[1]
        rise = np.where(side[:, 1] != 0, side[:, 1], 1.0)
        across = start[:, 0] + relative[..., 1] * side[:, 0] / rise
        inside = (crossed & (places[:, None, 0] < across)).sum(axis=1) % 2 == 1
        return np.where(inside, distance, 0.0)


def overlapping_outlines(
    source: BoundaryGaps, configuration: Configuration
) -> tuple[int, int, float] | None:
    """Numbers of two rigid shapes of a source that overlap, and a depth to which they do at least;
    the deepest ones, or None."""
    geometry = source.geometry
    at = geometry.positions(configuration)
    outlined = [*_hulls(geometry, at), *_boundaries(source, at, configuration.p)]
    deepest: tuple[int, int, float] | None = None
    low = np.array([shape.corners.min(axis=0) for shape in outlined]).reshape(-1, 2)
    high = np.array([shape.corners.max(axis=0) for shape in outlined]).reshape(-1, 2)
    number = np.array([shape.shape for shape in outlined], dtype=int)
    for j in np.flatnonzero(number >= len(geometry.hulls)):  # boundaries
        near = (low[:j] < high[j]).all(axis=1) & (low[j] < high[:j]).all(axis=1)
        other = np.full(j, number[j])
        near &= geometry.may_touch(number[:j], other) & ~geometry.compliant(number[:j], other)
        for i in np.flatnonzero(near):
            pair = outlined[i], outlined[j]
            depth = max(pair[0].depths(pair[1].marks).max(), pair[1].depths(pair[0].marks).max())
            least = SHARE * min(shape.thickness for shape in pair)
            least += SAGITTA * max(shape.extent for shape in pair)
            if depth > least and (deepest is None or depth > deepest[2]):
                deepest = int(number[i]), int(number[j]), float(depth)
    return deepest


def _hulls(geometry: HullGeometry, at: Positions) -> Iterator[Outlined]:
    """Polygons, circles and capsules; corners of outlines have no material of their own."""
    angles = 2 * np.pi * np.arange(PARTS) / PARTS
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    for number in np.flatnonzero(~geometry.endless[: len(geometry.hulls)]).tolist():
        corners, radius = geometry.corners_of(number, at)[:, :2], at.radii[number]
        if len(corners) > 2:
            yield Outlined(number, corners)
        elif radius > 0:
            along = corners[-1] - corners[0]
            ahead = (circle @ along > 0).astype(int) * (len(corners) - 1)
            yield Outlined(number, corners[ahead] + radius * circle)


def _boundaries(source: BoundaryGaps, at: Positions, p: np.ndarray) -> Iterator[Outlined]:
    """Polygons with dents, and closed curves around their material."""
    boundaries, geometry = source.boundaries, source.geometry
    placed, local = PlacedBoundaries(boundaries, geometry, at, p), boundaries.at(p)
    for b, curve in enumerate(boundaries.curve_of):
        if curve >= 0 and not local.curves[curve].curve.closed:
            continue
        own = slice(boundaries.starts[b], boundaries.starts[b + 1])
        corners = local.curves[curve].places if curve >= 0 else local.vertices[own]
        x, y = corners.T
        if (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() > 0:  # else a hole
            moved = placed.to_world(np.full(len(corners), b), corners) + placed.origins[b]
            yield Outlined(placed.first_shape + b, moved)
