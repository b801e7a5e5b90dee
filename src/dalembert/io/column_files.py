"""Columns of files with measured motion: CSV, Parquet and C3D."""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError, FileError
from dalembert.files import read_text, readable
from dalembert.packages import optional_package

PARQUET, MARKERS = ".parquet", ".c3d"
WEIGHT = 20
"""Memory per byte of a file while it is read [bytes]."""
DELIMITERS = (";", "\t", ",")
"""Separators of columns; a file with semicolons or tabs may have decimal commas."""
LISTED = 5
"""Number of rows without a value that a message lists."""

Columns = dict[str, tuple[str, list[float]]]
"""Name → unit and values; not a number where the file has no value."""


def read_columns(path: Path) -> Columns:
    """Name → unit and values of each column; a heading reads ``stroke [mm]``.

    Columns of a CSV file without a heading are ``1``, ``2`` and so on, and its lines that begin
    with ``#`` are comments. A C3D file has ``time`` [s] and ``MARKER.x``, ``.y``, ``.z`` [m].

    Raises
    ------
    FileError
        The file cannot be read, has no rows, an entry is no number, a row has no value, or names
        repeat; states row and column.
    UnsupportedError
        The package that reads the format is not installed.
    """
    suffix = path.suffix.lower()
    if suffix == PARQUET:
        return _parquet(path)
    if suffix == MARKERS:
        from dalembert.design.identification.data_table import read_markers

        readable(path, WEIGHT)
        try:
            columns = read_markers(path)
        except AnalysisError as error:
            raise FileError(str(error)) from None
        return {
            name: ("s" if name == "time" else "m", values.tolist())
            for name, values in columns.items()
        }
    return _csv(path)


def check_gaps(path: Path, columns: Mapping[str, Sequence[float]]) -> None:
    """Refuse columns with rows without a value.

    Raises
    ------
    FileError
        Names column and rows; the first row of numbers is 1.
    """
    for name, values in columns.items():
        gaps = np.flatnonzero(~np.isfinite(np.asarray(values, dtype=float))) + 1
        if len(gaps):
            rows = ", ".join(map(str, gaps[:LISTED])) + (", …" if len(gaps) > LISTED else "")
            raise FileError(
                f"{path}: column {name!r} has no value in {len(gaps)} of {len(values)} rows "
                f"({rows}); fill the gaps, or cut the file to rows without gaps"
            )


def _csv(path: Path) -> Columns:
    heading: list[str] = []
    rows: list[list[float]] = []
    text = read_text(path)
    delimiter = _delimiter(text)
    try:
        for number, row in enumerate(csv.reader(text.splitlines(), delimiter=delimiter), 1):
            if not "".join(row).strip() or row[0].lstrip().startswith("#"):
                continue
            try:
                values = [_number(entry, delimiter) for entry in row]
            except ValueError:
                if rows or heading:
                    line = delimiter.join(row)[:60]
                    raise FileError(
                        f"{path}: line {number}: expected numbers, got {line!r}"
                    ) from None
                heading = [entry.strip() for entry in row]
                continue
            if len(values) != len(heading or (rows[0] if rows else values)):
                raise FileError(
                    f"{path}: line {number}: has {len(values)} columns, unlike the lines before; "
                    "decimal commas need semicolons between columns"
                )
            rows.append(values)
    except csv.Error as error:
        raise FileError(f"{path}: not a CSV file ({error})") from None
    if not rows:
        raise FileError(f"{path}: has no rows of numbers")
    names = heading or [str(k + 1) for k in range(len(rows[0]))]
    return _named(path, list(zip(names, zip(*rows, strict=True), strict=True)))


def _delimiter(text: str) -> str:
    """The separator of columns, by the first line that is no comment."""
    lines = (line for line in text.splitlines() if line.strip() and line.lstrip()[0] != "#")
    first = re.sub(r'"[^"]*"|\[[^\]]*\]', "", next(lines, ""))
    return next((mark for mark in DELIMITERS if mark in first), ",")


def _number(entry: str, delimiter: str) -> float:
    """The number of an entry, not a number for an empty one."""
    entry = entry.strip()
    if delimiter != "," and entry.count(",") == 1 and "." not in entry:
        entry = entry.replace(",", ".")
    return float(entry) if entry else float("nan")


def _parquet(path: Path) -> Columns:
    parquet = optional_package("pyarrow.parquet", f"reading {path}", "convert it to CSV")
    readable(path, WEIGHT)
    try:
        table = parquet.read_table(path)
    except Exception as error:  # pyarrow raises errors of many types for damaged files
        reason = (str(error) or type(error).__name__).partition("\n")[0][:200]
        raise FileError(f"{path}: cannot be read as Parquet ({reason})") from None
    columns = []
    for name, column in zip(table.column_names, table.columns, strict=True):
        kind = str(column.type)
        if kind.startswith(("int", "uint", "float", "double", "halffloat")):
            values = [float("nan") if x is None else float(x) for x in column.to_pylist()]
            columns.append((name, values))
    if not columns or not len(table):
        raise FileError(f"{path}: has no rows of numbers")
    return _named(path, columns)


def _named(path: Path, columns: Sequence[tuple[str, Sequence[Any]]]) -> Columns:
    """Columns by their names, with the units of their headings."""
    result: Columns = {}
    for heading, values in columns:
        match = re.fullmatch(r"(.*?)\s*(?:\[(.*)\])?", heading, re.DOTALL)
        assert match is not None
        if match[1] in result:
            raise FileError(f"{path}: two columns are named {match[1]!r}")
        result[match[1]] = (match[2] or "", list(values))
    return result
