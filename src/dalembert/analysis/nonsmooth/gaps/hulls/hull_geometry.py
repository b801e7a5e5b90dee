"""Positions and features of rounded convex hulls and walls, symbolic and numeric."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.cylinders.cylinders import (
    SECTORS,
    Cylinders,
    sector_directions,
)
from dalembert.analysis.nonsmooth.gaps.gap_functions import RIM_POINTS, WALLS, point_counts
from dalembert.analysis.nonsmooth.gaps.gap_source import GapFormulas
from dalembert.analysis.nonsmooth.gaps.geometry_entries import GeometryEntries
from dalembert.analysis.nonsmooth.gaps.hulls.feature_columns import FeatureColumns
from dalembert.analysis.nonsmooth.gaps.hulls.feature_pairs import Pairs
from dalembert.analysis.nonsmooth.gaps.hulls.form_tables import FormTables
from dalembert.analysis.nonsmooth.gaps.hulls.planar_features import Polygons
from dalembert.analysis.nonsmooth.gaps.hulls.polyhedra import Form, Polyhedra
from dalembert.analysis.nonsmooth.gaps.hulls.strands import Strands
from dalembert.analysis.nonsmooth.gaps.positions import Positions
from dalembert.analysis.nonsmooth.gaps.shape_velocities import ShapeVelocities
from dalembert.analysis.nonsmooth.gaps.terrain.terrain import Terrain, TerrainForm
from dalembert.elements.contact.beam_parts import Chord
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.hull import MARKS
from dalembert.elements.contact.pairs import APART
from dalembert.elements.contact.shapes import Shape
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel

Solids = Polyhedra | Cylinders
"""Spatial hulls of equal form."""


class HullGeometry:
    """Shapes of one ``Collisions`` element: hulls, then walls, then boundaries.

    Parameters
    ----------
    model : Model
    element : Collisions

    Attributes
    ----------
    shapes, hulls, boundaries : all shapes; forms of the first and the last ones
    starts : (h + 1,) number of the first corner of each hull
    owner : (s,) number of the body of each shape
    endless : (s,) whether corners of a shape are those of others, which touch instead
    formulas, numbers : GapFormulas, and the numbers of their entries
    velocities : twists of all shapes by the speeds
    """

    def __init__(self, model: Model, element: Collisions):
        hulls, walls, boundaries = element.hulls, element.walls, element.boundaries
        surroundings = [*walls, *(shape for shape, _ in boundaries)]
        self.shapes: list[Shape] = [*(shape for shape, _ in hulls), *surroundings]
        self.carriers = [solid.carrier for _, solid in hulls]
        self.carriers += [shape.carrier for shape in surroundings]
        self.hulls, self.dimension = [solid.hull for _, solid in hulls], element.dimension
        self.boundaries = [boundary for _, boundary in boundaries]
        self._groups, self._laws = element.group_of(self.shapes), element.laws
        self._has_force = np.array([law is not None for law in element.force_laws])
        self.starts = np.cumsum([0, *(len(hull.corners) for hull in self.hulls)])
        self._edge_starts = np.cumsum([0, *(len(hull.edges) for hull in self.hulls)])
        self._face_starts = np.cumsum([0, *(len(hull.faces) for hull in self.hulls)])
        self._edges = self._table(2, [hull.edges for hull in self.hulls])
        self._faces = self._table(3, [hull.faces for hull in self.hulls])
        forms = [(len(h.corners), h.edges, h.faces, h.parallel, h.flat_ends) for h in self.hulls]
        self._form = _first_equal(forms)
        self.terrains = [k for k, hull in enumerate(self.hulls) if hull.grid]
        self._forms = {
            int(k): Form(self.hulls[k]) for k in np.unique(self._form) if k not in self.terrains
        }
        self._surfaces = {k: TerrainForm(self.hulls[k]) for k in self.terrains}
        self._last_terrain: dict[int, Terrain] = {}
        self.owner = _first_equal([id(carrier.owner) for carrier in self.carriers])
        self.endless = np.array([isinstance(carrier, Chord) for carrier in self.carriers])
        beams = self.endless.any()
        self._strands = Strands(model, self.carriers, self.hulls) if beams else None
        sharp = [hull.is_sharp for hull in self.hulls]
        self.rounded = ~np.array(sharp, dtype=bool)
        others = [False] * len(surroundings)
        self.flat_ends = np.array([hull.flat_ends for hull in self.hulls] + others)
        self._has_flat_ends = bool(self.flat_ends.any())
        self._symbols(model, element)

    @cached_property
    def form_tables(self) -> FormTables:
        """Forms of the hulls as integers."""
        return FormTables(self.hulls, self._form, self.dimension)

    @property
    def feature_counts(self) -> list[int]:
        """Upper limits of the numbers of the features of all shapes."""
        rims = 2 * SECTORS
        return [
            rims if h.flat_ends else max(len(h.corners), 2 * len(h.edges), len(h.faces))
            for h in self.hulls
        ] + [1] * (len(self.shapes) - len(self.hulls))

    def _table(self, size: int, features: list[tuple[tuple[int, ...], ...]]) -> np.ndarray:
        """(n, size) numbers of the first corners of the features of all hulls."""
        rows = [
            [start + corner for corner in feature[:size]]
            for start, listed in zip(self.starts, features, strict=False)
            for feature in listed
        ]
        return np.array(rows, dtype=int).reshape(-1, size)

    def _symbols(self, model: Model, element: Collisions) -> None:
        e = model.all_equations
        carriers, d = self.carriers, self.dimension
        origins = [_in_space(carrier.locate(ca.SX.zeros(d))) for carrier in carriers]
        twists = [
            ca.vertcat(carrier.velocity_at(origin), carrier.turning)
            for carrier, origin in zip(carriers, origins, strict=True)
        ]
        corners = [
            _in_space(carrier.locate(corner))
            for carrier, hull in zip(carriers, self.hulls, strict=False)
            for corner in hull.corners
        ]
        walls = [
            ca.vertcat(_in_space(wall.point.position.sx), _in_space(wall.outward))
            for wall in element.walls
        ]
        others = len(self.shapes) - len(self.hulls)
        axes = [s.carrier.turned(ca.SX([1, 0])) for s, _ in element.boundaries]
        outputs = [
            ca.horzcat(*corners) if corners else ca.SX(3, 0),
            ca.horzcat(*walls) if walls else ca.SX(6, 0),
            ca.vertcat(*(hull.radius for hull in self.hulls), ca.SX.zeros(others)),
            ca.horzcat(*origins),
            element.coefficients,
            ca.horzcat(*axes) if axes else ca.SX(2, 0),
        ]
        outputs = [model.at_ground(ca.densify(s)) if s.numel() else s for s in outputs]
        moving = model.at_ground(ca.vertcat(*twists))
        sectors = ca.vec(ca.SX(sector_directions(np.arange(SECTORS)).T))
        columns = [*(ca.vec(out) for out in outputs), ca.vertcat(0, sectors)]  # constants last
        self.formulas = GapFormulas(ca.vertcat(*columns), moving)
        self.numbers = GeometryEntries([column.numel() for column in columns], len(self.hulls))
        inputs = [e.t, e.y, e.p]
        self._positions = Kernel(ca.Function("positions", inputs, outputs))
        self.velocities = ShapeVelocities(moving, e.v, inputs)

    def positions(self, configuration: Configuration) -> Positions:
        """Positions of the shapes."""
        corners, walls, radii, origins, laws, axes = self._positions(*configuration)
        points = walls.T.reshape(-1, 2, 3)
        return Positions(corners.T, points, radii.ravel(), origins.T, laws, axes.T)

    def may_touch(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """Mask of pairs of shapes of different bodies, or distant parts of a beam, whose groups
        touch."""
        apart: np.ndarray = self.owner[first] != self.owner[second]
        if self._strands is not None:
            apart = self._strands.apart(first, second, apart)
        return apart & (self.law(first, second) != APART)

    def law(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """(n,) numbers of the laws of pairs of shapes."""
        numbers: np.ndarray = self._laws[self._groups[first], self._groups[second]]
        return numbers

    def compliant(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """(n,) mask of pairs of shapes with a force law."""
        mask: np.ndarray = self._has_force[self.law(first, second)]
        return mask

    @property
    def has_compliant_ends(self) -> bool:
        """Whether there are cylinders and force laws."""
        return bool(self.flat_ends.any() and self._has_force.any())

    def reach(self, arms: np.ndarray, moved: np.ndarray) -> float:
        """Largest distance that two shapes cover by displacements of their twists.

        Parameters
        ----------
        arms : (s,) largest distances of points of the shapes from the origins of their bodies
        moved : (s, 6, m) displacements and rotations
        """
        straight, turned = (np.linalg.norm(moved[:, s], axis=1) for s in (slice(3), slice(3, 6)))
        return 2 * float((straight + arms[:, None] * turned).max(initial=0.0))

    def arms(self, at: Positions) -> np.ndarray:
        """(s,) largest distances of corners from the origins of their bodies."""
        arms, count = np.zeros(at.radii.size), len(self.hulls)
        if count:
            from_origin = at.corners - np.repeat(at.origins[:count], np.diff(self.starts), axis=0)
            distances = np.linalg.norm(from_origin, axis=1)
            arms[:count] = np.maximum.reduceat(distances, self.starts[:-1])
        return arms

    def batches(
        self, first: np.ndarray, second: np.ndarray, at: Positions
    ) -> Iterator[tuple[np.ndarray, Solids, Solids]]:
        """Numbers of pairs, with their polyhedra or cylinders of equal form."""
        kinds = self._form[first] * len(self.hulls) + self._form[second]
        for kind in np.unique(kinds):
            pairs = np.flatnonzero(kinds == kind)
            yield pairs, self.solids(first[pairs], at), self.solids(second[pairs], at)

    def solids(self, hulls: np.ndarray, at: Positions) -> Solids:
        """Corners of some hulls of equal form."""
        count = self.starts[hulls[0] + 1] - self.starts[hulls[0]]
        corners = at.corners[self.starts[hulls][:, None] + np.arange(count)]
        if self.flat_ends[hulls[0]]:
            return Cylinders(corners, at.radii[hulls])
        return Polyhedra(corners, self._forms[self._form[hulls[0]]])

    def equal_forms(self, hulls: np.ndarray) -> Iterator[np.ndarray]:
        """The hulls of each form."""
        for form in np.unique(self._form[hulls]):
            yield hulls[self._form[hulls] == form]

    def terrain(self, number: int, at: Positions) -> Terrain:
        """A terrain; the same object while it does not move."""
        corners, last = self.corners_of(number, at), self._last_terrain.get(number)
        if last is None or not np.array_equal(last.corners, corners):
            last = self._last_terrain[number] = Terrain(corners, self._surfaces[number])
        return last

    def corners_of(self, number: int, at: Positions) -> np.ndarray:
        """(c, 3) corners of a hull."""
        return at.corners[self.starts[number] : self.starts[number + 1]]

    def polygons(self, hulls: np.ndarray, at: Positions) -> Polygons:
        """Corners of some hulls."""
        counts = self.starts[hulls + 1] - self.starts[hulls]
        number = np.minimum(np.arange(counts.max()), counts[:, None] - 1)
        corners = at.corners[self.starts[hulls][:, None] + number]
        return Polygons.of(corners[..., :2], counts)

    def columns(self, pairs: Pairs) -> list[FeatureColumns]:
        """Arguments of the gap function of some pairs: those of the features of each body."""
        counts = point_counts(pairs.feature, self.dimension)
        columns = []
        for count, shape, feature in self._sides(pairs, counts):
            if shape is pairs.first and pairs.feature in WALLS:
                columns.append(FeatureColumns(shape, wall=shape - len(self.hulls)))
                continue
            corners, start, sharp = self._corners_of(count, shape, feature), None, None
            if count == RIM_POINTS:
                start = sector_directions(feature % SECTORS)
            if count == 1 and self._has_flat_ends:  # points on the rims of cylinders
                sharp = self.flat_ends[shape]
            columns.append(FeatureColumns(shape, None, corners, start, sharp))
        return columns

    def entries(self, pairs: Pairs) -> list[np.ndarray]:
        """Numbers of the same entries in the formulas."""
        counts, columns, numbers = point_counts(pairs.feature, self.dimension), [], self.numbers
        for count, shape, feature in self._sides(pairs, counts):
            if shape is pairs.first and pairs.feature in WALLS:
                points = numbers.walls(shape)
            else:
                points = numbers.corners(self._corners_of(count, shape, feature))
            if count == RIM_POINTS:
                points = np.hstack([points, numbers.sectors(feature % SECTORS)])
            radius, origin = numbers.radii(shape), numbers.origins(shape)
            if count == 1:
                radius = np.where(self.flat_ends[shape][:, None], numbers.zero, radius)
            columns.append(np.hstack([points, radius, origin]))
        return columns

    @staticmethod
    def _sides(pairs: Pairs, counts: tuple[int, int]) -> list[tuple[int, np.ndarray, np.ndarray]]:
        """Number of points, shapes and features of both sides."""
        return [(counts[0], pairs.first, pairs.own), (counts[1], pairs.second, pairs.other)]

    def face_gaps(self, first: int, second: int) -> np.ndarray:
        """(4, n) numbers of the hulls, of each face of the first and each corner of the second;
        none of walls."""
        if max(first, second) >= len(self.hulls):
            return np.zeros((4, 0), dtype=int)
        hull, other = self.hulls[first], self.hulls[second]
        count = len(hull.edges if self.dimension == 2 else hull.faces)
        face, corner = np.indices((count, len(other.corners))).reshape(2, -1)
        return np.stack([np.full_like(face, first), np.full_like(face, second), face, corner])

    def _corners_of(self, count: int, shape: np.ndarray, feature: np.ndarray) -> np.ndarray:
        """(n, k) corners of corners, edges, faces or rims; the second half of edges is reversed."""
        if count == 1:
            return (self.starts[shape] + feature)[:, None]
        if count == 3:
            return self._faces[self._face_starts[shape] + feature]
        if count == RIM_POINTS:
            end = feature // SECTORS
            own = np.stack([end, 1 - end, 2 + MARKS * end], axis=1)
            return self.starts[shape][:, None] + own
        edges = self._edge_starts[shape + 1] - self._edge_starts[shape]
        ends = self._edges[self._edge_starts[shape] + feature % edges]
        return np.where((feature >= edges)[:, None], ends[:, ::-1], ends)


def _first_equal(keys: list[Any]) -> np.ndarray:
    """Number of the first equal key, for each key."""
    first: dict[Any, int] = {}
    return np.array([first.setdefault(key, k) for k, key in enumerate(keys)])


def _in_space(vector: ca.SX) -> ca.SX:
    return vector if vector.numel() == 3 else ca.vertcat(vector, 0)
