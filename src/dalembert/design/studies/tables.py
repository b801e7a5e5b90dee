"""File formats of the tables of a study: Parquet where pyarrow is installed, otherwise CSV."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.files import atomic_path

CSV_NOTE = "the table is CSV, because pyarrow is not installed: pip install 'dalembert[study]'"


class TableFormat(Protocol):
    """Named columns in a file that is there whole or not at all."""

    suffix: str
    note: str
    """What users should know about the choice."""

    def write(self, columns: Mapping[str, Any], target: Path) -> None:
        """Write whole numbers, numbers (NaN is none) and texts."""
        ...

    def read(self, path: Path, numbers: list[str]) -> dict[str, list[Any]]:
        """The columns; texts but for ``design`` and those of ``numbers``."""
        ...


class Parquet:
    """Apache Parquet, through pyarrow."""

    suffix = ".parquet"
    note = ""

    def write(self, columns: Mapping[str, Any], target: Path) -> None:
        import pyarrow as arrow
        import pyarrow.parquet as parquet

        made = {}
        for name, values in columns.items():
            column = np.asarray(values)
            if column.dtype.kind == "f":  # null for no number, so that equal tables compare equal
                made[name] = arrow.array(column.astype(float), from_pandas=True)
            else:
                kind = arrow.int64() if column.dtype.kind == "i" else arrow.string()
                made[name] = arrow.array(column.tolist(), kind)
        with atomic_path(target) as path:
            parquet.write_table(arrow.table(made), path, write_page_checksum=True)

    def read(self, path: Path, numbers: list[str]) -> dict[str, list[Any]]:
        import pyarrow.parquet as parquet

        table = parquet.read_table(path, page_checksum_verification=True)
        return {
            name: table[name].to_numpy().tolist() if name in numbers else table[name].to_pylist()
            for name in table.column_names
        }


class Csv:
    """Comma-separated values; numbers have all their digits, no number is an empty cell."""

    suffix = ".csv"
    note = CSV_NOTE

    def write(self, columns: Mapping[str, Any], target: Path) -> None:
        listed = [[_cell(value) for value in np.asarray(c).tolist()] for c in columns.values()]
        with atomic_path(target) as path, path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(columns)
            writer.writerows(zip(*listed, strict=True))

    def read(self, path: Path, numbers: list[str]) -> dict[str, list[Any]]:
        with path.open(newline="", encoding="utf-8") as file:
            head, *rows = csv.reader(file, strict=True)
        found: dict[str, list[Any]] = {
            name: list(column) for name, column in zip(head, zip(*rows, strict=True), strict=True)
        }
        for name in numbers:
            found[name] = [float(cell) if cell else float("nan") for cell in found[name]]
        found["design"] = [int(cell) for cell in found["design"]]
        return found


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return "" if np.isnan(value) else repr(value)
    return str(value)


def table_format(parts: Path) -> TableFormat:
    """The format of the parts that are there; of a new study Parquet, without pyarrow CSV.

    Raises
    ------
    UnsupportedError
        The parts are Parquet, and there is no pyarrow.
    """
    if any(parts.glob("part-*.csv")):
        return Csv()
    try:
        import pyarrow.parquet  # noqa: F401
    except ImportError:
        if any(parts.glob("part-*.parquet")):
            raise UnsupportedError(
                f"{parts}: the answers of this study are Parquet, which needs pyarrow: "
                "pip install 'dalembert[study]'"
            ) from None
        return Csv()
    return Parquet()
