"""Tables of measurements: columns of numbers from a DataFrame, a mapping or a file."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.design.identification.c3d import read_markers
from dalembert.errors import AnalysisError, ModelError
from dalembert.units.unit import unit

READERS = {".csv": "read_csv", ".txt": "read_csv", ".parquet": "read_parquet"}
"""Ending of a file → what of pandas reads it."""
MARKERS = ".c3d"
"""That of markers of motion capture."""


def read_table(source: Any) -> dict[str, np.ndarray]:
    """Column → numbers, NaN where a sample is missing.

    Parameters
    ----------
    source : pandas or polars DataFrame, mapping of columns, or path of a .csv, .parquet or .c3d
        file

    Raises
    ------
    AnalysisError
        No such file, a file that is none of these, or a table without rows.
    """
    if isinstance(source, (str, Path)):
        source = _file(Path(source))
    if hasattr(source, "to_pandas"):
        source = source.to_pandas()
    if isinstance(source, Mapping):
        columns = dict(_in_si(str(name), values) for name, values in source.items())
    elif hasattr(source, "columns"):
        if source.index.name is not None and source.index.name not in source.columns:
            source = source.reset_index()
        columns = dict(_in_si(str(name), source[name]) for name in source.columns)
    else:
        kind = type(source).__name__
        raise AnalysisError(
            f"data is a {kind}; give a DataFrame, a mapping of columns, or a .csv or .parquet file"
        )
    read = {name: _numbers(values) for name, values in columns.items()}
    found = {name: values for name, values in read.items() if values is not None}
    sizes = {values.size for values in found.values()}
    if len(sizes) > 1:
        told = ", ".join(f"{name}: {values.size}" for name, values in found.items())
        raise AnalysisError(f"the columns of the data differ in length ({told})")
    if not sizes or sizes == {0}:
        raise AnalysisError("the data has no rows of numbers; give at least one sample")
    return found


def _in_si(heading: str, values: Any) -> tuple[str, Any]:
    """The name and values of a column in SI units; a heading may read ``crank.angle [deg]``."""
    named = re.fullmatch(r"(.*\S)\s+\[(.+)\]", heading)
    if named is None:
        return heading, values
    try:
        factor = unit(named[2]).factor
    except ModelError as error:
        raise AnalysisError(f"column {heading!r}: {error.message}") from None
    return named[1], values if factor == 1.0 else np.asarray(values) * factor


def _file(path: Path) -> Any:
    import pandas as pd

    reader = READERS.get(path.suffix.lower())
    if reader is None and path.suffix.lower() != MARKERS:
        known = ", ".join((*READERS, MARKERS))
        raise AnalysisError(f"{path}: is none of {known}; convert it to CSV")
    if not path.is_file():
        raise AnalysisError(f"{path}: there is no such file of data")
    if reader is None:
        return read_markers(path)
    try:
        return getattr(pd, reader)(path)
    except ImportError:
        raise AnalysisError(
            f"{path}: reading Parquet needs pyarrow; 'pip install pyarrow', or give CSV"
        ) from None
    except (ValueError, OSError) as error:  # pandas' own errors of reading are ValueErrors
        raise AnalysisError(f"{path}: cannot be read as a table ({error})") from None


def _numbers(values: Any) -> np.ndarray | None:
    """(K,) numbers of a column, None where it holds something else."""
    try:
        return np.asarray(values, dtype=float).ravel()
    except (TypeError, ValueError):
        return None
