"""MAT files of results, for MATLAB and Octave."""

from __future__ import annotations

import io
import keyword
import re
from collections.abc import Iterable
from typing import Any

import numpy as np

from dalembert.io.exports.columns import Column, table_of
from dalembert.io.exports.exported import Files

LONGEST = 63
"""Upper limit of the characters of a name in MATLAB."""
RESERVED = {
    *("parameters", "variables", "model", "status", "designs", "end", "function", "switch"),
    *("case", "otherwise", "elseif", "catch", "persistent", "spmd", "parfor", "classdef"),
}
"""Own variables of the file, and keywords of MATLAB that are none of Python."""


def mat_file(result: Any, name: str) -> Files:
    """A MAT file with one variable per measure.

    ``time`` (or ``load_case``, ``mode``) and the measures are columns, of batches matrices with a
    row per design. ``variables`` is a table of names, measures and units, ``parameters`` and
    ``designs`` are structures.
    """
    from scipy.io import savemat

    table = table_of(result)
    columns = [table.along, *table.columns]
    names = variable_names(column.name for column in columns)
    contents: dict[str, Any] = {
        short: _array(column) for short, column in zip(names, columns, strict=True)
    }
    rows = [(short, c.name, c.unit) for short, c in zip(names, columns, strict=True)]
    contents["variables"] = np.array([("name", "measure", "unit"), *rows], dtype=object)
    contents["parameters"] = _structure(table.parameters)
    if table.designs:
        contents["designs"] = _structure(table.designs)
    contents |= table.attributes
    buffer = io.BytesIO()
    savemat(buffer, contents, do_compression=True, long_field_names=True, oned_as="column")
    return Files({f"{name}.mat": buffer.getvalue()})


def _array(column: Column) -> np.ndarray:
    values = column.values
    return values.astype(object) if values.dtype.kind in "UO" else np.asarray(values, dtype=float)


def _structure(columns: list[Column]) -> dict[str, Any]:
    names = variable_names(column.name for column in columns)
    fields: dict[str, Any] = {
        short: c.values.astype(float) for short, c in zip(names, columns, strict=True)
    }
    rows = [(short, c.name, c.unit) for short, c in zip(names, columns, strict=True)]
    fields["units"] = np.array([("name", "parameter", "unit"), *rows], dtype=object)
    return fields


def variable_names(names: Iterable[str]) -> list[str]:
    """Names of variables in MATLAB: letters, digits and ``_``, at most 63, all different.

    Examples
    --------
    >>> from dalembert.io.exports.mat import variable_names
    >>> variable_names(["crank.x", "crank_x", "end", "1st", "Ω.angle"])
    ['crank_x', 'crank_x_2', 'end_', 'x1st', 'x__angle']
    """
    used: set[str] = {"units"}
    result = []
    for name in names:
        base = re.sub(r"[^0-9A-Za-z_]", "_", name)
        base = base if re.match(r"[A-Za-z]", base) else f"x{base}"
        if base in RESERVED or keyword.iskeyword(base):
            base = "load_case" if base == "case" else f"{base}_"
        candidate, number = base[:LONGEST], 1
        while candidate in used:
            number += 1
            ending = f"_{number}"
            candidate = base[: LONGEST - len(ending)] + ending
        used.add(candidate)
        result.append(candidate)
    return result
