"""Balls, convex hulls and walls whose contacts are found by the machine code of a step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.bounding_balls import bounding_balls
from dalembert.analysis.nonsmooth.gaps.collision_gaps import CollisionGaps
from dalembert.analysis.nonsmooth.gaps.gap_source import GapSource
from dalembert.analysis.nonsmooth.gaps.hulls.hull_gaps import HullGaps
from dalembert.analysis.nonsmooth.gaps.joined_gaps import SOURCE, JoinedGaps
from dalembert.analysis.nonsmooth.gaps.neighbours import NeighbourList, Neighbours
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.pairs import APART
from dalembert.elements.contact.shapes import Flat, Round
from dalembert.integrators.contact.step_places import ShapePlaces

Laws = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""(n,) numbers of the laws of pairs of shapes."""


@dataclass(frozen=True, eq=False)
class StepShapes:
    """Balls and hulls, then walls, with formulas of their positions.

    Attributes
    ----------
    dimension : 2 or 3
    corners : (3 c,) of all shapes; a ball has its centre and a wall a point
    references, twists : (3 s,) points of the bodies, and (6 s,) velocities there
    normals : (3 w,) of the walls
    constants : radii of the balls and hulls, and coefficients of the laws
    places : (s, 5) int32, by ``ShapePlaces``
    corner_starts : (s + 1,)
    records : forms, by ``Forms``
    axes, most, longest : as in ``FormTables``
    features, offset : number of features of all hulls, and offset of the keys of their contacts
    numbered : number of balls and walls, which are numbered of their own
    hulls : number of shapes before the walls
    law : of pairs of shapes
    """

    dimension: int
    corners: ca.SX
    references: ca.SX
    twists: ca.SX
    normals: ca.SX
    constants: ca.SX
    places: np.ndarray
    corner_starts: np.ndarray
    records: np.ndarray
    axes: int
    most: int
    longest: int
    features: int
    offset: int
    numbered: int
    hulls: int
    owner: np.ndarray
    law: Laws

    @property
    def count(self) -> int:
        """Number of shapes."""
        return len(self.places)

    @property
    def only_balls(self) -> bool:
        """Whether all shapes are balls and walls."""
        return bool((self.places[:, ShapePlaces.NUMBER] >= 0).all())

    def neighbours(self) -> Neighbours:
        """A search for near pairs."""
        return Neighbours(self.owner)

    def sizes(self, corners: np.ndarray, radii: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(s, 3) centres and (h,) radii of bounding balls."""
        centers, largest = bounding_balls(corners, self.corner_starts)
        return centers, largest[: self.hulls] + radii

    def arms(self, corners: np.ndarray, references: np.ndarray) -> np.ndarray:
        """(s,) largest distances of corners from the reference points of their bodies; zero for
        walls."""
        starts = self.corner_starts
        relative = corners - np.repeat(references, np.diff(starts), axis=0)
        arms = np.maximum.reduceat(np.linalg.norm(relative, axis=1), starts[:-1])
        arms[self.hulls :] = 0.0
        return np.ascontiguousarray(arms)

    def touching(self, near: NeighbourList) -> tuple[np.ndarray, np.ndarray]:
        """(2, n) pairs of shapes that may touch, balls and hulls before walls, and (n,) numbers of
        their laws."""
        pairs = np.hstack([near.pairs, near.walls])
        laws = self.law(*pairs)
        return pairs[:, laws != APART], laws[laws != APART]


def step_shapes(source: GapSource) -> StepShapes | None:
    """Shapes of a source of gaps; None unless all are balls, rigid hulls and walls."""
    if isinstance(source, CollisionGaps):
        return _of_balls(source)
    if isinstance(source, HullGaps):
        return _of_hulls(source, None)
    if not isinstance(source, JoinedGaps) or len(source.sources) != 2:
        return None
    balls, hulls = source.sources
    if not (isinstance(balls, CollisionGaps) and isinstance(hulls, HullGaps)):
        return None
    return _of_hulls(hulls, balls)


def _of_balls(source: CollisionGaps) -> StepShapes:
    shapes, walls, balls = source.counts
    geometry = source.formulas.geometry
    places = np.full((shapes, ShapePlaces.size()), -1, dtype=np.int32)
    places[:, ShapePlaces.CORNERS] = places[:, ShapePlaces.NUMBER] = np.arange(shapes)
    return StepShapes(
        dimension=source.dimension,
        corners=geometry[: 3 * shapes],
        references=geometry[: 3 * shapes],
        twists=source.formulas.velocities,
        normals=geometry[3 * shapes : 3 * (shapes + walls)],
        constants=geometry[3 * (shapes + walls) :],
        places=places,
        corner_starts=np.arange(shapes + 1),
        records=np.zeros(1, dtype=np.int32),
        axes=1,
        most=1,
        longest=1,
        features=0,
        offset=0,
        numbered=shapes,
        hulls=balls,
        owner=source.owner,
        law=source.law,
    )


def _of_hulls(source: HullGaps, balls: CollisionGaps | None) -> StepShapes | None:
    geometry, tables = source.geometry, source.geometry.form_tables
    hulls, walls = len(geometry.hulls), len(geometry.shapes) - len(geometry.hulls)
    if (tables.places < 0).any() or geometry.boundaries:
        return None
    if not all(isinstance(carrier, BodyElement) for carrier in geometry.carriers):
        return None
    parts = geometry.numbers.parts(source.formulas.geometry)
    flat = ca.reshape(parts["walls"], 6, walls)
    normals, points = ca.vec(flat[3:, :]), ca.vec(flat[:3, :])
    starts = np.append(geometry.starts, geometry.starts[-1] + 1 + np.arange(walls))
    first = np.cumsum([0, *geometry.feature_counts])
    places = np.full((hulls + walls, ShapePlaces.size()), -1, dtype=np.int32)
    places[:hulls, : tables.places.shape[1]] = tables.places
    places[:, ShapePlaces.CORNERS], places[:, ShapePlaces.FEATURES] = starts[:-1], first[:-1]
    if balls is not None:
        numbered = [isinstance(shape, Round | Flat) for shape in geometry.shapes]
        places[numbered, ShapePlaces.NUMBER] = np.arange(sum(numbered))
    return StepShapes(
        dimension=source.dimension,
        corners=ca.vertcat(parts["corners"], points),
        references=parts["origins"],
        twists=source.formulas.velocities,
        normals=normals,
        constants=ca.vertcat(parts["radii"][:hulls], parts["laws"]),
        places=places,
        corner_starts=starts,
        records=tables.records,
        axes=tables.axes,
        most=tables.most,
        longest=tables.longest,
        features=int(first[-1]),
        offset=0 if balls is None else SOURCE,
        numbered=0 if balls is None else balls.counts[0],
        hulls=hulls,
        owner=geometry.owner,
        law=geometry.law,
    )
