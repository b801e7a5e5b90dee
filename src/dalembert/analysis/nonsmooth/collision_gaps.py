"""Gaps among many balls: who is near whom is found outside the graph, all pairs at once."""

from __future__ import annotations

import casadi as ca
import numpy as np
import scipy

from dalembert.analysis.nonsmooth.gap_source import GapSource, StatedGap
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.contact_point import contact_at_wall, contact_of_balls
from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.model import Model
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.evaluation.patterned import Patterned

SMALLEST = 16
"""Columns of the smallest mapped function; others have twice, four times … as many."""
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
        points = [*(b.center for b in balls), *(w.point for w in walls)]
        places = [_in_space(p.position.sx) for p in points]
        twists = [
            ca.vertcat(p.body.velocity_at(place), p.body.turning)
            for p, place in zip(points, places, strict=True)
        ]
        turned = [_in_space(w.point.body.turned(w.normal)) for w in walls]
        radii = ca.vertcat(*(b.radius.sx for b in balls))
        shares = ca.vertcat(element.restitution.sx, element.tangential.sx, element.friction.sx)
        moving, inputs = model.at_ground(ca.vertcat(*twists)), [e.t, e.y, e.p]
        self._velocities = Patterned("velocities", inputs, [ca.jacobian(moving, e.v)])
        columns = [ca.horzcat(*places), ca.horzcat(*turned) if turned else ca.SX(3, 0)]
        columns = [model.at_ground(ca.densify(c)) if c.numel() else c for c in columns]
        self._stated = moving, *columns, radii, shares
        outputs = [*columns, ca.densify(radii), shares]
        self._places = Kernel(ca.Function("places", inputs, outputs))
        names = [p.body.name for p in points]
        self._body = np.array([names.index(name) for name in names])
        self._kernels: dict[tuple[bool, int], Kernel] = {}

    def near(
        self, time: float, y: np.ndarray, p: np.ndarray, travels: np.ndarray, width: int
    ) -> Contacts:
        places, normals, radii, shares = self._places(time, y, p)
        places, normals, radii = places.T, normals.T, radii.ravel()
        velocities = self._velocities(time, y, p)[0]
        moved = (velocities @ travels).reshape(places.shape[0], TWIST, -1)[:, :3]
        reach = 2 * float(np.linalg.norm(moved, axis=1).max(initial=0.0))
        pairs, against = (
            self._pairs(places, radii, reach),
            self._walls(places, normals, radii, reach),
        )
        parts = [
            self._meet(pairs, places, radii, None),
            self._meet(against, places, radii, normals),
        ]
        distance = np.concatenate([part[0] for part in parts])
        blocks = np.concatenate([part[1] for part in parts])
        first, second = np.hstack([pairs, against])
        count = distance.size
        directions = self._assembled(blocks, first, second, places.shape[0], width)
        same = np.repeat(shares, count, axis=1)
        return Contacts(
            distance,
            scipy.sparse.csr_array(directions @ velocities),
            np.zeros((count, width)),
            same[0],
            same[1],
            same[2],
            first * places.shape[0] + second,
            np.zeros(count, dtype=int),
        ).some(distance <= reach)

    def stated(self, key: int) -> StatedGap:
        moving, places, normals, radii, shares = self._stated
        here, there = divmod(key, places.shape[1])
        wall, balls = here >= radii.numel(), radii.numel()
        own = normals[:, here - balls] if wall else radii[here]
        twists = [moving[k * TWIST : (k + 1) * TWIST] for k in (here, there)]
        distance, directions = _meeting(self.width, wall)(
            ca.vertcat(places[:, here], own), ca.vertcat(places[:, there], radii[there])
        )
        speeds = ca.mtimes(directions, ca.vertcat(*twists))
        return StatedGap(distance, speeds, *ca.vertsplit(shares))

    # who is near whom -----------------------------------------------------------------------
    def _pairs(self, places: np.ndarray, radii: np.ndarray, reach: float) -> np.ndarray:
        """(2, n) balls of different bodies whose gap may be within reach."""
        from scipy.spatial import cKDTree

        centers = places[: radii.size]
        near = 2 * radii.max() + reach
        first, second = cKDTree(centers).query_pairs(near, output_type="ndarray").T
        gap = np.linalg.norm(centers[first] - centers[second], axis=1)
        kept = gap <= radii[first] + radii[second] + reach
        kept &= self._body[first] != self._body[second]
        found = np.stack([first[kept], second[kept]])
        return found[:, np.lexsort(found[::-1])]

    def _walls(
        self, places: np.ndarray, normals: np.ndarray, radii: np.ndarray, reach: float
    ) -> np.ndarray:
        """(2, n) walls, numbered behind the balls, and balls whose gap may be within reach."""
        balls = radii.size
        depth = normals @ places[:balls].T - np.sum(normals * places[balls:], axis=1)[:, None]
        wall, ball = np.nonzero(depth - radii <= reach)
        apart = self._body[balls + wall] != self._body[ball]
        return np.stack([balls + wall[apart], ball[apart]])

    # what pairs do ---------------------------------------------------------------------------
    def _meet(
        self, pairs: np.ndarray, places: np.ndarray, radii: np.ndarray, normals: np.ndarray | None
    ) -> tuple[np.ndarray, np.ndarray]:
        """(n,) distances and (n, k, 12) directions by both velocities."""
        count = pairs.shape[1]
        if not count:
            return np.zeros(0), np.zeros((0, self.width, 2 * TWIST))
        size = SMALLEST << max(0, int(np.ceil(np.log2(count / SMALLEST))))
        padded = (
            np.resize(pairs, (2, count)) if size == count else pairs[:, np.arange(size) % count]
        )
        first, second = padded
        if normals is None:
            about = np.vstack([places[first].T, radii[first]])
        else:
            about = np.vstack([places[first].T, normals[first - radii.size].T])
        kernel = self._kernel(normals is not None, size)
        distance, blocks = kernel(about, np.vstack([places[second].T, radii[second]]))
        blocks = blocks.reshape(self.width, 2 * TWIST, size, order="F")
        return distance.ravel()[:count], np.moveaxis(blocks, 2, 0)[:count]

    def _kernel(self, wall: bool, size: int) -> Kernel:
        """What two balls, or a wall and a ball, do, for so many of them."""
        if (wall, size) not in self._kernels:
            self._kernels[wall, size] = Kernel(_meeting(self.width, wall).map(size))
        return self._kernels[wall, size]

    def _assembled(
        self, blocks: np.ndarray, first: np.ndarray, second: np.ndarray, things: int, width: int
    ) -> scipy.sparse.csr_array:
        """``K`` (n width, 6 things)."""
        count = first.size
        rows = np.arange(count)[:, None] * width + np.arange(self.width)
        behind = np.arange(TWIST)
        columns = np.hstack([first[:, None] * TWIST + behind, second[:, None] * TWIST + behind])
        row = np.broadcast_to(rows[:, :, None], blocks.shape)
        column = np.broadcast_to(columns[:, None, :], blocks.shape)
        entries = (blocks.ravel(), (row.ravel(), column.ravel()))
        return scipy.sparse.csr_array(entries, shape=(count * width, TWIST * things))


def _in_space(vector: ca.SX) -> ca.SX:
    return vector if vector.numel() == 3 else ca.vertcat(vector, 0)


def _meeting(dimension: int, wall: bool) -> ca.Function:
    """``(place and radius, or place and normal; place and radius) → g, ∂u/∂twists``."""
    first, second = ca.SX.sym("first", 6 if wall else 4), ca.SX.sym("second", 4)
    twist = ca.SX.sym("twist", 2 * TWIST)
    here, there = first[:dimension], second[:dimension]
    if wall:
        met = contact_at_wall(here, first[3 : 3 + dimension], there, second[3])
    else:
        met = contact_of_balls(here, first[3], there, second[3])
    speed = met.speeds(
        lambda place: twist[:3] + ca.cross(twist[3:6], place - first[:3]),
        lambda place: twist[6:9] + ca.cross(twist[9:], place - second[:3]),
    )
    directions = ca.densify(ca.jacobian(speed, twist))
    return ca.Function("meeting", [first, second], [met.distance, directions])
