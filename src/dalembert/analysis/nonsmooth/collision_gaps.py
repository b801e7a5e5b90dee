"""Gaps among many balls, with a numerical search for near pairs; all gap sources of a model."""

from __future__ import annotations

import casadi as ca
import numpy as np
import scipy

from dalembert.analysis.nonsmooth.gap_functions import Feature, gap_function
from dalembert.analysis.nonsmooth.gaps import FormulaGaps, GapSource, SymbolicGap
from dalembert.analysis.nonsmooth.hull_gaps import HullGaps
from dalembert.analysis.nonsmooth.joined_gaps import JoinedGaps
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.contact_point import contact_at_wall, contact_of_balls
from dalembert.elements.contact.pairs import APART
from dalembert.elements.contact.unilateral import Unilateral
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel, Matrix, Patterned
from dalembert.symbolic.once import once

SMALLEST = 16
"""Number of columns of the smallest mapped function; larger ones have 2, 4, 8 … times as many."""
TWIST = 6
"""Components of a velocity and an angular velocity."""


class CollisionGaps(GapSource):
    """Gaps of one ``Collisions`` element.

    Velocities of the balls and walls are ``J v``; those at the gaps follow from them by the
    geometry of each pair, ``W = K J``.

    Parameters
    ----------
    model : Model
    element : Collisions
    """

    def __init__(self, model: Model, element: Collisions):
        self.elements, self.width = [element], element.dimension
        e, balls, walls = model.all_equations, element.balls, element.walls
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
        self._velocities = Patterned("velocities", inputs, [ca.jacobian(moving, e.v)])
        columns = [ca.horzcat(*positions), ca.horzcat(*normals) if normals else ca.SX(3, 0)]
        columns = [model.at_ground(ca.densify(c)) if c.numel() else c for c in columns]
        self._symbolic = moving, *columns, radii, coefficients
        outputs = [*columns, ca.densify(radii), coefficients]
        self._geometry = Kernel(ca.Function("geometry", inputs, outputs))
        names = [p.body.name for p in points]
        self._body = np.array([names.index(name) for name in names])
        self._kernels: dict[tuple[bool, int], Kernel] = {}

    def near(
        self, time: float, y: np.ndarray, p: np.ndarray, travels: np.ndarray, width: int
    ) -> Contacts:
        positions, normals, radii, coefficients = self._geometry(time, y, p)
        positions, normals, radii = positions.T, normals.T, radii.ravel()
        velocities = self._velocities(time, y, p)[0]
        moved = (velocities @ travels).reshape(positions.shape[0], TWIST, -1)[:, :3]
        reach = 2 * float(np.linalg.norm(moved, axis=1).max(initial=0.0))
        pairs, wall_pairs = (
            self._pairs(positions, radii, reach),
            self._walls(positions, normals, radii, reach),
        )
        parts = [
            self._evaluate(pairs, positions, radii, None),
            self._evaluate(wall_pairs, positions, radii, normals),
        ]
        distance = np.concatenate([part[0] for part in parts])
        blocks = np.concatenate([part[1] for part in parts])
        first, second = np.hstack([pairs, wall_pairs])
        law = self._laws[self._groups[first], self._groups[second]]
        near = (distance <= reach) & (law != APART)
        first, second = first[near], second[near]
        count = first.size
        laws = coefficients[:, law[near]]
        return Contacts(
            distance[near],
            self._directions(blocks[near], first, second, velocities, width),
            np.zeros((count, width)),
            laws[0],
            laws[1],
            laws[2],
            first * positions.shape[0] + second,
            np.zeros(count, dtype=int),
        )

    def symbolic(self, key: int) -> SymbolicGap:
        moving, positions, normals, radii, coefficients = self._symbolic
        here, there = divmod(key, positions.shape[1])
        wall, balls = here >= radii.numel(), radii.numel()
        own = normals[:, here - balls] if wall else radii[here]
        twists = [moving[k * TWIST : (k + 1) * TWIST] for k in (here, there)]
        distance, directions = _gap_function(self.width, wall)(
            ca.vertcat(positions[:, here], own), ca.vertcat(positions[:, there], radii[there])
        )
        speeds = ca.mtimes(directions, ca.vertcat(*twists))
        law = int(self._laws[self._groups[here], self._groups[there]])
        return SymbolicGap(distance, speeds, *ca.vertsplit(coefficients[:, law]))

    def points(
        self, time: float, y: np.ndarray, p: np.ndarray, keys: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        positions, normals, radii, _ = self._geometry(time, y, p)
        places, directions = super().points(time, y, p, keys)
        balls = radii.size
        for k, key in enumerate(keys):
            here, there = divmod(int(key), positions.shape[1])
            other = np.concatenate([positions[:, there], radii[there], positions[:, there]])
            if here >= balls:
                feature, own = Feature.WALL, [positions[:, here], normals[:, here - balls], [0.0]]
            else:
                feature, own = Feature.CORNERS, [positions[:, here], radii[here]]
            function = gap_function(feature, self.width)
            out = function(np.concatenate([*own, positions[:, here]]), other)
            places[k], directions[k] = out[2].full().ravel(), out[3].full()
        return places, directions

    # search for near pairs ------------------------------------------------------------------
    def _pairs(self, positions: np.ndarray, radii: np.ndarray, reach: float) -> np.ndarray:
        """(2, n) pairs of balls of different bodies whose gap is within reach."""
        if radii.size < 2:
            return np.zeros((2, 0), dtype=int)
        from scipy.spatial import cKDTree

        centers = positions[: radii.size]
        largest = 2 * radii.max() + reach
        first, second = cKDTree(centers).query_pairs(largest, output_type="ndarray").T
        gap = np.linalg.norm(centers[first] - centers[second], axis=1)
        near = gap <= radii[first] + radii[second] + reach
        near &= self._body[first] != self._body[second]
        pairs = np.stack([first[near], second[near]])
        return pairs[:, np.lexsort(pairs[::-1])]

    def _walls(
        self, positions: np.ndarray, normals: np.ndarray, radii: np.ndarray, reach: float
    ) -> np.ndarray:
        """(2, n) walls (numbered after the balls) and balls whose gap is within reach."""
        balls = radii.size
        depth = normals @ positions[:balls].T - np.sum(normals * positions[balls:], axis=1)[:, None]
        wall, ball = np.nonzero(depth - radii <= reach)
        apart = self._body[balls + wall] != self._body[ball]
        return np.stack([balls + wall[apart], ball[apart]])

    # gaps of pairs ---------------------------------------------------------------------------
    def _evaluate(
        self,
        pairs: np.ndarray,
        positions: np.ndarray,
        radii: np.ndarray,
        normals: np.ndarray | None,
    ) -> tuple[np.ndarray, np.ndarray]:
        """(n,) distances and (n, k, 12) derivatives of gap velocities by both twists."""
        count = pairs.shape[1]
        if not count:
            return np.zeros(0), np.zeros((0, self.width, 2 * TWIST))
        size = SMALLEST << max(0, int(np.ceil(np.log2(count / SMALLEST))))
        padded = (
            np.resize(pairs, (2, count)) if size == count else pairs[:, np.arange(size) % count]
        )
        first, second = padded
        if normals is None:
            about = np.vstack([positions[first].T, radii[first]])
        else:
            about = np.vstack([positions[first].T, normals[first - radii.size].T])
        kernel = self._kernel(normals is not None, size)
        distance, blocks = kernel(about, np.vstack([positions[second].T, radii[second]]))
        blocks = blocks.reshape(self.width, 2 * TWIST, size, order="F")
        return distance.ravel()[:count], np.moveaxis(blocks, 2, 0)[:count]

    def _kernel(self, wall: bool, size: int) -> Kernel:
        """Gap function of two balls, or of a wall and a ball, mapped over ``size`` pairs."""
        if (wall, size) not in self._kernels:
            self._kernels[wall, size] = Kernel(_gap_function(self.width, wall).map(size))
        return self._kernels[wall, size]

    def _directions(
        self,
        blocks: np.ndarray,
        first: np.ndarray,
        second: np.ndarray,
        velocities: Matrix,
        width: int,
    ) -> Matrix:
        """``W = K J`` (n width, n_v) of pairs with derivatives ``blocks`` by both twists."""
        if scipy.sparse.issparse(velocities):
            gaps = self._assembled(blocks, first, second, velocities.shape[0], width)
            return scipy.sparse.csr_array(gaps @ velocities)
        twists = velocities.reshape(-1, TWIST, velocities.shape[1])
        directions = np.zeros((first.size, width, velocities.shape[1]))
        directions[:, : self.width] = blocks @ np.hstack([twists[first], twists[second]])
        return directions.reshape(first.size * width, velocities.shape[1])

    def _assembled(
        self, blocks: np.ndarray, first: np.ndarray, second: np.ndarray, entries: int, width: int
    ) -> scipy.sparse.csr_array:
        """``K`` (n width, entries of the twists)."""
        count = first.size
        rows = np.arange(count)[:, None] * width + np.arange(self.width)
        behind = np.arange(TWIST)
        columns = np.hstack([first[:, None] * TWIST + behind, second[:, None] * TWIST + behind])
        row = np.broadcast_to(rows[:, :, None], blocks.shape)
        column = np.broadcast_to(columns[:, None, :], blocks.shape)
        values = (blocks.ravel(), (row.ravel(), column.ravel()))
        return scipy.sparse.csr_array(values, shape=(count * width, entries))


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
    return [_collision_gaps(model, e) for e in elements if isinstance(e, Collisions)]


def _collision_gaps(model: Model, element: Collisions) -> GapSource:
    """Gaps of balls, and of other shapes where there are any."""
    balls = [CollisionGaps(model, element)] if element.balls else []
    hulls = [HullGaps(model, element)] if element.solids else []
    sources: list[GapSource] = [*balls, *hulls]
    return sources[0] if len(sources) == 1 else JoinedGaps(sources)


def _in_space(vector: ca.SX) -> ca.SX:
    return vector if vector.numel() == 3 else ca.vertcat(vector, 0)


def _gap_function(dimension: int, wall: bool) -> ca.Function:
    """``(place and radius, or place and normal; place and radius) → g, ∂u/∂twists``."""
    first, second = ca.SX.sym("first", 6 if wall else 4), ca.SX.sym("second", 4)
    twist = ca.SX.sym("twist", 2 * TWIST)
    here, there = first[:dimension], second[:dimension]
    if wall:
        gap = contact_at_wall(here, first[3 : 3 + dimension], there, second[3])
    else:
        gap = contact_of_balls(here, first[3], there, second[3])
    speed = gap.speeds(
        lambda point: twist[:3] + ca.cross(twist[3:6], point - first[:3]),
        lambda point: twist[6:9] + ca.cross(twist[9:], point - second[:3]),
    )
    directions = ca.densify(ca.jacobian(speed, twist))
    return ca.Function("meeting", [first, second], [gap.distance, directions])
