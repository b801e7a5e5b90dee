"""Motion-capture markers of C3D files (c3d.org, user guide 2008) by the optional package ezc3d."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
"""Unit of the points of a file → factor to metres."""


def read_markers(path: Path) -> dict[str, np.ndarray]:
    """``time`` [s], and ``MARKER.x``, ``.y``, ``.z`` [m] of every marker; NaN where it is hidden.

    Raises
    ------
    AnalysisError
        The file is missing, not C3D, or has points in another unit.
    UnsupportedError
        ezc3d is not installed.
    """
    try:
        import ezc3d
    except ImportError:
        raise UnsupportedError(
            f"{path}: markers need ezc3d: pip install 'dalembert[c3d]'"
        ) from None
    try:
        file = ezc3d.c3d(str(path))
    except (OSError, RuntimeError, ValueError, IndexError) as error:
        raise AnalysisError(f"{path}: cannot be read as C3D ({error})") from None
    point_group = file["parameters"]["POINT"]
    labels = [str(name).strip() for name in point_group["LABELS"]["value"]]
    points = np.asarray(file["data"]["points"], dtype=float)  # (x y z 1, marker, frame)
    if not labels or points.shape[2] == 0:
        raise AnalysisError(f"{path}: has no markers")
    scale, rate = _unit_factor(path, point_group), float(file["header"]["points"]["frame_rate"])
    visible = np.asarray(file["data"]["meta_points"]["residuals"], dtype=float)[0] >= 0
    positions = np.where(visible & np.isfinite(points[:3]).all(axis=0), points[:3] * scale, np.nan)
    columns = {"time": np.arange(points.shape[2]) / rate}
    for k, label in enumerate(labels):
        columns |= {f"{label}.{axis}": positions[i, k] for i, axis in enumerate("xyz")}
    return columns


def _unit_factor(path: Path, point_group: Any) -> float:
    unit = (
        str(next(iter(point_group["UNITS"]["value"]), "mm")).strip()
        if "UNITS" in point_group
        else "mm"
    )
    if unit not in METRES:
        raise AnalysisError(f"{path}: points in {unit!r}; known units: {', '.join(METRES)}")
    return METRES[unit]
