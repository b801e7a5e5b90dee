"""Parquet tables of results, with units in the metadata."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import Any

import numpy as np

from dalembert.io.exports.columns import Column, Table, table_of
from dalembert.io.exports.exported import Files
from dalembert.packages import optional_package


def parquet_file(result: Any, name: str) -> Files:
    """A Parquet file with a row per instant, of batches per design and instant.

    The unit of a column is the entry ``unit`` of its metadata; those of the file are the name of
    the model, its status and the parameters.
    """
    arrow = optional_package("pyarrow", "Parquet")
    writer = optional_package("pyarrow.parquet", "Parquet")
    table = table_of(result)
    columns = long_columns(table)
    arrays = [arrow.array(column.values) for column in columns]
    fields = [
        arrow.field(c.name, array.type, metadata={"unit": c.unit})
        for c, array in zip(columns, arrays, strict=True)
    ]
    constants = {
        f"parameter_{c.name}": f"{c.values[0]!r} {c.unit}".rstrip() for c in _floats(table)
    }
    schema = arrow.schema(fields, metadata=table.attributes | constants)
    buffer = io.BytesIO()
    writer.write_table(arrow.Table.from_arrays(arrays, schema=schema), buffer)
    return Files({f"{name}.parquet": buffer.getvalue()})


def _floats(table: Table) -> list[Column]:
    """Parameters common to all rows, as plain numbers."""
    return [Column(c.name, c.unit, c.values.astype(float).tolist()) for c in table.parameters]  # type: ignore[arg-type]


def long_columns(table: Table) -> list[Column]:
    """Columns of one length; those of a batch are repeated along its designs.

    Names are unique: where a parameter is called ``design``, ``mode`` or ``case``, the numbers of
    designs, modes or load cases are ``design_index``, ``mode_index`` or ``case_index``.
    """
    names = {c.name for c in (*table.designs, *table.columns)}
    count = next((len(c.values) for c in (*table.designs, *table.columns)), 0)
    is_batch = any(c.values.ndim == 2 for c in table.columns) or bool(table.designs)
    if not is_batch:
        return [_index(table.along, names), *table.columns]
    size = len(table.along.values)
    designs = [_index(Column("design", "", np.arange(count)), names), *table.designs]
    along = _index(table.along, names)
    return [
        *(Column(c.name, c.unit, np.repeat(c.values, size)) for c in designs),
        Column(along.name, along.unit, np.tile(along.values, count)),
        *(Column(c.name, c.unit, c.values.reshape(-1)) for c in table.columns),
    ]


def _index(column: Column, names: set[str]) -> Column:
    """The column with a name that is none of the others."""
    name = column.name
    while name in names:
        name += "_index"
    return replace(column, name=name)
