"""Measurements of an identification: stored beside the model file, and their columns."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import DalembertError, FileError
from dalembert.files import atomic_path, readable

MAX_DATA = 30_000_000
"""Upper limit of the size of a file of measurements [bytes]."""
SUFFIXES = (".csv", ".txt")
"""Suffixes of files that a page may store."""
WEIGHT = 10
"""Memory per byte of a table [bytes]."""


def store_measurements(folder: Path, name: str, contents: bytes) -> str:
    """Store a file beside the model; its name there.

    A file with the same contents is used again; others are never replaced: the new file gets a
    number.

    Parameters
    ----------
    folder : of the model file
    name : of the file that was chosen, without a folder
    contents : of the file

    Raises
    ------
    FileError
        No name of a CSV file, too large, or the folder cannot be written.
    AnalysisError
        It is no table; the file is not kept.
    """
    stem, suffix = Path(name).stem, Path(name).suffix
    valid = re.fullmatch(r"\w[\w .()+-]{0,99}", name) and suffix.lower() in SUFFIXES
    if not valid:
        raise FileError(f"{name[:80]!r}: is no name of a table; choose a file such as run.csv")
    if len(contents) > MAX_DATA:
        raise FileError(f"{name}: has more than {MAX_DATA / 1e6:.0f} MB; take fewer samples")
    number, target = 1, folder / name
    while target.exists():
        if target.is_file() and target.read_bytes() == contents:
            return target.name
        number += 1
        target = folder / f"{stem}_{number}{suffix}"
    with atomic_path(target) as temporary:
        temporary.write_bytes(contents)
    try:
        columns_of(target)
    except DalembertError:
        target.unlink()
        raise
    return target.name


def columns_of(path: Path) -> list[dict[str, Any]]:
    """Columns of numbers of a table: name, number of samples, least and greatest value.

    Parameters
    ----------
    path : of a .csv, .txt, .parquet or .c3d file

    Raises
    ------
    FileError, AnalysisError, BudgetError
        The file cannot be read as a table.
    """
    from dalembert.design.identification.data_table import read_table

    readable(path, WEIGHT)
    rows = []
    for name, values in read_table(path).items():
        numbers = values[np.isfinite(values)]
        ends = [float(numbers.min()), float(numbers.max())] if numbers.size else None
        rows.append({"name": name, "samples": int(numbers.size), "range": ends})
    return rows
