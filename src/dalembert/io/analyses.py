"""The analysis that a file asks for, with its strategies and events."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from typing import Any

import numpy as np
from pydantic import BaseModel

from dalembert.analysis.events import Event, Events
from dalembert.analysis.structural.statics import Statics
from dalembert.analysis.structural.transient_equation import Rayleigh
from dalembert.analysis.times import in_seconds
from dalembert.errors import SingularityError
from dalembert.io.fields import Interval, written
from dalembert.io.formulas import Formulas, ParameterNames
from dalembert.io.model_file import ModelFile
from dalembert.io.strategies import STRATEGIES_OF
from dalembert.io.tables import EventTable
from dalembert.model.model import Model
from dalembert.results.structural.result import StructuralResult
from dalembert.structures.model import StructuralModel
from dalembert.text.wording import unknown


def make_analysis(file: ModelFile, model: Any, kind: str | None = None) -> Any:
    """The analysis that the file asks for, or one of another type with the same options.

    Raises
    ------
    ModelError, UnsupportedError, AnalysisError
        No analysis in the file, unknown type, options that cannot work; with the place.
    """
    table: Any = file.document.analysis
    known, usual = file.document.analyses, file.document.usual_analysis
    if table is None and kind is None and usual is None:
        raise file.located.error(
            'is missing; add a table [analysis] with type = "Dynamics" and duration = …', "analysis"
        )
    name = kind if kind is not None else table.type if table is not None else usual
    if name not in known:
        raise file.located.error(unknown("type", name, known), "analysis", "type")
    return _made(file, model, known[name], table, "analysis")


def make_table(file: ModelFile, model: Any, table: Any, *where: str) -> Any:
    """The analysis of a table somewhere else in the file, such as that of a case.

    Raises
    ------
    ModelError, UnsupportedError, AnalysisError
        Options that cannot work; with the place.
    """
    return _made(file, model, file.document.analyses[table.type], table, *where)


def make_method(
    file: ModelFile, model: Any, registry: dict[str, Any], given: str | BaseModel, *where: str
) -> Any:
    """A method by its name, or from a table whose options may be strategies.

    Raises
    ------
    ModelError, UnsupportedError, AnalysisError
        Options that cannot work; with the place.
    """
    if isinstance(given, str):
        return registry[given]()
    return _made(file, model, registry[given.type], given, *where)  # type: ignore[attr-defined]


def _made(file: ModelFile, model: Any, cls: type, table: Any, *where: str) -> Any:
    with file.located(*where):
        analysis = cls(**_options(file, model, cls, table, where))
    for option, check in analysis.checks(model).items():
        place = (*where, option) if option else where
        with file.located(*place), suppress(SingularityError):
            check()  # where the position is at fault, the run may begin at another one
    return analysis


def _options(
    file: ModelFile, model: Any, cls: type, table: BaseModel | None, where: tuple[str, ...]
) -> dict[str, Any]:
    made: dict[str, Any] = {}
    for field in written(cls, frozenset()):
        if table is None or field.name not in table.model_fields_set:
            continue
        given = getattr(table, field.name)
        with file.located(*where, field.name):
            option = _option(file, model, field.holds, given)
            made |= in_seconds({field.name: option}, model, None, cls.__name__)
    return made


def _option(file: ModelFile, model: Any, kind: Any, given: Any) -> Any:
    """What a key of ``[analysis]`` stands for."""
    makers: dict[Any, Callable[[], Any]] = {
        Events: lambda: {n: _event(file, model, n, e) for n, e in given.items()},
        Interval: lambda: tuple(given),
        Rayleigh: lambda: _damping(file, model, given),
        StructuralResult: lambda: _state(model, given),
    }
    if kind in STRATEGIES_OF:
        return make_strategy(STRATEGIES_OF[kind], given)
    return makers[kind]() if kind in makers else given


def _damping(file: ModelFile, model: StructuralModel, table: Any) -> Rayleigh:
    formulas = Formulas(ParameterNames(model.parameters))
    with file.located("analysis", "damping"):
        return Rayleigh(formulas.read(table.mass), formulas.read(table.stiffness))


def _state(model: StructuralModel, case: str) -> StructuralResult:
    """Linear statics under one load case."""
    solved = Statics().run(model)
    return solved.at(np.array([solved.case(case)]))


def make_strategy(registry: dict[str, type], given: str | BaseModel) -> Any:
    """A strategy from its name, or from a table with its type and its options."""
    if isinstance(given, str):
        return registry[given]()
    return registry[given.type](**given_options(given))  # type: ignore[attr-defined]


def given_options(table: BaseModel) -> dict[str, Any]:
    """The keys that a table gives, its type left out."""
    given = {k: getattr(table, k) for k in table.model_fields_set - {"type"}}
    return {k: tuple(v) if isinstance(v, list) else v for k, v in given.items()}


def _event(file: ModelFile, model: Model, name: str, given: Any) -> Event:
    table = given if isinstance(given, EventTable) else EventTable(measure=given)
    with file.located("analysis", "events", name):
        measure = model.expression(str(table.measure))
        return Event(measure, table.terminal, table.direction)
