"""Cylinders in numbers."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dalembert.elements.contact.hull import MARKS

SECTORS = 32
"""Parts of a rim, from whose middles Newton's method for an angle starts."""

LEVEL, SLANTED = 1e-12, 0.9
"""Sine of the angle of a rim and a plane below which all points of the rim are the lowest, and one
in a fixed direction counts: normal to x, or to y where the component of the axis is above this."""


@dataclass(frozen=True, eq=False)
class Cylinders:
    """Ends of the axes and points on the rims (m, c, 3), and radii (m,), of m cylinders."""

    corners: np.ndarray
    radii: np.ndarray

    @cached_property
    def center(self) -> np.ndarray:
        """(m, 3)"""
        return self.corners[:, :2].mean(axis=1)

    @cached_property
    def ends(self) -> np.ndarray:
        """(m, 2, 3) centres of the ends."""
        return self.corners[:, :2]

    @cached_property
    def half(self) -> np.ndarray:
        """(m,) half lengths."""
        return np.linalg.norm(self.corners[:, 0] - self.corners[:, 1], axis=1) / 2

    @cached_property
    def outward(self) -> np.ndarray:
        """(m, 2, 3) unit vectors along the axis, out of each end."""
        axis = (self.corners[:, 0] - self.center) / self.half[:, None]
        return np.stack([axis, -axis], axis=1)

    @cached_property
    def sides(self) -> np.ndarray:
        """(m, 2, 2, 3) two unit vectors in the plane of each end, from the first of which angles
        are measured."""
        first = self.corners[:, 2::MARKS] - self.ends
        first = first / self.radii[:, None, None]
        return np.stack([first, np.cross(self.outward, first)], axis=2)

    @cached_property
    def marks(self) -> np.ndarray:
        """(m, 2, MARKS, 3) points on the rims."""
        return self.corners[:, 2:].reshape(-1, 2, MARKS, 3)

    def some(self, selected: np.ndarray) -> Cylinders:
        """The selected cylinders."""
        return Cylinders(self.corners[selected], self.radii[selected])

    def farthest(self, normals: np.ndarray) -> np.ndarray:
        """(m, k) largest coordinates along unit vectors (m, k, 3)."""
        along = np.abs((normals @ self.outward[:, 0, :, None])[..., 0])
        across = np.sqrt(np.maximum(1 - along**2, 0.0))
        middle = (normals @ self.center[:, :, None])[..., 0]
        farthest: np.ndarray = middle + self.half[:, None] * along + self.radii[:, None] * across
        return farthest

    def lowest(self, normals: np.ndarray) -> np.ndarray:
        """(m, 2, 3) points of both rims farthest against unit vectors (m, 3); any point of rims
        across these."""
        axis = self.outward[:, 0]
        across = normals - (normals * axis).sum(axis=1, keepdims=True) * axis
        length = np.linalg.norm(across, axis=1, keepdims=True)
        other = np.where(np.abs(axis[:, :1]) < SLANTED, np.eye(3)[0], np.eye(3)[1])
        level = other - (other * axis).sum(axis=1, keepdims=True) * axis
        across = np.where(length > LEVEL, across, level)
        across /= np.linalg.norm(across, axis=1, keepdims=True)
        across -= (across * axis).sum(axis=1, keepdims=True) * axis
        points: np.ndarray = self.ends - (self.radii[:, None] * across)[:, None]
        return points

    def outside(self, end: np.ndarray, points: np.ndarray, normals: np.ndarray) -> np.ndarray:
        """(m,) smaller component of normals (m, 3) along the two normals of the rim of an end at
        points (m, 3); positive between them."""
        row = np.arange(end.size)
        axis, away = self.outward[row, end], points - self.ends[row, end]
        radial = (away * normals).sum(axis=1) / self.radii
        smaller: np.ndarray = np.minimum((axis * normals).sum(axis=1), radial)
        return smaller

    def depths(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(m, k) distances of places (m, k, 3) over the nearer end and beside the round side,
        negative inside, and numbers of the nearer ends."""
        relative = places - self.center[:, None]
        height = (relative @ self.outward[:, 0, :, None])[..., 0]
        across = relative - height[..., None] * self.outward[:, None, 0]
        beside = np.linalg.norm(across, axis=2) - self.radii[:, None]
        return np.abs(height) - self.half[:, None], beside, (height < 0).astype(int)


def sector_directions(sectors: np.ndarray) -> np.ndarray:
    """(n, 3) directions of the middles of sectors: cosine, sine and zero."""
    angles = 2 * np.pi / SECTORS * sectors
    return np.stack([np.cos(angles), np.sin(angles), 0 * angles], axis=1)
