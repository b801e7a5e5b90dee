"""Parameters, tables, derived parameters, inputs, outputs and histories as Python code."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dalembert.io.curve_tables import read_curve
from dalembert.io.declarations import dependency_order
from dalembert.io.exports.python.code import Code, Statements, call, literal, quoted
from dalembert.io.exports.python.formulas import FormulaCode
from dalembert.io.formulas import Formulas
from dalembert.io.schema import (
    DerivedTable,
    InputTable,
    ModelDocument,
    OutputTable,
    ParameterTable,
)
from dalembert.symbolic.formulas.inputs import is_formula


def _texts(entry: Any) -> dict[str, Any]:
    """Unit, bounds and description that a table states."""
    keywords: dict[str, Any] = {}
    if entry.unit:
        keywords["unit"] = quoted(entry.unit)
    if getattr(entry, "bounds", None) is not None:
        keywords["bounds"] = literal(tuple(entry.bounds))
    if entry.description:
        keywords["description"] = quoted(entry.description)
    return keywords


def declarations(document: ModelDocument, source: Path, formulas: FormulaCode) -> Statements:
    """Variable and code of each declared value, in the order in which a file is built."""
    variables = formulas.variables
    sections: Any = document
    for name, entry in sections.parameters.items():
        declared = entry if isinstance(entry, ParameterTable) else ParameterTable(value=entry)
        code = call("system.parameter", quoted(name), literal(declared.value), **_texts(declared))
        yield variables.assign("value", name, "value"), code
    for name, declared in sections.tables.items():
        keywords = read_curve(declared, source, Formulas(formulas.system).read)
        written: dict[str, Any] = {
            key: _column(declared, key, keywords[key], formulas) for key in ("x", "y")
        }
        for key, default in (("kind", "spline"), ("outside", "error"), ("ends", "not-a-knot")):
            if keywords[key] != default:
                written[key] = quoted(keywords[key])
        if any(keywords.get("units", ())):
            written["units"] = literal(keywords["units"])
        code = call("system.table", quoted(name), **written)
        yield variables.assign("value", name, "table"), code
    derived = {
        name: entry if isinstance(entry, DerivedTable) else DerivedTable(formula=entry)
        for name, entry in sections.derived.items()
    }
    for name in dependency_order("derived", {n: [str(d.formula)] for n, d in derived.items()}):
        texts = _texts(derived[name])
        unit = formulas.system.derived_parameters[name].unit
        if unit and "unit" not in texts:
            texts = {"unit": quoted(unit)} | texts
        formula = formulas.write(derived[name].formula, text=False)
        code = call("system.derived", quoted(name), formula, **texts)
        yield variables.assign("value", name, "value"), code
    for name, entry in sections.inputs.items():
        table = entry if isinstance(entry, InputTable) else InputTable(value=entry)
        value = (formulas.write if is_formula(table.value) else literal)(table.value)
        code = call("system.input", quoted(name), value, **_texts(table))
        yield variables.assign("value", name, "input"), code
    for name, entry in sections.outputs.items():
        output = entry if isinstance(entry, OutputTable) else OutputTable(formula=entry)
        yield "", call("system.output", quoted(name), quoted(output.formula), **_texts(output))


def histories(document: Any, formulas: FormulaCode) -> Statements:
    """Unknown functions of time."""
    for name, entry in document.histories.items():
        times = Code("[", [literal(float(time)) for time in entry.times()], "]")
        keywords: dict[str, Any] = {"unit": quoted(entry.unit)} if entry.unit else {}
        keywords |= {"ends": quoted(entry.ends)} if entry.ends != "not-a-knot" else {}
        arguments = ("system", quoted(name), times, literal(entry.value))
        variable = formulas.variables.assign("value", name, "history")
        yield variable, call("da.input_history", *arguments, **keywords)


def _column(table: Any, key: str, values: Any, formulas: FormulaCode) -> Code:
    """Column of a table: as it is written in the file, or the numbers of another file."""
    inline = table.file is None
    rows = getattr(table, key) if inline else values
    written = (formulas.write(x, text=False) if inline else literal(float(x)) for x in rows)
    return Code("[", list(written), "]")
