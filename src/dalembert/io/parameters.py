"""Declaration of the parameters and tables of a file."""

from __future__ import annotations

from typing import Any

from dalembert.io.curve_tables import read_curve
from dalembert.io.formulas import Formulas
from dalembert.io.location import Located
from dalembert.io.schema import ModelDocument, ParameterTable


def declare_parameters(target: Any, document: ModelDocument, located: Located) -> None:
    """Declare all parameters of a document on a system or structure.

    Raises
    ------
    ModelError
        Invalid name or bounds; states the location.
    """
    entries: dict[str, Any] = document.parameters
    for name, entry in entries.items():
        table = entry if isinstance(entry, ParameterTable) else ParameterTable(value=entry)
        with located("parameters", name):
            target.parameter(name, table.value, table.unit, table.bounds, table.description)


def declare_tables(
    target: Any, document: ModelDocument, located: Located, formulas: Formulas
) -> None:
    """Declare all tables of a document on a system or structure.

    Raises
    ------
    ModelError, FileError
        Invalid rows or file; states the location.
    """
    for name, table in document.tables.items():
        with located("tables", name):
            target.table(name, **read_curve(table, located.source, formulas.read))
