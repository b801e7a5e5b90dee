"""Discs, spheres and boxes that fall into a box with friction, in neutral form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

SIZE, MASS, FRICTION, GRAVITY = 0.1, 10.0, 0.3, 9.81
"""Radius, or half the side of a box [m]; mass, coefficient of all contacts, gravity."""
STEP = 1e-3


@dataclass(frozen=True, eq=False)
class FallingBodies:
    """Bodies in rows above the floor of a box.

    Attributes
    ----------
    kind : ``disc``, ``sphere`` or ``box``
    width : of the box along each horizontal axis [m]
    positions, velocities : (n, 2) or (n, 3), the last coordinate upwards [m], [m/s]
    """

    kind: str
    width: float
    positions: np.ndarray
    velocities: np.ndarray

    @classmethod
    def of(cls, kind: str, count: int) -> FallingBodies:
        """As many rows as columns."""
        rng, dimension = np.random.default_rng(1), 2 if kind == "disc" else 3
        columns = max(2, int(np.ceil(count ** (1 / dimension) - 1e-9)))
        width, number = 2.4 * SIZE * columns, np.arange(count)
        places = []
        for _ in range(dimension - 1):
            number, column = np.divmod(number, columns)
            across = (column + 0.5) / columns * width - width / 2
            places.append(across + 0.1 * SIZE * rng.random(count))
        places.append(SIZE * (1.05 + 2.1 * number))
        speeds = 0.3 * rng.normal(size=(count, dimension))
        return cls(kind, width, np.column_stack(places), speeds)

    @property
    def dimension(self) -> int:
        return self.positions.shape[1]

    @property
    def count(self) -> int:
        return len(self.positions)

    @property
    def inertia(self) -> float:
        """About any axis [kg m²]."""
        return {"disc": 1 / 2, "sphere": 2 / 5, "box": 2 / 3}[self.kind] * MASS * SIZE**2

    def walls(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Points and inward normals of the floor and of the sides."""
        axes = np.eye(self.dimension)
        sides = [(-s * self.width / 2 * a, s * a) for a in axes[:-1] for s in (1, -1)]
        return [(np.zeros(self.dimension), axes[-1]), *sides]

    def penetration(self, positions: np.ndarray) -> float:
        """Maximum penetration of discs or spheres at some positions [m]."""
        walls = [SIZE - ((positions - point) @ normal).min() for point, normal in self.walls()]
        pairs = cKDTree(positions).query_pairs(2 * SIZE, output_type="ndarray")
        apart = np.linalg.norm(positions[pairs[:, 0]] - positions[pairs[:, 1]], axis=1)
        return float(max(*walls, 2 * SIZE - apart.min(initial=2 * SIZE), 0.0))
