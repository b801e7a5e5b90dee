"""Numbers and poses of URDF as texts."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from dalembert.io.exports.mjcf.document import number
from dalembert.io.exports.rigid.chain import Frame


def numbers(values: Iterable[float]) -> str:
    """Numbers with spaces between."""
    return " ".join(number(float(x)) for x in values)


def origin(frame: Frame) -> dict[str, str]:
    """Attributes ``xyz`` and ``rpy``: successive rotations about the fixed axes x, y and z."""
    r = frame.axes
    across = float(np.hypot(r[0, 0], r[1, 0]))
    pitch = float(np.arctan2(-r[2, 0], across))
    if across > 1e-12:
        roll, yaw = float(np.arctan2(r[2, 1], r[2, 2])), float(np.arctan2(r[1, 0], r[0, 0]))
    else:
        roll, yaw = float(np.arctan2(-r[1, 2], r[1, 1])), 0.0
    return {"xyz": numbers(frame.place), "rpy": numbers([roll, pitch, yaw])}
