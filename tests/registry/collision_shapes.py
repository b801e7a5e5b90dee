"""Shapes of collisions, each with the corners and the radius of its convex hull in numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from dalembert import planar, spatial

WALL = 100.0
"""Half-width of the square or cube that stands for a wall in numbers."""


@dataclass(frozen=True)
class CollisionShape:
    """A shape on a body, and its hull in numbers, in the frame of the body.

    A ``disc`` (3,), a vector as long as its radius, is added to the corners: those of the axis of a
    cylinder.
    """

    build: Callable
    corners: np.ndarray
    radius: float = 0.0
    disc: np.ndarray | None = None

    def farthest(self, directions: np.ndarray) -> np.ndarray:
        """(n,) largest coordinates along unit vectors (n, d), without the radius."""
        farthest: np.ndarray = (self.corners @ directions.T).max(axis=0)
        if self.disc is None:
            return farthest
        radius = np.linalg.norm(self.disc)
        along = directions @ self.disc / radius
        return farthest + radius * np.sqrt(np.maximum(1 - along**2, 0))


def _corners(*rows: tuple[float, ...]) -> np.ndarray:
    return np.array(rows, dtype=float)


flat, solid = planar.contact, spatial.contact
TRIANGLE = [(-0.15, -0.1), (0.2, -0.05), (0.0, 0.2)]
PLANAR = {
    "Vertex": CollisionShape(lambda b: flat.Vertex(b.point(0.1, 0.05)), _corners((0.1, 0.05))),
    "Circle": CollisionShape(
        lambda b: flat.Circle(b.point(0.1, 0.0), 0.12), _corners((0.1, 0.0)), 0.12
    ),
    "Capsule": CollisionShape(
        lambda b: flat.Capsule(b.point(-0.2, 0.0), b.point(0.1, 0.1), 0.07),
        _corners((-0.2, 0.0), (0.1, 0.1)),
        0.07,
    ),
    "Rectangle": CollisionShape(
        lambda b: flat.Rectangle(b.point(0.05, 0.0), (0.3, 0.2)),
        _corners((-0.1, -0.1), (0.2, -0.1), (0.2, 0.1), (-0.1, 0.1)),
    ),
    "Polygon": CollisionShape(lambda b: flat.Polygon(b, TRIANGLE), _corners(*TRIANGLE)),
    "HalfPlane": CollisionShape(
        lambda b: flat.HalfPlane(b.center, (0.0, 1.0)),
        _corners((-WALL, 0.0), (WALL, 0.0), (WALL, -WALL), (-WALL, -WALL)),
    ),
}
PYRAMID = [(-1.5, -1, -1), (1.5, -1, -1), (1.5, 1, -1), (-1.5, 1, -1), (0.2, 0.1, 1.5)]
SPATIAL = {
    "Vertex": CollisionShape(
        lambda b: solid.Vertex(b.point(0.1, 0.05, 0.0)), _corners((0.1, 0.05, 0.0))
    ),
    "Sphere": CollisionShape(
        lambda b: solid.Sphere(b.point(0.1, 0.0, 0.05), 0.12), _corners((0.1, 0.0, 0.05)), 0.12
    ),
    "Capsule": CollisionShape(
        lambda b: solid.Capsule(b.point(-0.2, 0.0, 0.0), b.point(0.1, 0.1, 0.05), 0.07),
        _corners((-0.2, 0.0, 0.0), (0.1, 0.1, 0.05)),
        0.07,
    ),
    "Box": CollisionShape(
        lambda b: solid.Box(b.point(0.05, 0.0, 0.0), (0.3, 0.2, 0.1)),
        np.array([0.05, 0.0, 0.0])
        + np.array(list(product((-0.5, 0.5), repeat=3))) * [0.3, 0.2, 0.1],
    ),
    "Cylinder": CollisionShape(
        lambda b: solid.Cylinder(b.point(-0.1, 0.0, 0.02), b.point(0.1, 0.1, 0.02), 0.09),
        _corners((-0.1, 0.0, 0.02), (0.1, 0.1, 0.02)),
        disc=0.09 * np.array([2.0, 1.0, 0.0]) / np.sqrt(5),
    ),
    "Polyhedron": CollisionShape(
        lambda b: solid.Polyhedron(b, PYRAMID, scale=0.1), 0.1 * np.array(PYRAMID)
    ),
    "HalfSpace": CollisionShape(
        lambda b: solid.HalfSpace(b.frame()),
        np.array(list(product((-WALL, WALL), (-WALL, WALL), (-WALL, 0.0)))),
    ),
}
SHAPES = {2: PLANAR, 3: SPATIAL}
"""Dimension → name → shape."""
WALLS = {"HalfPlane", "HalfSpace"}
PAIRS = [
    (dimension, i, j)
    for dimension, shapes in SHAPES.items()
    for k, i in enumerate(shapes)
    for j in list(shapes)[k:]
    if not {i, j} <= WALLS and (i, j) != ("Vertex", "Vertex")
]
"""Dimension and names of all pairs of shapes that may touch."""
