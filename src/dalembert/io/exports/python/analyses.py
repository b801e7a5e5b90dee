"""The analysis of a model file as Python code."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from pydantic import BaseModel

from dalembert.analysis.events import Events
from dalembert.analysis.rayleigh import Rayleigh
from dalembert.analysis.times import TIMES
from dalembert.io.analysis_tables import CrossDensityTable, DensityTable, EventTable
from dalembert.io.exports.python.code import Code, call, literal, quoted, table
from dalembert.io.fields import Densities, Interval, Names, keyed_fields
from dalembert.io.schema import ModelDocument
from dalembert.io.strategies import STRATEGIES_OF
from dalembert.results.structural.result import StructuralResult

SOLVE = {
    "Dynamics": "solve_dynamics",
    "Kinematics": "solve_kinematics",
    "InverseDynamics": "solve_inverse_dynamics",
    "Equilibrium": "solve_equilibrium",
    "Nonsmooth": "solve_nonsmooth",
}
"""Analyses whose times may be texts → function that takes them."""


def analysis_code(document: ModelDocument) -> Code | str:
    """Expression of the result of the analysis; an empty text if the file has none."""
    entry: Any = document.analysis  # type: ignore[attr-defined]
    if entry is None:
        usual = document.usual_analysis
        return f"da.{usual}().run(model)" if usual else ""
    cls = document.analyses[entry.type]
    options: dict[str, Any] = {}
    timed = False
    for field in keyed_fields(cls, frozenset()):
        if field.name in entry.model_fields_set:
            value = getattr(entry, field.name)
            options[field.name] = _option(field.holds, value)
            listed = value if isinstance(value, list) else [value]
            timed |= field.name in TIMES and field.holds is not Names and _has_text(listed)
    if timed and entry.type in SOLVE:
        return call(f"da.{SOLVE[entry.type]}", "model", **options)
    return Code(f"{call(f'da.{entry.type}')}"[:-1], call("", **options).parts, ").run(model)")


def _has_text(values: list[Any]) -> bool:
    return any(isinstance(value, str) for value in values)


def _option(kind: Any, entry: Any) -> Any:
    """Value of a key, as ``make_analysis`` reads it."""
    writers: dict[Any, Callable[[], Any]] = {
        Events: lambda: table({name: _event(each) for name, each in entry.items()}),
        Interval: lambda: literal(tuple(entry)),
        Densities: lambda: table({name: _density(each) for name, each in entry.items()}),
        Rayleigh: lambda: call("da.Rayleigh", _parameter(entry.mass), _parameter(entry.stiffness)),
        StructuralResult: lambda: f"load_case(model, {quoted(entry)})",
    }
    if kind in STRATEGIES_OF:
        return _strategy(entry)
    return writers[kind]() if kind in writers else literal(entry)


def _parameter(entry: float | str) -> str:
    """A number, or a formula of parameters of the model."""
    return f"model.formula({quoted(entry)})" if isinstance(entry, str) else literal(entry)


def _strategy(entry: str | BaseModel) -> Code:
    """A strategy by its name or from a table."""
    if isinstance(entry, str):
        return call(f"da.{entry}")
    keys = [key for key in type(entry).model_fields if key in entry.model_fields_set - {"type"}]
    values = {key: getattr(entry, key) for key in keys}
    options = {k: literal(tuple(v) if isinstance(v, list) else v) for k, v in values.items()}
    return call(f"da.{entry.type}", **options)  # type: ignore[attr-defined]


def _event(entry: Any) -> Any:
    """An event: its measure, or with options."""
    if not isinstance(entry, EventTable):
        return literal(entry)
    measure = f"model.expression({quoted(str(entry.measure))})"
    options: dict[str, Any] = {"terminal": "True"} if entry.terminal else {}
    options |= {"direction": literal(entry.direction)} if entry.direction else {}
    return call("da.Event", measure, **options)


def _density(entry: Any) -> Any:
    """A spectral density: a value, points, or a cross spectral density."""
    if isinstance(entry, DensityTable):
        return table({key: literal(getattr(entry, key)) for key in ("frequency", "density")})
    if isinstance(entry, CrossDensityTable):
        return literal(entry.model_dump(exclude_none=True))
    return literal(entry)
