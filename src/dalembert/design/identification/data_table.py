"""Tables of measurements: columns of a DataFrame, a mapping or a file, and C3D markers."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from dalembert.errors import AnalysisError, ModelError
from dalembert.packages import optional_package
from dalembert.units.unit import unit

READERS = {".csv": "read_csv", ".txt": "read_csv", ".parquet": "read_parquet"}
"""File suffix → reader of pandas."""
MARKERS = ".c3d"
"""File suffix of motion-capture markers."""
METRES = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
"""Unit of the points of a file → factor to metres."""


def read_table(source: Any) -> dict[str, np.ndarray]:
    """Column → numbers, NaN for missing samples.

    Parameters
    ----------
    source : pandas or polars DataFrame, mapping of columns, or path of a .csv, .parquet or .c3d
        file

    Raises
    ------
    AnalysisError
        The file is missing or of an unsupported type, or the table is empty.
    """
    if isinstance(source, (str, Path)):
        source = _read_file(Path(source))
    if hasattr(source, "to_pandas"):
        source = source.to_pandas()
    if isinstance(source, Mapping):
        columns = [_in_si(str(name), values) for name, values in source.items()]
    elif hasattr(source, "columns"):
        if source.index.name is not None and source.index.name not in source.columns:
            source = source.reset_index()
        columns = [_in_si(str(name), source[name]) for name in source.columns]
    else:
        type_name = type(source).__name__
        raise AnalysisError(
            f"data is a {type_name}; give a DataFrame, a mapping of columns, or a .csv or .parquet "
            "file"
        )
    numbers = dict(columns)
    numeric = {name: values for name, values in numbers.items() if values is not None}
    sizes = {values.size for values in numeric.values()}
    if len(sizes) > 1:
        lengths = ", ".join(f"{name}: {values.size}" for name, values in numeric.items())
        raise AnalysisError(f"the columns of the data differ in length ({lengths})")
    if not sizes or sizes == {0}:
        raise AnalysisError("the data has no rows of numbers; give at least one sample")
    return numeric


def _in_si(heading: str, values: ArrayLike) -> tuple[str, np.ndarray | None]:
    """Name and numbers of a column in SI units, None if it holds other data.

    Headings may have units, ``crank.angle [deg]``.
    """
    match, numbers = re.fullmatch(r"(.*\S)\s+\[(.+)\]", heading), _numbers(values)
    if match is None:
        return heading, numbers
    try:
        factor = unit(match[2]).factor
    except ModelError as error:
        raise AnalysisError(f"column {heading!r}: {error.message}") from None
    return match[1], numbers if numbers is None or factor == 1.0 else numbers * factor


def _read_file(path: Path) -> Any:
    import pandas as pd

    reader = READERS.get(path.suffix.lower())
    if reader is None and path.suffix.lower() != MARKERS:
        formats = ", ".join((*READERS, MARKERS))
        raise AnalysisError(f"{path}: unsupported type, use one of {formats}; convert it to CSV")
    if not path.is_file():
        raise AnalysisError(f"{path}: the data file does not exist")
    if reader is None:
        return read_markers(path)
    if reader == "read_parquet":
        optional_package("pyarrow", f"reading {path}", "convert it to CSV")
    try:
        if reader == "read_csv":
            return _read_rows(path)
        return pd.read_parquet(path)
    except UnicodeDecodeError as error:
        raise AnalysisError(
            f"{path}: byte {error.start} is not UTF-8 text; save the file as UTF-8"
        ) from None
    except (ValueError, OSError) as error:  # parser errors of pandas are ValueErrors
        raise AnalysisError(f"{path}: cannot be read as a table ({error})") from None


def _read_rows(path: Path) -> Any:
    """Table of a CSV file; rows that end with a separator have no column there.

    Raises
    ------
    AnalysisError
        Rows have more columns than the heading, so that names would belong to other columns.
    """
    import pandas as pd
    from pandas.errors import ParserWarning

    with warnings.catch_warnings():
        warnings.simplefilter("error", ParserWarning)
        try:
            return pd.read_csv(path, index_col=False, **_dialect(path))
        except ParserWarning:
            raise AnalysisError(
                f"{path}: rows have more columns than the heading; name all columns in the first "
                "line"
            ) from None


def _dialect(path: Path) -> dict[str, str]:
    """Options of pandas: semicolons between columns permit decimal commas."""
    with path.open(encoding="utf-8-sig") as stream:
        heading = stream.readline()
    marks = [mark for mark in (";", "\t") if mark in re.sub(r'"[^"]*"|\[[^\]]*\]', "", heading)]
    if not marks:
        return {}
    has_points = re.search(r"\d\.\d", path.read_text(encoding="utf-8-sig")) is not None
    return {"sep": marks[0], "decimal": "." if has_points else ","}


def _numbers(values: ArrayLike) -> np.ndarray | None:
    """(K,) numbers of a column, None if it holds other data."""
    try:
        return np.asarray(values, dtype=float).ravel()
    except (TypeError, ValueError):
        return None


def read_markers(path: Path) -> dict[str, np.ndarray]:
    """``time`` [s], and ``MARKER.x``, ``.y``, ``.z`` [m] of every marker; NaN where it is hidden.

    Raises
    ------
    AnalysisError
        The file is missing, not C3D, or has points in another unit.
    UnsupportedError
        ezc3d is not installed.
    """
    ezc3d = optional_package("ezc3d", f"reading {path}")
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


def _unit_factor(path: Path, point_group: Mapping[str, Any]) -> float:
    unit = (
        str(next(iter(point_group["UNITS"]["value"]), "mm")).strip()
        if "UNITS" in point_group
        else "mm"
    )
    if unit not in METRES:
        raise AnalysisError(f"{path}: points in {unit!r}; known units: {', '.join(METRES)}")
    return METRES[unit]
