"""Sharp corners of hulls over the faces of other hulls."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.gaps.corners_over_faces import CornersOverFaces
from dalembert.analysis.nonsmooth.gaps.hulls.feature_pairs import Pairs
from dalembert.analysis.nonsmooth.gaps.hulls.hull_geometry import HullGeometry
from dalembert.analysis.nonsmooth.gaps.hulls.polyhedra import Polyhedra
from dalembert.analysis.nonsmooth.gaps.positions import Positions


def are_sharp(geometry: HullGeometry, pairs: Pairs, at: Positions) -> np.ndarray:
    """(n,) mask of the pairs of polygons or polyhedra without radii."""
    mask = np.ones(pairs.first.size, dtype=bool)
    for shapes in (pairs.first, pairs.second):
        others = geometry.flat_ends[shapes] | np.isin(shapes, geometry.terrains)
        mask &= ~others & (at.radii[shapes] == 0)
    return mask


def corners_over_hulls(geometry: HullGeometry, pairs: Pairs, at: Positions) -> CornersOverFaces:
    """Corners of the second hulls over faces of the first ones."""
    starts = geometry.starts
    first, own, place = (
        starts[pairs.first],
        pairs.own,
        at.corners[starts[pairs.second] + pairs.other],
    )
    if geometry.dimension == 2:
        following = (own + 1) % (starts[pairs.first + 1] - first)
        begin, end = at.corners[first + own, :2], at.corners[first + following, :2]
        none, convex = np.zeros(own.size), np.ones((2, own.size), dtype=bool)
        return CornersOverFaces.of_sides(place[:, :2] - begin, end - begin, none, convex)
    counts, loops = np.zeros(own.size, dtype=int), np.zeros((own.size, 0), dtype=int)
    for hulls in geometry.equal_forms(np.unique(pairs.first)):
        solid, rows = geometry.solids(hulls, at), np.isin(pairs.first, hulls)
        assert isinstance(solid, Polyhedra)
        faces = solid.form.loops[own[rows]]
        missing = max(faces.shape[1] - loops.shape[1], 0)
        loops = np.pad(loops, ((0, 0), (0, missing)))
        loops[rows, : faces.shape[1]], counts[rows] = faces, solid.form.counts[own[rows]]
    return CornersOverFaces.of_loops(place, at.corners[first[:, None] + loops], counts)
