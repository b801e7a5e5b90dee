"""Analyses of a file, with their strategies and events."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any

import numpy as np
from pydantic import BaseModel

from dalembert.analysis.events import Event, Events
from dalembert.analysis.rayleigh import Rayleigh
from dalembert.analysis.times import in_seconds
from dalembert.errors import SingularityError, UnsupportedError
from dalembert.io.analysis_tables import CrossDensityTable, DensityTable, EventTable
from dalembert.io.fields import Densities, Interval, Names, keyed_fields
from dalembert.io.formulas import Formulas, ParameterNames
from dalembert.io.model_file import ModelFile
from dalembert.io.strategies import STRATEGIES_OF, STRUCTURAL_ANALYSES
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.graph.model import Model
from dalembert.results.structural.result import StructuralResult
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import unknown


def make_analysis(file: ModelFile, model: ParametricModel, kind: str | None = None) -> Any:
    """The analysis of the file, or one of another type with the same options.

    Raises
    ------
    ModelError, UnsupportedError, AnalysisError
        No analysis in the file, unknown type or invalid options; states the location.
    """
    table: Any = file.document.analysis
    classes, default = file.document.analyses, file.document.usual_analysis
    if table is None and kind is None and default is None:
        raise file.located.error(
            'is missing; add a table [analysis] with type = "Dynamics" and duration = …', "analysis"
        )
    name: Any = kind if kind is not None else table.type if table is not None else default
    if name not in classes:
        raise file.located.error(unknown("type", name, classes), "analysis", "type")
    return _create(file, model, classes[name], table, "analysis")


def make_table(file: ModelFile, model: ParametricModel, table: Any, *where: str) -> Any:
    """The analysis of another table of the file, such as that of a case.

    Raises
    ------
    ModelError, UnsupportedError, AnalysisError
        Invalid options; states the location.
    """
    return _create(file, model, file.document.analyses[table.type], table, *where)


def make_method(
    file: ModelFile,
    model: ParametricModel,
    registry: Mapping[str, Any],
    entry: str | BaseModel,
    *where: str,
) -> Any:
    """A method by its name, or from a table whose options may be strategies.

    Raises
    ------
    ModelError, UnsupportedError, AnalysisError
        Invalid options; states the location.
    """
    if isinstance(entry, str):
        return registry[entry]()
    return _create(file, model, registry[entry.type], entry, *where)  # type: ignore[attr-defined]


def _create(file: ModelFile, model: ParametricModel, cls: type, table: Any, *where: str) -> Any:
    with file.located(*where):
        analysis = cls(**_options(file, model, cls, table, where))
    for option, check in analysis.checks(model).items():
        location = (*where, option) if option else where
        with file.located(*location), suppress(SingularityError):
            check()  # a singular position is no error: the run may begin at another one
    return analysis


def _options(
    file: ModelFile,
    model: ParametricModel,
    cls: type,
    table: BaseModel | None,
    where: tuple[str, ...],
) -> dict[str, Any]:
    options: dict[str, Any] = {}
    for field in keyed_fields(cls, frozenset()):
        if table is None or field.name not in table.model_fields_set:
            continue
        entry = getattr(table, field.name)
        with file.located(*where, field.name):
            option = _option(file, model, field.holds, entry)
            named = field.holds is Names  # outputs that are no times
            options |= (
                {field.name: option}
                if named
                else in_seconds({field.name: option}, model, None, cls.__name__)
            )
    return options


def _option(file: ModelFile, model: Any, kind: Any, entry: Any) -> Any:
    """Value of a key of ``[analysis]``."""
    makers: dict[Any, Callable[[], Any]] = {
        Events: lambda: {n: _event(file, model, n, e) for n, e in entry.items()},
        Interval: lambda: tuple(entry),
        Densities: lambda: {name: _density(each) for name, each in entry.items()},
        Rayleigh: lambda: _damping(file, model, entry),
        StructuralResult: lambda: _load_case_state(model, entry),
    }
    if kind in STRATEGIES_OF:
        return make_strategy(STRATEGIES_OF[kind], entry)
    return makers[kind]() if kind in makers else entry


def _density(entry: Any) -> Any:
    if isinstance(entry, DensityTable):
        return {"frequency": entry.frequency, "density": entry.density}
    return entry.model_dump(exclude_none=True) if isinstance(entry, CrossDensityTable) else entry


def _damping(file: ModelFile, model: StructuralModel, table: Any) -> Rayleigh:
    formulas = Formulas(ParameterNames(model.parameters))
    with file.located("analysis", "damping"):
        return Rayleigh(formulas.read(table.mass), formulas.read(table.stiffness))


def _load_case_state(model: StructuralModel, case: str) -> StructuralResult:
    """Linear statics under one load case."""
    if model.kind != "structure":
        raise UnsupportedError("about names a load case, and mechanisms have none")
    solution = STRUCTURAL_ANALYSES["Statics"]().run(model)
    return solution.at(np.array([solution.case(case)]))


def make_strategy(registry: dict[str, type], entry: str | BaseModel) -> Any:
    """A strategy from its name, or from a table with its type and options."""
    if isinstance(entry, str):
        return registry[entry]()
    return registry[entry.type](**table_options(entry))  # type: ignore[attr-defined]


def table_options(table: BaseModel) -> dict[str, Any]:
    """Keys given in a table, without its type."""
    options = {k: getattr(table, k) for k in table.model_fields_set - {"type"}}
    return {k: tuple(v) if isinstance(v, list) else v for k, v in options.items()}


def _event(file: ModelFile, model: Model, name: str, entry: Any) -> Event:
    table = entry if isinstance(entry, EventTable) else EventTable(measure=entry)
    with file.located("analysis", "events", name):
        measure = model.expression(str(table.measure))
        return Event(measure, table.terminal, table.direction)
