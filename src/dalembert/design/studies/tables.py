"""Table formats of a study: Parquet if pyarrow is installed, otherwise CSV."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.files.atomic import atomic_path

CSV_NOTE = "the table is CSV, because pyarrow is not installed: pip install 'dalembert[study]'"


class TableFormat(Protocol):
    """Format of a table file that is written atomically."""

    suffix: str
    note: str
    """Remark on the choice of the format."""

    def write(self, columns: Mapping[str, Any], target: Path) -> None:
        """Write columns of integers, numbers (NaN if missing) and texts."""
        ...

    def read(self, path: Path, numbers: list[str]) -> dict[str, list[Any]]:
        """Read columns: ``design`` as integers, ``numbers`` as numbers, others as texts."""
        ...


class Parquet:
    """Apache Parquet, through pyarrow."""

    suffix = ".parquet"
    note = ""

    def write(self, columns: Mapping[str, Any], target: Path) -> None:
        import pyarrow as arrow
        import pyarrow.parquet as parquet

        arrays = {}
        for name, values in columns.items():
            column = np.asarray(values)
            if column.dtype.kind == "f":  # NaN as null, so that equal tables compare equal
                arrays[name] = arrow.array(column.astype(float), from_pandas=True)
            else:
                arrow_type = arrow.int64() if column.dtype.kind == "i" else arrow.string()
                arrays[name] = arrow.array(column.tolist(), arrow_type)
        with atomic_path(target) as path:
            parquet.write_table(arrow.table(arrays), path, write_page_checksum=True)

    def read(self, path: Path, numbers: list[str]) -> dict[str, list[Any]]:
        import pyarrow.parquet as parquet

        table = parquet.read_table(path, page_checksum_verification=True)
        return {
            name: table[name].to_numpy().tolist() if name in numbers else table[name].to_pylist()
            for name in table.column_names
        }


class Csv:
    """Comma-separated values; numbers have all digits, NaN is an empty cell."""

    suffix = ".csv"
    note = CSV_NOTE

    def write(self, columns: Mapping[str, Any], target: Path) -> None:
        cells = [[_cell(value) for value in np.asarray(c).tolist()] for c in columns.values()]
        with atomic_path(target) as path, path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(columns)
            writer.writerows(zip(*cells, strict=True))

    def read(self, path: Path, numbers: list[str]) -> dict[str, list[Any]]:
        with path.open(newline="", encoding="utf-8") as file:
            head, *rows = csv.reader(file, strict=True)
        columns: dict[str, list[Any]] = {
            name: list(column) for name, column in zip(head, zip(*rows, strict=True), strict=True)
        }
        for name in numbers:
            columns[name] = [float(cell) if cell else float("nan") for cell in columns[name]]
        columns["design"] = [int(cell) for cell in columns["design"]]
        return columns


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return "" if np.isnan(value) else repr(value)
    return str(value)


def table_format(parts: Path) -> TableFormat:
    """Format of the existing parts; of a new study Parquet, or CSV without pyarrow.

    Raises
    ------
    UnsupportedError
        The parts are Parquet, and pyarrow is not installed.
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
