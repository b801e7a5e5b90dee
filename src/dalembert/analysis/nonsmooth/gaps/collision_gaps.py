"""Gaps among many balls, with a numerical search for near pairs; all gap sources of a model."""

from __future__ import annotations

from functools import cache

import casadi as ca
import numpy as np

from dalembert.analysis.nonsmooth.gaps.boundaries.boundary_gaps import BoundaryGaps
from dalembert.analysis.nonsmooth.gaps.configuration import Configuration
from dalembert.analysis.nonsmooth.gaps.gap_functions import Feature, gap_function
from dalembert.analysis.nonsmooth.gaps.gap_source import (
    FormulaGaps,
    GapFormulas,
    GapKind,
    GapSource,
)
from dalembert.analysis.nonsmooth.gaps.hulls.hull_gaps import HullGaps
from dalembert.analysis.nonsmooth.gaps.joined_gaps import JoinedGaps
from dalembert.analysis.nonsmooth.gaps.near_pairs import NearPairs, ShapesAt
from dalembert.analysis.nonsmooth.gaps.neighbours import Neighbours
from dalembert.analysis.nonsmooth.gaps.recent_positions import AHEAD, RecentPositions
from dalembert.analysis.nonsmooth.gaps.shape_velocities import TWIST, ShapeVelocities
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.contact_point import contact_at_wall, contact_of_balls
from dalembert.elements.contact.pairs import APART, COEFFICIENTS
from dalembert.elements.contact.shapes import Round
from dalembert.elements.contact.unilateral import Unilateral
from dalembert.integrators.contact.contact_laws import FIRST, ContactLaws
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.evaluation.mapped_kernel import MappedKernel
from dalembert.symbolic.once import once


class CollisionGaps(GapSource):
    """Gaps of one ``Collisions`` element.

    Velocities of the balls and walls are ``J v``; those at the gaps follow from them by the
    geometry of each pair, ``W = K J``. The gaps at the last position are stored, as a step
    evaluates the same position several times.

    Parameters
    ----------
    model : Model
    element : Collisions

    Attributes
    ----------
    counts : numbers of shapes, of walls and of balls
    owner : (s,) number of the body of each ball, then of each wall
    """

    def __init__(self, model: Model, element: Collisions):
        self.elements, self.groups = [element], element.friction_groups
        self.dimension: int = element.dimension
        e, balls, walls = model.all_equations, element.balls, element.walls
        self.speeds = e.speed_count
        points = [shape.point for shape in (*balls, *walls)]
        positions = [_in_space(p.position.sx) for p in points]
        twists = [
            ca.vertcat(p.body.velocity_at(position), p.body.turning)
            for p, position in zip(points, positions, strict=True)
        ]
        normals = [_in_space(wall.outward) for wall in walls]
        radii = ca.vertcat(*(b.radius.sx for b in balls))
        coefficients = element.coefficients
        self._groups, self._laws = element.group_of([*balls, *walls]), element.laws
        moving, inputs = model.at_ground(ca.vertcat(*twists)), [e.t, e.y, e.p]
        self._velocities = ShapeVelocities(moving, e.v, inputs)
        columns = [ca.horzcat(*positions), ca.horzcat(*normals) if normals else ca.SX(3, 0)]
        columns = [model.at_ground(ca.densify(c)) if c.numel() else c for c in columns]
        self.counts = len(points), len(walls), len(balls)
        formulas = [*(ca.vec(column) for column in columns), radii, ca.vec(coefficients)]
        self.formulas = GapFormulas(ca.vertcat(*formulas), moving)
        outputs = [*columns, ca.densify(radii), coefficients]
        self._geometry = Kernel(ca.Function("geometry", inputs, outputs))
        self._names = np.array([p.body.name for p in points], dtype=object)
        number = {name: k for k, name in enumerate(dict.fromkeys(self._names))}
        self.owner = np.array([number[name] for name in self._names])
        self._neighbours = Neighbours(self.owner)
        self._gaps = [
            MappedKernel(_gap_function(self.dimension, wall, self._turns)) for wall in (False, True)
        ]
        self._points = {
            feature: MappedKernel(gap_function(feature, self.dimension))
            for feature in (Feature.CORNERS, Feature.WALL)
        }
        self._recent = RecentPositions[NearPairs]()

    def near(self, configuration: Configuration, travels: np.ndarray) -> Contacts:
        pairs = self._pairs(configuration)
        reach = 2 * self._velocities.fastest(pairs.shapes.velocities, travels)
        if reach > pairs.reach:
            pairs = self._recent.use(self._within(pairs.shapes, AHEAD * reach))
        return self._contacts(pairs, np.flatnonzero(pairs.distance <= reach))

    def selected(self, configuration: Configuration, keys: np.ndarray) -> Contacts:
        shapes = self._shapes(configuration)
        chosen = np.stack(np.divmod(keys, shapes.positions.shape[0]))
        walls = chosen[0] >= shapes.radii.size
        parts = chosen[:, ~walls], chosen[:, walls]
        pairs = self._evaluated(parts, shapes, np.inf)
        if (walls[:-1] <= walls[1:]).all():  # pairs of balls before those with walls
            return self._contacts(pairs, slice(None))
        order = np.argsort(walls, kind="stable")
        return self._contacts(pairs, np.argsort(order))

    def _contacts(self, pairs: NearPairs, rows: np.ndarray | slice) -> Contacts:
        """Gaps of some rows of the pairs."""
        first, second = pairs.first[rows], pairs.second[rows]
        number = self.law(first, second)
        return Contacts(
            pairs.distance[rows],
            pairs.derivatives.rows(rows),
            np.zeros((number.size, 1 + sum(self.groups))),
            ContactLaws.of(pairs.shapes.coefficients[:, number], self.groups, number),
            self.groups,
            first * pairs.shapes.positions.shape[0] + second,
            np.zeros(number.size, dtype=int),
            moved=pairs.derivatives.moved(rows),
        )

    def deepest(self, configuration: Configuration) -> float:
        return float(self._pairs(configuration).distance.min(initial=0.0))

    def _pairs(self, configuration: Configuration) -> NearPairs:
        """Pairs near each other at a position; stored ones if it is one of the last."""
        pairs, last = self._recent.find(configuration), self._recent.last
        if pairs is None:
            reach = 0.0 if last is None else last.reach
            pairs = self._within(self._shapes(configuration), reach)
        return self._recent.use(pairs)

    def _shapes(self, configuration: Configuration) -> ShapesAt:
        """The shapes at a position."""
        recent = self._recent.find(configuration)
        if recent is not None:
            return recent.shapes
        positions, normals, radii, coefficients = self._geometry(*configuration)
        geometry = positions.T, normals.T, radii.ravel(), coefficients
        return ShapesAt(configuration.copy(), *geometry, self._velocities(*configuration))

    def _within(self, shapes: ShapesAt, reach: float) -> NearPairs:
        """The pairs within reach."""
        geometry = shapes.positions, shapes.normals, shapes.radii
        balls, walls = (self._touching(part) for part in self._neighbours.near(*geometry, reach))
        return self._evaluated((balls, walls), shapes, reach)

    def _evaluated(
        self, parts: tuple[np.ndarray, np.ndarray], shapes: ShapesAt, reach: float
    ) -> NearPairs:
        """Gaps of pairs of balls, and of walls and balls."""
        gaps = [self._evaluate(part, shapes, k == 1) for k, part in enumerate(parts)]
        distance, blocks = (np.concatenate(gap) for gap in zip(*gaps, strict=True))
        first, second = np.hstack(parts)
        derivatives = self._velocities.gap_derivatives(blocks, first, second, shapes.velocities)
        return NearPairs(shapes, reach, first, second, distance, derivatives)

    def law(self, first: np.ndarray, second: np.ndarray) -> np.ndarray:
        """(n,) numbers of the laws of pairs of shapes."""
        numbers: np.ndarray = self._laws[self._groups[first], self._groups[second]]
        return numbers

    def _touching(self, pairs: np.ndarray) -> np.ndarray:
        """(2, m) pairs of shapes whose groups touch each other."""
        return pairs[:, self.law(*pairs) != APART]

    def kinds(self, keys: np.ndarray) -> list[GapKind]:
        (shapes, walls, balls), place = self.counts, np.arange(3)
        first, second = np.divmod(keys, shapes)
        starts = 3 * shapes, 3 * (shapes + walls), 3 * (shapes + walls) + balls
        other = np.column_stack([3 * second[:, None] + place, starts[1] + second])
        twists = TWIST * np.stack([first, second], 1)[..., None] + np.arange(TWIST)
        laws = starts[2] + len(COEFFICIENTS) * self.law(first, second)[:, None]
        laws = laws + np.arange(FIRST + len(self.groups))
        kinds = []
        for wall in (False, True):
            rows = np.flatnonzero((first >= balls) == wall)
            here = first[rows, None]
            own = starts[0] + 3 * (here - balls) + place if wall else starts[1] + here
            arguments = [np.hstack([3 * here + place, own]), other[rows]]
            function = _gap_function(self.dimension, wall, self._turns)
            velocities = twists[rows].reshape(rows.size, 2 * TWIST)
            kinds.append(GapKind(function, rows, arguments, velocities, laws[rows]))
        return [kind for kind in kinds if kind.row.size]

    def points(
        self, configuration: Configuration, keys: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        shapes = self._shapes(configuration)
        places, directions = super().points(configuration, keys)
        first, second = np.divmod(keys, shapes.positions.shape[0])
        walls = first >= shapes.radii.size
        for rows, feature in ((walls, Feature.WALL), (~walls, Feature.CORNERS)):
            here, there = first[rows], second[rows]
            position, other = shapes.positions[here].T, shapes.positions[there].T
            own = [self._own(shapes, here, feature is Feature.WALL)]
            if feature is Feature.WALL:
                own.append(np.zeros((1, here.size)))  # its radius
            radii = shapes.radii[None, there]
            results = self._points[feature]([position, *own, position], [other, radii, other])
            places[rows], directions[rows] = results[2][..., 0], results[3]
        return places, directions

    def bodies(self, keys: np.ndarray) -> np.ndarray:
        names: np.ndarray = self._names[np.stack(np.divmod(keys, self.counts[0]), axis=1)]
        return names

    def _evaluate(
        self, chosen: np.ndarray, shapes: ShapesAt, wall: bool
    ) -> tuple[np.ndarray, np.ndarray]:
        """(n,) distances and (n, k, 12) derivatives of gap velocities by both twists."""
        count, positions, radii = chosen.shape[1], shapes.positions, shapes.radii
        width = 1 + sum(self.groups)
        if not count:
            return np.zeros(0), np.zeros((0, width, 2 * TWIST))
        first, second = chosen
        own = self._own(shapes, first, wall)
        here, there = positions[first].T, positions[second].T
        distance, blocks = self._gaps[wall]([here, own], [there, radii[None, second]])
        return distance.ravel(), blocks

    @staticmethod
    def _own(shapes: ShapesAt, first: np.ndarray, wall: bool) -> np.ndarray:
        """(3, n) normals of walls, or (1, n) radii of balls."""
        balls = shapes.radii.size
        return shapes.normals[first - balls].T if wall else shapes.radii[None, first]

    @property
    def _turns(self) -> bool:
        """Whether there is friction of rotations."""
        return len(self.groups) > 1


@once
def gap_sources(model: Model) -> list[GapSource]:
    """Sources of all gaps of a model."""
    elements = list(model.parts.elements.values())
    unilateral = [e for e in elements if isinstance(e, Unilateral) and e.impact() is not None]
    sources: list[GapSource] = [FormulaGaps(model, unilateral)] if unilateral else []
    return [*sources, *collision_gaps(model)]


@once
def collision_gaps(model: Model) -> list[GapSource]:
    """Sources of the gaps of ``Collisions``."""
    elements = model.parts.elements.values()
    collisions = [e for e in elements if isinstance(e, Collisions)]
    return [_collision_gaps(model, e) for e in collisions if e.hulls or e.boundaries]


def _collision_gaps(model: Model, element: Collisions) -> GapSource:
    """Gaps of balls, of other convex shapes and of boundaries where there are any."""
    shapes = any(not isinstance(shape, Round) for shape, _ in element.hulls)
    hulls = [HullGaps(model, element)] if shapes else []
    boundaries = [BoundaryGaps(model, element)] if element.boundaries else []
    others: list[GapSource] = [*hulls, *boundaries]
    bodies = {ball.point.body.name for ball in element.balls}
    meet = len(bodies) > 1 or (bodies and element.walls)  # balls each other, or walls
    sources = [CollisionGaps(model, element), *others] if meet or not others else others
    return sources[0] if len(sources) == 1 else JoinedGaps(sources)


def _in_space(vector: ca.SX) -> ca.SX:
    return vector if vector.numel() == 3 else ca.vertcat(vector, 0)


@cache
def _gap_function(dimension: int, wall: bool, turns: bool) -> ca.Function:
    """``(place and radius, or place and normal; place and radius) → g, ∂u/∂twists``."""
    first, second = ca.SX.sym("first", 6 if wall else 4), ca.SX.sym("second", 4)
    twist = ca.SX.sym("twist", 2 * TWIST)
    here, there = first[:dimension], second[:dimension]
    if wall:
        gap = contact_at_wall(here, first[3 : 3 + dimension], there, second[3])
    else:
        gap = contact_of_balls(here, first[3], there, second[3])
    speed = gap.surface_speeds(
        lambda point: twist[:3] + ca.cross(twist[3:6], point - first[:3]),
        lambda point: twist[6:9] + ca.cross(twist[9:], point - second[:3]),
        ca.fmax(gap.distance, 0),
    )
    if turns:
        speed = ca.vertcat(speed, gap.turning(twist[3:6], twist[9:]))
    directions = ca.densify(ca.jacobian(speed, twist))
    return ca.Function("meeting", [first, second], [gap.distance, directions])
