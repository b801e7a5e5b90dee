"""Search for contact points of boundaries with corners, walls, edges and other boundaries."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from dalembert.analysis.nonsmooth.gaps.boundaries.boundaries import PlacedBoundaries
from dalembert.analysis.nonsmooth.gaps.boundaries.curve_feet import (
    curve_feet,
    line_feet,
    point_feet,
)
from dalembert.analysis.nonsmooth.gaps.boundaries.outline_sides import OutlineSides
from dalembert.analysis.nonsmooth.gaps.boundaries.smooth_curve import outward
from dalembert.analysis.nonsmooth.gaps.bounding_balls import bounding_balls
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import HullGeometry
from dalembert.analysis.nonsmooth.gaps.hulls.outline_corners import OutlineCorners
from dalembert.analysis.nonsmooth.gaps.positions import Positions

ROUNDING = 1e-9
"""Extension of an edge beyond its ends, by its length."""


class Touch(IntEnum):
    """Parts of the first and the second shape."""

    CORNER = 0
    """Arc of a curve, and a corner of a hull."""
    SIDE = 1
    """Side of a polygon, and a corner of a hull."""
    WALL = 2
    """Wall, and an arc."""
    EDGE = 3
    """Edge of a hull, and an arc."""
    ARC = 4
    """Side of a polygon, and an arc."""
    ARCS = 5
    """Two arcs."""


@dataclass(frozen=True, eq=False)
class Feet:
    """Contact points of one kind: a surface with a normal, and a ball or a point.

    Attributes
    ----------
    kind : parts that touch
    first, second : (n,) numbers of the shapes
    own, other : (n,) numbers of their parts
    surface, normal, place : (n, 2) inertial
    """

    kind: Touch
    first: np.ndarray
    second: np.ndarray
    own: np.ndarray
    other: np.ndarray
    surface: np.ndarray
    normal: np.ndarray
    place: np.ndarray

    def some(self, selected: np.ndarray) -> Feet:
        """The selected ones."""
        return Feet(self.kind, *(getattr(self, name)[selected] for name in _COLUMNS))


_COLUMNS = ("first", "second", "own", "other", "surface", "normal", "place")


class BoundarySearch:
    """All contact points of boundaries within reach at a position.

    Parameters
    ----------
    geometry : of one element
    corners : its corners and those beside them
    placed : its boundaries
    at : Positions
    reach : upper limit of the gaps
    """

    def __init__(
        self,
        geometry: HullGeometry,
        corners: OutlineCorners,
        placed: PlacedBoundaries,
        at: Positions,
        reach: float,
    ):
        self.geometry, self.corners, self.placed = geometry, corners, placed
        self.at, self.reach = at, reach
        self.smooth = np.flatnonzero(placed.boundaries.curve_of >= 0)
        self.polygons = np.flatnonzero(placed.boundaries.counts > 0)

    def feet(self) -> Iterator[Feet]:
        """Contact points of all kinds."""
        hull, b = self._near_hulls()
        smooth, ends = self.placed.boundaries.curve_of[b] >= 0, ~self.geometry.endless[hull]
        yield from self._corners(hull[smooth & ends], b[smooth & ends])
        yield from self._sides(hull[~smooth & ends], b[~smooth & ends])
        yield from self._walls()
        yield from self._edges(hull[smooth], b[smooth])
        yield from self._outlines()
        yield from self._curves()

    # near pairs ----------------------------------------------------------------------------------
    def _near_hulls(self) -> tuple[np.ndarray, np.ndarray]:
        """Hulls and boundaries whose bounding balls are within reach."""
        count = len(self.geometry.hulls)
        if not count:
            return np.zeros(0, dtype=int), np.zeros(0, dtype=int)
        middles, sizes = bounding_balls(self.at.corners, self.geometry.starts)
        sizes = sizes + self.at.radii[:count]
        centers, radii = self.placed.balls
        between = middles[:, None, :2] - centers
        squared = (between**2).sum(axis=2)
        hull, b = np.nonzero(squared <= (sizes[:, None] + radii + self.reach) ** 2)
        touching = self.geometry.may_touch(hull, b + self.placed.first_shape)
        return hull[touching], b[touching]

    def _near_boundaries(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Mask of pairs of boundaries within reach of each other."""
        centers, radii = self.placed.balls
        squared = ((centers[first] - centers[second]) ** 2).sum(axis=1)
        near = squared <= (radii[first] + radii[second] + self.reach) ** 2
        shift = self.placed.first_shape
        mask: np.ndarray = near & self.geometry.may_touch(first + shift, second + shift)
        return mask

    # kinds of contact ----------------------------------------------------------------------------
    def _hull_corners(self, hull: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Rows, numbers within their hulls and numbers of all corners of some hulls."""
        starts = self.geometry.starts
        counts = starts[hull + 1] - starts[hull]
        row = np.repeat(np.arange(hull.size), counts)
        number = np.arange(row.size) - np.repeat(np.cumsum(counts) - counts, counts)
        return row, number, starts[hull[row]] + number

    def _corners(self, hull: np.ndarray, b: np.ndarray) -> Iterator[Feet]:
        """Corners near smooth curves."""
        placed = self.placed
        row, number, corner = self._hull_corners(hull)
        hull, b, place = hull[row], b[row], self.at.corners[corner, :2]
        for curve, rows in placed.by_curve(b):
            local = placed.localized(b[rows], place[rows])
            foot, u = point_feet(curve, local, self.at.radii[hull[rows]], self.reach)
            own, arc, at = rows[foot], curve.curve.arc(u), curve(u)
            yield Feet(
                Touch.CORNER,
                b[own] + placed.first_shape,
                hull[own],
                arc,
                number[own],
                placed.origins[b[own]] + placed.to_world(b[own], at[0]),
                placed.to_world(b[own], outward(at[1])),
                place[own],
            )

    def _sides(self, hull: np.ndarray, b: np.ndarray) -> Iterator[Feet]:
        """Corners near sides of polygons."""
        if not hull.size:
            return
        row, number, corner = self._hull_corners(hull)
        hull, b, place = hull[row], b[row], self.at.corners[corner, :2]
        outlines = self.placed.polygons(b)
        sides = OutlineSides(outlines, place)
        foot, side = sides.touched(self.at.radii[hull], self.reach)
        ends = np.flatnonzero(~sides.inside[foot, side])
        normals = outlines.normals[foot[ends], side[ends]]
        faces = np.ones(foot.size, dtype=bool)
        faces[ends] = self.corners.lowest(corner[foot[ends]], normals, self.at)
        foot, side = foot[faces], side[faces]
        yield Feet(
            Touch.SIDE,
            b[foot] + self.placed.first_shape,
            hull[foot],
            side,
            number[foot],
            outlines.corners[foot, side],
            outlines.normals[foot, side],
            place[foot],
        )

    def _walls(self) -> Iterator[Feet]:
        """Smooth curves near walls."""
        if not len(self.at.walls):
            return
        walls, (centers, radii) = self.at.walls[:, :, :2], self.placed.balls
        heights = ((centers[self.smooth] - walls[:, None, 0]) * walls[:, None, 1]).sum(axis=2)
        wall, k = np.nonzero(heights - radii[self.smooth] <= self.reach)
        b, first = self.smooth[k], wall + len(self.geometry.hulls)
        touching = self.geometry.may_touch(first, b + self.placed.first_shape)
        wall, b, first = wall[touching], b[touching], first[touching]
        number = np.zeros_like(wall)
        yield from self._lines(Touch.WALL, first, number, b, walls[wall, 0], walls[wall, 1])

    def _edges(self, hull: np.ndarray, b: np.ndarray) -> Iterator[Feet]:
        """Smooth curves near edges of hulls."""
        if not hull.size:
            return
        polygons = self.geometry.polygons(hull, self.at)
        row, edge = np.nonzero(polygons.has_edge)
        normals, hulls = polygons.normals[row, edge], hull[row]
        starts = polygons.corners[row, edge]
        surfaces = starts + self.at.radii[hulls, None] * normals
        for feet, rows in self._line_feet(Touch.EDGE, hulls, edge, b[row], surfaces, normals):
            own = polygons.some(row[rows])
            heights = ((feet.place[:, None] - own.corners) * own.normals).sum(axis=2)
            heights = np.where(own.has_edge, heights, -np.inf)
            highest = heights[np.arange(rows.size), edge[rows]] >= heights.max(
                axis=1, initial=-np.inf
            )
            tangent = np.stack([-normals[rows, 1], normals[rows, 0]], axis=1)
            ends = (own.corners * tangent[:, None]).sum(axis=2)
            along = (feet.place * tangent).sum(axis=1)
            slack = ROUNDING * np.ptp(ends, axis=1)
            following = (edge[rows] + 1) % own.counts
            number = np.arange(rows.size)
            inside = (along >= ends[number, edge[rows]] - slack) & (
                along <= ends[number, following] + slack
            )
            yield feet.some(highest & inside)

    def _outlines(self) -> Iterator[Feet]:
        """Smooth curves near sides of polygons."""
        if not (self.polygons.size and self.smooth.size):
            return
        first, second = (x.ravel() for x in np.meshgrid(self.polygons, self.smooth))
        near = self._near_boundaries(first, second)
        first, second = first[near], second[near]
        if not first.size:
            return
        polygons = self.placed.polygons(first)
        row, side = np.nonzero(polygons.has_edge)
        lines = polygons.corners[row, side], polygons.normals[row, side]
        shapes = first[row] + self.placed.first_shape
        for feet, rows in self._line_feet(Touch.ARC, shapes, side, second[row], *lines):
            sides = OutlineSides(polygons.some(row[rows]), feet.place)
            number = np.arange(rows.size)
            yield feet.some((sides.above & sides.valid)[number, side[rows]])

    def _curves(self) -> Iterator[Feet]:
        """Smooth curves near each other."""
        if self.smooth.size < 2:
            return
        placed = self.placed
        i, j = np.triu_indices(self.smooth.size, 1)
        first, second = self.smooth[i], self.smooth[j]
        near = self._near_boundaries(first, second)
        first, second = first[near], second[near]
        for curve, rows in placed.by_curve(first):
            for another, within in placed.by_curve(second[rows]):
                a, b = first[rows[within]], second[rows[within]]
                shift = placed.localized(a, placed.origins[b])
                turn = np.swapaxes(placed.axes[a], 1, 2) @ placed.axes[b]
                row, u, w = curve_feet(curve, another, shift, turn, self.reach)
                a, b = a[row], b[row]
                at, there = curve(u), another(w)
                yield Feet(
                    Touch.ARCS,
                    a + placed.first_shape,
                    b + placed.first_shape,
                    curve.curve.arc(u),
                    another.curve.arc(w),
                    placed.origins[a] + placed.to_world(a, at[0]),
                    placed.to_world(a, outward(at[1])),
                    placed.origins[b] + placed.to_world(b, there[0]),
                )

    # lines ---------------------------------------------------------------------------------------
    def _lines(self, *arguments) -> Iterator[Feet]:
        return (feet for feet, _ in self._line_feet(*arguments))

    def _line_feet(
        self,
        kind: Touch,
        first: np.ndarray,
        own: np.ndarray,
        b: np.ndarray,
        surfaces: np.ndarray,
        normals: np.ndarray,
    ) -> Iterator[tuple[Feet, np.ndarray]]:
        """Lowest points of curves over lines, and the rows of these."""
        placed = self.placed
        for curve, rows in placed.by_curve(b):
            local = placed.to_local(b[rows], normals[rows])
            offsets = (placed.localized(b[rows], surfaces[rows]) * local).sum(axis=1)
            foot, u = line_feet(curve, local, offsets, self.reach)
            row = rows[foot]
            feet = Feet(
                kind,
                first[row],
                b[row] + placed.first_shape,
                own[row],
                curve.curve.arc(u),
                surfaces[row],
                normals[row],
                placed.origins[b[row]] + placed.to_world(b[row], curve(u)[0]),
            )
            yield feet, row
