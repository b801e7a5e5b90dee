"""Positions and orientations as numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

DIGITS = 15
"""Significant digits of computed numbers in a model file."""
SMALL = 1e-15
"""Threshold relative to the largest entry of a vector below which an entry is zero."""


@dataclass(frozen=True, eq=False)
class Pose:
    """A frame in another one.

    Attributes
    ----------
    place : (3,) origin [m]
    axes : (3, 3) axes as columns
    """

    place: np.ndarray = field(default_factory=lambda: np.zeros(3))
    axes: np.ndarray = field(default_factory=lambda: np.eye(3))

    def __matmul__(self, other: Pose) -> Pose:
        """The frame of ``other``, which is in this frame."""
        return Pose(self.at(other.place), self.turned(other.axes))

    @property
    def is_unturned(self) -> bool:
        """Whether its axes are those of the other frame."""
        return bool(np.array_equal(self.axes, np.eye(3)))

    def turned(self, vectors: np.ndarray) -> np.ndarray:
        """Components of vectors, or axes, in the other frame."""
        return vectors if self.is_unturned else self.axes @ vectors

    def at(self, place: np.ndarray) -> np.ndarray:
        """A point in the other frame."""
        return self.place + self.turned(place)

    @property
    def inverse(self) -> Pose:
        """The other frame in this one."""
        axes = self.axes.T
        return Pose(-axes @ self.place, axes)


def tidy(values: Sequence[float] | np.ndarray) -> list[float]:
    """Numbers without digits that come from rounding."""
    array = np.asarray(values, dtype=float)
    limit = SMALL * np.abs(array).max(initial=0.0)
    return [float(f"{x:.{DIGITS}g}") if abs(x) > limit else 0.0 for x in array.ravel().tolist()]


def elementary(axis: int, angle: float) -> np.ndarray:
    """Rotation about a coordinate axis; exact for multiples of a right angle."""
    quarter = angle / (math.pi / 2)
    c, s = math.cos(angle), math.sin(angle)
    if quarter == round(quarter):
        c, s = float(round(c)), float(round(s))
    j, k = (axis + 1) % 3, (axis + 2) % 3
    matrix = np.eye(3)
    matrix[j, j] = matrix[k, k] = c
    matrix[k, j], matrix[j, k] = s, -s
    return matrix


def roll_pitch_yaw(roll: float, pitch: float, yaw: float) -> np.ndarray:
    """Rotation about the fixed x, then y, then z axes."""
    return elementary(2, yaw) @ elementary(1, pitch) @ elementary(0, roll)


def euler_axes(sequence: str, angles: Sequence[float]) -> np.ndarray:
    """Successive rotations; lower case about turned axes, upper case about fixed ones."""
    matrix = np.eye(3)
    for letter, angle in zip(sequence, angles, strict=True):
        turn = elementary("xyz".index(letter.lower()), angle)
        matrix = matrix @ turn if letter.islower() else turn @ matrix
    return matrix


def quaternion_axes(quaternion: Sequence[float]) -> np.ndarray:
    """Axes of a quaternion, scalar first, which is normalised."""
    w, x, y, z = np.asarray(quaternion) / np.linalg.norm(quaternion)
    return np.array(
        [
            [w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z],
        ]
    )


def axis_angle_axes(axis: Sequence[float] | np.ndarray, angle: float) -> np.ndarray:
    """Rotation about a direction."""
    direction = np.asarray(axis) / np.linalg.norm(axis)
    half = angle / 2
    return quaternion_axes([math.cos(half), *(math.sin(half) * direction)])


def axes_to_z(direction: np.ndarray) -> np.ndarray:
    """Axes whose z is along a direction, by the shortest rotation."""
    z = direction / np.linalg.norm(direction)
    axis, cosine = np.cross([0.0, 0.0, 1.0], z), z[2]
    sine = float(np.linalg.norm(axis))
    if sine < SMALL:
        return np.eye(3) if cosine > 0 else np.diag([1.0, -1.0, -1.0])
    return axis_angle_axes(axis, math.atan2(sine, cosine))


def axes_about(axis: np.ndarray) -> np.ndarray:
    """Axes with z along the axis of a joint, and x nearly along a coordinate axis."""
    z = axis / np.linalg.norm(axis)
    helper = np.eye(3)[int(np.argmin(np.abs(z) + np.array([0.0, 1e-9, 2e-9])))]
    x = helper - (helper @ z) * z
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def frame_table(pose: Pose) -> dict[str, Any]:
    """The frame in a model file."""
    table: dict[str, Any] = {"at": tidy(pose.place)}
    if not pose.is_unturned:
        table |= {"axis": tidy(pose.axes[:, 2]), "x": tidy(pose.axes[:, 0])}
    return table


def rotation_table(axes: np.ndarray) -> dict[str, Any]:
    """The orientation in a model file."""
    return {"type": "from_matrix", "rows": [tidy(row) for row in axes]}
