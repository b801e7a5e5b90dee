"""Search for near pairs of balls, and of balls and walls, by a list of neighbours.

The list contains all pairs closer than a margin beyond the reach. It remains valid until two shapes
may have approached each other by that margin (Verlet, Phys. Rev. 159, 1967).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.analysis.nonsmooth.gaps.bounding_balls import near_balls

MARGIN = 0.25
"""Margin of the list, relative to the largest radius [-]."""


@dataclass(frozen=True, eq=False)
class NeighbourList:
    """Pairs closer than ``reach`` at a position.

    Attributes
    ----------
    positions, normals, radii : of the shapes
    reach : upper limit of the gaps [m]
    pairs, walls : (2, n) numbers of two balls, and of a wall and a ball
    """

    positions: np.ndarray
    normals: np.ndarray
    radii: np.ndarray
    reach: float
    pairs: np.ndarray
    walls: np.ndarray

    def contains(
        self, positions: np.ndarray, normals: np.ndarray, radii: np.ndarray, reach: float
    ) -> bool:
        """Whether all pairs within reach at another position are in the list."""
        if not (np.array_equal(normals, self.normals) and np.array_equal(radii, self.radii)):
            return False
        moved = positions - self.positions
        farthest = float(np.sqrt(np.einsum("ij,ij->i", moved, moved).max(initial=0.0)))
        return reach + 2 * farthest <= self.reach


class Neighbours:
    """Near pairs of the balls and walls of one element.

    Parameters
    ----------
    body : number of the body of each ball, then of each wall
    """

    def __init__(self, body: np.ndarray):
        self._body = body
        self._list: NeighbourList | None = None

    def near(
        self, positions: np.ndarray, normals: np.ndarray, radii: np.ndarray, reach: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """(2, n) pairs of balls, and of walls (numbered after the balls) and balls, of different
        bodies, whose gap is within reach."""
        near = self.listed(positions, normals, radii, reach)
        balls, (first, second) = positions[: radii.size], near.pairs
        apart = balls[second] - balls[first]
        distance = np.sqrt(np.einsum("ij,ij->i", apart, apart)) - radii[first] - radii[second]
        wall, ball = near.walls
        normal = normals[wall - radii.size]
        depth = np.einsum("ij,ij->i", normal, positions[ball] - positions[wall]) - radii[ball]
        return near.pairs[:, distance <= reach], near.walls[:, depth <= reach]

    def listed(
        self, positions: np.ndarray, normals: np.ndarray, radii: np.ndarray, reach: float
    ) -> NeighbourList:
        """A list that contains all pairs within reach."""
        shapes = positions, normals, radii
        if self._list is None or not self._list.contains(*shapes, reach):
            wide = reach + MARGIN * float(radii.max(initial=0.0))
            lists = self._pairs(positions, radii, wide), self._walls(*shapes, wide)
            self._list = NeighbourList(*shapes, wide, *lists)
        return self._list

    def _pairs(self, positions: np.ndarray, radii: np.ndarray, reach: float) -> np.ndarray:
        """(2, n) pairs of balls whose gap is within reach, in the order of their numbers."""
        pairs = near_balls(positions[: radii.size], radii, reach)
        return pairs[:, self._body[pairs[0]] != self._body[pairs[1]]]

    def _walls(
        self, positions: np.ndarray, normals: np.ndarray, radii: np.ndarray, reach: float
    ) -> np.ndarray:
        """(2, n) walls (numbered after the balls) and balls whose gap is within reach."""
        balls = radii.size
        depth = normals @ positions[:balls].T - np.sum(normals * positions[balls:], axis=1)[:, None]
        wall, ball = np.nonzero(depth - radii <= reach)
        apart = self._body[balls + wall] != self._body[ball]
        return np.stack([balls + wall[apart], ball[apart]])
