"""Parameters and tables of a file, declared on what is being built."""

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
        A name or bounds that cannot be, with the place.
    """
    entries: dict[str, Any] = document.parameters
    for name, given in entries.items():
        table = given if isinstance(given, ParameterTable) else ParameterTable(value=given)
        with located("parameters", name):
            target.parameter(name, table.value, table.unit, table.bounds, table.description)


def declare_tables(
    target: Any, document: ModelDocument, located: Located, formulas: Formulas
) -> None:
    """Declare all tables of a document on a system or structure.

    Raises
    ------
    ModelError, FileError
        Rows or a file that cannot be, with the place.
    """
    for name, table in document.tables.items():
        with located("tables", name):
            target.table(name, **read_curve(table, located.source, formulas.read))
