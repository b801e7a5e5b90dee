"""Declarations of a file: parameters, tables and histories, and the order of entries."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from graphlib import CycleError, TopologicalSorter
from typing import TYPE_CHECKING, Any

from dalembert.errors import ExpressionError
from dalembert.io.curve_tables import read_curve
from dalembert.io.decisions.task_tables import HistoryTable
from dalembert.io.formulas import Formulas, Scope
from dalembert.io.location import Located
from dalembert.io.messages import key_path
from dalembert.io.schema import (
    DerivedTable,
    InputTable,
    ModelDocument,
    OutputTable,
    ParameterTable,
)
from dalembert.symbolic.formulas.declared import Declared
from dalembert.symbolic.formulas.inputs import is_formula

_FIRST_NAME = re.compile(r"(?<![\w.])[^\W\d]\w*")

if TYPE_CHECKING:
    from dalembert.design.inverse.input_history import InputHistory


def dependency_order(section: str, formulas: Mapping[str, Iterable[str]]) -> list[str]:
    """Names of a section, each after the names that its formulas use.

    Raises
    ------
    ExpressionError
        Circular references; names the cycle.
    """
    return ordered(
        section,
        {
            name: {n for text in texts for n in _FIRST_NAME.findall(text) if n in formulas}
            for name, texts in formulas.items()
        },
    )


def ordered(section: str | Mapping[str, str], needs: Mapping[str, set[str]]) -> list[str]:
    """Names of a section, each after those that it needs.

    Parameters
    ----------
    section : one for all, or that of each name
    needs : name, or name and part of an element such as ``"control inputs"`` → those it needs

    Raises
    ------
    ExpressionError
        Circular references; names the cycle.
    """
    try:
        return list(TopologicalSorter(needs).static_order())
    except CycleError as error:
        chain = [name.partition(" ")[0] for name in error.args[1][::-1]]
        place = section if isinstance(section, str) else section[chain[0]]
        more = " → …" if len(chain) > 12 else ""
        raise ExpressionError(
            f"depends on itself in the cycle {' → '.join(chain[:12])}{more}; "
            "define one of them without the others",
            key_path(place, chain[0]),
        ) from None


def declare_parameters(target: Declared, document: ModelDocument, located: Located) -> None:
    """Declare all parameters of a document on a system.

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


def declare_derived(
    target: Any, document: ModelDocument, located: Located, formulas: Formulas
) -> None:
    """Declare all derived parameters of a document on a system, in order of dependence.

    Raises
    ------
    ModelError
        Circular references, or an invalid formula; states the location.
    """
    entries: dict[str, Any] = document.derived
    tables = {
        name: entry if isinstance(entry, DerivedTable) else DerivedTable(formula=entry)
        for name, entry in entries.items()
    }
    with located():
        order = dependency_order("derived", {n: [str(d.formula)] for n, d in tables.items()})
    for name in order:
        table = tables[name]
        with located("derived", name):
            formula = formulas.read(table.formula)
            target.derived(name, formula, table.unit, table.description)


def declare_inputs(
    target: Declared, document: ModelDocument, located: Located, formulas: Formulas
) -> None:
    """Declare all inputs of a document on a system.

    Raises
    ------
    ModelError
        Invalid name, bounds or formula; states the location.
    """
    entries: dict[str, Any] = document.inputs
    for name, entry in entries.items():
        table = entry if isinstance(entry, InputTable) else InputTable(value=entry)
        with located("inputs", name):
            value = table.value
            if is_formula(value):
                value = formulas.read(value, Scope.TIME)
            target.input(name, value, table.unit, table.bounds, table.description)


def declare_outputs(target: Declared, document: ModelDocument, located: Located) -> None:
    """Declare all outputs of a document on a system.

    Raises
    ------
    ModelError
        Invalid name or unit; states the location.
    """
    entries: dict[str, Any] = document.outputs
    for name, entry in entries.items():
        table = entry if isinstance(entry, OutputTable) else OutputTable(formula=entry)
        with located("outputs", name):
            target.output(name, table.formula, table.unit, table.description)


def declare_tables(
    target: Declared, document: ModelDocument, located: Located, formulas: Formulas
) -> None:
    """Declare all tables of a document on a system.

    Raises
    ------
    ModelError, FileError
        Invalid rows or file; states the location.
    """
    for name, table in document.tables.items():
        with located("tables", name):
            target.table(name, **read_curve(table, located.source, formulas.read))


def declare_history(system: Declared, name: str, table: HistoryTable) -> InputHistory:
    """Declare the parameters of a history on a system."""
    from dalembert.design.inverse.input_history import input_history

    return input_history(system, name, table.times(), table.value, table.unit, table.ends)
