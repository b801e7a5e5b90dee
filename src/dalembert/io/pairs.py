"""Files of two columns: tables of laws and points of curves."""

from __future__ import annotations

import csv
from pathlib import Path

from dalembert.errors import FileError
from dalembert.files import read_text


def read_pairs(path: Path) -> list[tuple[float, float]]:
    """The rows of a CSV file with two columns; a heading line and ``#`` comments are allowed.

    Raises
    ------
    FileError
        The file cannot be read, or a line is not two numbers (its number is told).
    """
    rows: list[tuple[float, float]] = []
    try:
        for number, row in enumerate(csv.reader(read_text(path).splitlines()), 1):
            if not row or not "".join(row).strip() or row[0].lstrip().startswith("#"):
                continue
            pair = _numbers(row)
            if pair is not None:
                rows.append(pair)
            elif rows or number > 1:
                raise FileError(
                    f"{path}: line {number}: expected two numbers, got {','.join(row)[:60]!r}"
                )
    except csv.Error as error:
        raise FileError(f"{path}: not a CSV file ({error})") from None
    if not rows:
        raise FileError(f"{path}: no rows of two numbers found")
    return rows


def _numbers(row: list[str]) -> tuple[float, float] | None:
    try:
        first, second = (float(text) for text in row)
    except ValueError:
        return None
    return first, second
