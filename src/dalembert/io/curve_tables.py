"""Tables of values in model files: ``[tables.gas]``, for ``interp(x, gas)`` in formulas."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, PlainValidator, WithJsonSchema

from dalembert.errors import ModelError
from dalembert.io.choices import Record
from dalembert.io.column_files import check_gaps, read_columns
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
    """Interpolating function through the rows of a table, inline or from a file."""

    file: Text = Field(
        default=None,
        description="CSV, Parquet or C3D file in the folder of the model; columns as `stroke [mm]`",
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
        path = source.parent / table.file
        columns = read_columns(path)
        chosen = [_chosen(columns, name, k) for k, name in enumerate((table.x, table.y))]
        names = [name or list(columns)[k] for k, name in enumerate((table.x, table.y))]
        check_gaps(path, dict(zip(names, (values for _, values in chosen), strict=True)))
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
