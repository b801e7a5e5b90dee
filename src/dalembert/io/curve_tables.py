"""Tables of values in model files: ``[tables.gas]``, for ``interp(x, gas)`` in formulas."""

from __future__ import annotations

import csv
import re
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PlainValidator, WithJsonSchema

from dalembert.errors import FileError, ModelError
from dalembert.files import read_text
from dalembert.io.choices import Record
from dalembert.io.values import Text, number_or_formula, short_repr
from dalembert.symbolic.formulas.interpolation import KINDS, OUTSIDE, TABLE_ENDS
from dalembert.text.wording import unknown


def _column(value: object) -> str | list[float | str]:
    if isinstance(value, str):
        return value
    if not isinstance(value, list):
        raise ValueError(f"expected the name of a column or a list, got {short_repr(value)}")
    return [number_or_formula(item) for item in value]


Column = Annotated[
    Any,
    PlainValidator(_column),
    WithJsonSchema(
        {"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": ["number", "string"]}}]}
    ),
]


class CurveTable(Record):
    """Interpolating function through the rows of a table, inline or from a CSV file."""

    file: Text = Field(
        default=None, description="CSV file in the folder of the model, with a heading"
    )
    x: Column = Field(default=None, description="list of increasing values; or name of the column")
    y: Column = Field(default=None, description="as many values; or name of the column")
    units: list[Text] | None = Field(
        default=None, description='of x and y, as `["mm", "kN"]`; by default those of the heading'
    )
    kind: Text = Field(default="spline", description=" or ".join(f'`"{k}"`' for k in KINDS))
    ends: Text = Field(
        default="not-a-knot",
        description="of a spline: " + ", ".join(f'`"{k}"`' for k in TABLE_ENDS),
    )
    outside: Text = Field(default="error", description=", ".join(f'`"{k}"`' for k in OUTSIDE))


def read_curve(table: CurveTable, source: Path, read: Any) -> dict[str, Any]:
    """Keyword arguments of ``System.table`` from a table of the file.

    Parameters
    ----------
    source : path of the model file
    read : converts a number or formula

    Raises
    ------
    ModelError, FileError
        Neither rows nor a file, or a file without rows.
    """
    keywords: dict[str, Any] = {key: getattr(table, key) for key in ("kind", "outside", "ends")}
    if table.file is None:
        if not isinstance(table.x, list) or not isinstance(table.y, list):
            raise ModelError("give x and y as lists, or the file that has them")
        keywords |= {"x": [read(v) for v in table.x], "y": [read(v) for v in table.y]}
    else:
        if isinstance(table.x, list) or isinstance(table.y, list):
            raise ModelError("with a file, x and y are the names of its columns")
        columns = read_columns(source.parent / table.file)
        chosen = [_chosen(columns, name, k) for k, name in enumerate((table.x, table.y))]
        keywords |= {"x": chosen[0][1], "y": chosen[1][1], "units": (chosen[0][0], chosen[1][0])}
    if table.units is not None:
        if len(table.units) != 2:
            raise ModelError(f"units are those of x and y, got {len(table.units)}")
        keywords["units"] = tuple(table.units)
    return keywords


def _chosen(
    columns: dict[str, tuple[str, list[float]]], name: str | None, index: int
) -> tuple[str, list[float]]:
    if name is None:
        if len(columns) < 2:
            raise ModelError("the file has one column only; x and y take two")
        return list(columns.values())[index]
    if name not in columns:
        raise ModelError(unknown("column", name, columns))
    return columns[name]


def read_columns(path: Path) -> dict[str, tuple[str, list[float]]]:
    """Name → unit and values of each column of a CSV file; a heading reads ``stroke [mm]``.

    Columns without a heading are ``1``, ``2`` and so on. Lines that begin with ``#`` are comments.

    Raises
    ------
    FileError
        The file cannot be read, a line is not numeric (states its number), or names repeat.
    """
    heading: list[str] = []
    rows: list[list[float]] = []
    try:
        for number, row in enumerate(csv.reader(read_text(path).splitlines()), 1):
            if not "".join(row).strip() or row[0].lstrip().startswith("#"):
                continue
            try:
                values = [float(text) for text in row]
            except ValueError:
                if rows or heading:
                    line = ",".join(row)[:60]
                    raise FileError(
                        f"{path}: line {number}: expected numbers, got {line!r}"
                    ) from None
                heading = [text.strip() for text in row]
                continue
            if len(values) != len(heading or (rows[0] if rows else values)):
                raise FileError(
                    f"{path}: line {number}: has {len(values)} columns, unlike the lines before"
                )
            rows.append(values)
    except csv.Error as error:
        raise FileError(f"{path}: not a CSV file ({error})") from None
    if not rows:
        raise FileError(f"{path}: has no rows of numbers")
    columns: dict[str, tuple[str, list[float]]] = {}
    for k, column in enumerate(zip(*rows, strict=True)):
        match = re.fullmatch(r"(.*?)\s*(?:\[(.*)\])?", heading[k] if heading else str(k + 1))
        assert match is not None
        if match[1] in columns:
            raise FileError(f"{path}: two columns are named {match[1]!r}")
        columns[match[1]] = (match[2] or "", list(column))
    return columns
