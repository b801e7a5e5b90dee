"""Parameters of a file, declared on what is being built."""

from __future__ import annotations

from typing import Any

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
