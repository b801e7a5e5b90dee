"""Mass, mass centre and inertia tensor as numbers."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field

import numpy as np

from dalembert.io.imports.robots.pose import Pose, tidy

NOTHING = 1e-15
"""Threshold of moments of inertia below which they are zero [kg m²]."""
NEGLIGIBLE = 1e-12
"""Threshold of products of inertia relative to the largest moment below which they are zero."""


@dataclass(frozen=True, eq=False)
class Inertia:
    """Inertia of a rigid body in a frame.

    Attributes
    ----------
    mass : [kg]
    center : (3,) mass centre [m]
    tensor : (3, 3) about the mass centre [kg m²]
    """

    mass: float = 0.0
    center: np.ndarray = field(default_factory=lambda: np.zeros(3))
    tensor: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))

    def seen_from(self, pose: Pose) -> Inertia:
        """The same inertia in another frame, in which its own frame has this pose."""
        tensor = self.tensor
        if not pose.is_unturned:
            tensor = pose.axes @ tensor @ pose.axes.T
        return Inertia(self.mass, pose.at(self.center), tensor)

    @property
    def moments(self) -> list[float]:
        """``Ixx, Iyy, Izz`` and, unless they are zero, ``Ixy, Iyz, Ixz``."""
        j = self.tensor
        diagonal, products = np.diag(j), np.array([j[0, 1], j[1, 2], j[0, 2]])
        if np.abs(products).max() <= NEGLIGIBLE * np.abs(diagonal).max(initial=0.0):
            return tidy(diagonal)
        return [*tidy(diagonal), *(tidy([p])[0] for p in products)]


def combined(parts: Iterable[Inertia]) -> Inertia:
    """Inertia of rigidly connected bodies."""
    massive = [p for p in parts if p.mass or np.abs(p.tensor).max() > NOTHING]
    if len(massive) == 1:
        return massive[0]
    mass = sum(part.mass for part in massive)
    if not mass:
        return Inertia(0.0, np.zeros(3), sum((p.tensor for p in massive), np.zeros((3, 3))))
    center = sum((part.mass * part.center for part in massive), np.zeros(3)) / mass
    tensor = np.zeros((3, 3))
    for part in massive:
        arm = part.center - center
        tensor += part.tensor + part.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return Inertia(mass, center, tensor)


def violation(tensor: np.ndarray) -> float:
    """Excess of the largest principal moment over the sum of the other two, or a negative moment.

    Relative to the largest moment; not positive for a physical body.
    """
    moments = np.linalg.eigvalsh(tensor)
    largest = np.abs(moments).max(initial=0.0)
    if not largest > NOTHING:
        return 0.0
    return float(max(2 * moments[-1] - moments.sum(), -moments[0]) / largest)


def repaired(tensor: np.ndarray) -> np.ndarray:
    """The tensor with the smallest larger moments that a body can have, about the same axes."""
    moments, axes = np.linalg.eigh(tensor)
    moments = np.maximum(moments, 0.0)
    moments[:2] += max(0.0, 2 * moments[2] - moments.sum()) / 2
    raised: np.ndarray = axes @ np.diag(moments) @ axes.T
    return raised


# moments per unit mass about the centre ----------------------------------------------------------
def box(size: np.ndarray) -> np.ndarray:
    """Box of these lengths."""
    square = np.asarray(size) ** 2
    return np.diag(square.sum() - square) / 12


def ellipsoid(radii: np.ndarray) -> np.ndarray:
    """Ellipsoid; a sphere of three equal radii."""
    square = np.asarray(radii) ** 2
    return np.diag(square.sum() - square) / 5


def cylinder(radius: float, length: float) -> np.ndarray:
    """Cylinder about the z axis."""
    across = radius**2 / 4 + length**2 / 12
    return np.diag([across, across, radius**2 / 2])


def capsule(radius: float, length: float) -> np.ndarray:
    """Cylinder about the z axis with hemispheres beyond its length."""
    tube, ends = length, 4 / 3 * radius
    axial = tube * radius**2 / 2 + ends * 2 / 5 * radius**2
    across = tube * (radius**2 / 4 + length**2 / 12)
    across += ends * (2 / 5 * radius**2 + length**2 / 4 + 3 / 8 * length * radius)
    return np.diag([across, across, axial]) / (tube + ends)


def capsule_volume(radius: float, length: float) -> float:
    """Volume with both hemispheres."""
    return math.pi * radius**2 * (length + 4 / 3 * radius)
