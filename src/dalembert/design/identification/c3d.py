"""Markers of motion capture in C3D files, read by ezc3d, an extra (c3d.org, user guide 2008)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError

METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
"""Unit of the points of a file → its size."""


def read_markers(path: Path) -> dict[str, np.ndarray]:
    """``time`` [s], and ``MARKER.x``, ``.y``, ``.z`` [m] of every marker; NaN where it is not seen.

    Raises
    ------
    AnalysisError
        No such file, not C3D, or points in another unit.
    UnsupportedError
        ezc3d is not there.
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
    about = file["parameters"]["POINT"]
    labels = [str(name).strip() for name in about["LABELS"]["value"]]
    points = np.asarray(file["data"]["points"], dtype=float)  # (x y z 1, marker, frame)
    if not labels or points.shape[2] == 0:
        raise AnalysisError(f"{path}: has no markers")
    size, rate = _unit(path, about), float(file["header"]["points"]["frame_rate"])
    seen = np.asarray(file["data"]["meta_points"]["residuals"], dtype=float)[0] >= 0
    places = np.where(seen & np.isfinite(points[:3]).all(axis=0), points[:3] * size, np.nan)
    made = {"time": np.arange(points.shape[2]) / rate}
    for k, label in enumerate(labels):
        made |= {f"{label}.{axis}": places[i, k] for i, axis in enumerate("xyz")}
    return made


def _unit(path: Path, about: Any) -> float:
    given = str(next(iter(about["UNITS"]["value"]), "mm")).strip() if "UNITS" in about else "mm"
    if given not in METRES:
        raise AnalysisError(f"{path}: points in {given!r}; known units: {', '.join(METRES)}")
    return METRES[given]
