"""Search for near features of a terrain and other shapes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dalembert.analysis.nonsmooth.gaps.cylinders.cylinders import SECTORS, Cylinders
from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature
from dalembert.analysis.nonsmooth.gaps.hulls.feature_pairs import EvaluatePairs, Pairs, some_pairs
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import HullGeometry
from dalembert.analysis.nonsmooth.gaps.positions import Positions
from dalembert.analysis.nonsmooth.gaps.terrain.terrain import FRAME, Terrain
from dalembert.analysis.nonsmooth.gaps.terrain.terrain_corners import (
    surface_near_balls,
    triangles_below,
    triangles_below_rims,
)
from dalembert.analysis.nonsmooth.gaps.terrain.terrain_edges import (
    on_ridges,
    peaks_under_cylinders,
    peaks_under_faces,
    peaks_under_lines,
    ridges_across,
    rims_across,
)
from dalembert.elements.contact.hull import MARKS


class TerrainSearch:
    """Near features of one terrain and some hulls.

    Parameters
    ----------
    geometry : HullGeometry
    number : of the terrain among the shapes
    hulls : (h,) numbers of the shapes that may touch it
    """

    def __init__(self, geometry: HullGeometry, number: int, hulls: np.ndarray):
        self.geometry, self.number, self.hulls = geometry, number, hulls

    def __call__(self, at: Positions, reach: float, evaluate: EvaluatePairs) -> list[Pairs]:
        """Features that touch within reach."""
        terrain, hulls = self.geometry.terrain(self.number, at), self._low(at, reach)
        if not hulls.size:
            return []
        flat = self.geometry.flat_ends[hulls]
        pairs = [*self._corners(terrain, hulls[~flat], at, reach)]
        for own in self.geometry.equal_forms(hulls):
            solids = self.geometry.solids(own, at)
            if isinstance(solids, Cylinders):
                pairs += self._cylinders(terrain, own, solids, reach)
                pairs.append(self._rims(terrain, own, solids, reach, evaluate))
            elif solids.form.edges.size:
                if solids.form.has_faces:
                    row, face, vertex = peaks_under_faces(terrain, solids, reach)
                    pairs.append(self._over(Feature.FACE, own[row], face, vertex))
                else:
                    row, edge, vertex = peaks_under_lines(terrain, solids, at.radii[own], reach)
                    pairs.append(self._over(Feature.EDGE, own[row], edge, vertex))
                row, edge, ridge = ridges_across(terrain, solids, at.radii[own], reach)
                pairs.append(self._under(Feature.EDGES, ridge, own[row], edge))
        return [part for part in pairs if part.first.size]

    def _low(self, at: Positions, reach: float) -> np.ndarray:
        """Hulls whose lowest point is not above the terrain."""
        terrain, starts = self.geometry.terrain(self.number, at), self.geometry.starts
        heights = (at.corners - terrain.corners[0]) @ terrain.up
        lowest = np.minimum.reduceat(heights, starts[:-1])[self.hulls] - at.radii[self.hulls]
        return self.hulls[lowest <= terrain.top + reach]

    def _corners(
        self, terrain: Terrain, hulls: np.ndarray, at: Positions, reach: float
    ) -> Iterator[Pairs]:
        """Corners and rounded corners."""
        starts = self.geometry.starts
        counts = starts[hulls + 1] - starts[hulls]
        owner = np.repeat(hulls, counts)
        local = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
        places, rounded = at.corners[starts[owner] + local], self.geometry.rounded[owner]
        k, triangle = triangles_below(terrain, places[~rounded], reach)
        yield self._under(Feature.FACE, triangle, owner[~rounded][k], local[~rounded][k])
        if rounded.any():
            owner, local = owner[rounded], local[rounded]
            touching = surface_near_balls(terrain, places[rounded], at.radii[owner], reach)
            offsets = {Feature.FACE: 0, Feature.EDGE: 0, Feature.CORNERS: FRAME}
            for (feature, offset), (k, own) in zip(offsets.items(), touching, strict=True):
                yield self._under(feature, own + offset, owner[k], local[k])

    def _cylinders(
        self, terrain: Terrain, hulls: np.ndarray, cylinders: Cylinders, reach: float
    ) -> list[Pairs]:
        """Rims, ends and round sides."""
        (rim, below), (mark, under) = triangles_below_rims(terrain, cylinders, reach)
        (i, end, peak), (j, side, other) = peaks_under_cylinders(terrain, cylinders, reach)
        row, edge, ridge = ridges_across(terrain, cylinders, cylinders.radii, reach)
        return [
            self._under(Feature.FACE_RIM, below, hulls[rim // 2], rim % 2),
            self._under(Feature.FACE, under, hulls[mark // (2 * MARKS)], 2 + mark % (2 * MARKS)),
            self._over(Feature.CAP, hulls[i], end, peak),
            self._over(Feature.EDGE, hulls[j], side, other),
            self._under(Feature.EDGES, ridge, hulls[row], edge),
        ]

    def _rims(
        self,
        terrain: Terrain,
        hulls: np.ndarray,
        cylinders: Cylinders,
        reach: float,
        evaluate: EvaluatePairs,
    ) -> Pairs:
        """Rims that cross ridges."""
        row, rim, ridge = rims_across(terrain, cylinders, reach)
        other = np.full(row.size, self.number)
        pairs = Pairs(Feature.RIM_EDGE, hulls[row], other, rim, ridge)
        if not row.size:
            return pairs
        gap, place, normal = evaluate(pairs)
        outside = cylinders.some(row).outside(rim // SECTORS, place, normal)
        near = np.isfinite(gap) & (outside >= 0) & on_ridges(terrain, ridge, place, normal)
        return some_pairs(pairs, near)

    def _under(
        self, feature: Feature, own: np.ndarray, hulls: np.ndarray, other: np.ndarray
    ) -> Pairs:
        """Features of the terrain, and those of hulls."""
        return Pairs(feature, np.full(hulls.size, self.number), hulls, own, other)

    def _over(
        self, feature: Feature, hulls: np.ndarray, own: np.ndarray, vertex: np.ndarray
    ) -> Pairs:
        """Features of hulls, and vertices of the terrain."""
        return Pairs(feature, hulls, np.full(hulls.size, self.number), own, vertex + FRAME)
