"""The analysis that a file asks for, with its strategies and events."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from dalembert.analysis.dynamics import Dynamics
from dalembert.analysis.events import Event
from dalembert.analysis.timeline import checked_span, checked_step, output_times
from dalembert.errors import SingularityError
from dalembert.io.fields import kind_of, written
from dalembert.io.messages import nearest
from dalembert.io.model_file import ModelFile
from dalembert.io.strategies import ANALYSES, STRATEGIES
from dalembert.io.tables import EventTable
from dalembert.model.model import Model
from dalembert.symbolic.expression import Expression


def make_analysis(file: ModelFile, model: Model, kind: str | None = None) -> Any:
    """The analysis that the file asks for, or one of another type with the same options.

    Raises
    ------
    ModelError, UnsupportedError, AnalysisError
        No analysis in the file, unknown type, options that cannot work; with the place.
    """
    table: Any = file.document.analysis
    if table is None and kind is None:
        raise file.located.error(
            'is missing; add a table [analysis] with type = "Dynamics" and duration = …', "analysis"
        )
    name = kind or table.type
    if name not in ANALYSES:
        raise file.located.error(
            f"unknown type {name!r}{nearest(name, ANALYSES)}; known: {', '.join(ANALYSES)}",
            "analysis",
            "type",
        )
    cls = ANALYSES[name]
    with file.located("analysis"):
        analysis = cls(**_options(file, model, cls, table))
        _check_times(analysis)
    _check_choices(file, model, analysis)
    return analysis


def _check_choices(file: ModelFile, model: Model, analysis: Any) -> None:
    """The strategies of an analysis can work together, and on this mechanism.

    The functions of the first step are made for that; the run finds them ready.

    Raises
    ------
    ModelError, UnsupportedError
        Choices that cannot work, with their place.
    """
    if not isinstance(analysis, Dynamics):
        return
    start, p = model.start, model.nominal
    try:
        with file.located("analysis", "coordinates"):
            kernel = analysis.kernel(model)
        with file.located("analysis", "formulation"):
            x = kernel.start.function(0.0, start.y, start.v, p).full().ravel()
            mode = kernel.choose(0.0, x, p)
        with file.located("analysis"):
            variant = kernel.variants[mode]
            if analysis.integrator.adaptive:
                _ = variant.attempt
            _ = variant.step
    except SingularityError:  # the position is at fault, and the run may begin at another one
        return


def _options(file: ModelFile, model: Model, cls: type, table: BaseModel | None) -> dict[str, Any]:
    made = {}
    for field in written(cls, frozenset()):
        if table is None or field.name not in table.model_fields_set:
            continue
        given, kind = getattr(table, field.name), kind_of(field)
        with file.located("analysis", field.name):
            if kind in STRATEGIES:
                given = make_strategy(STRATEGIES[kind], given)
            elif kind == "events":
                given = {n: _event(file, model, n, e) for n, e in given.items()}
            elif kind == "interval":
                given = tuple(given)
        made[field.name] = given
    return made


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
        measure = read_measure(model, str(table.measure))
        return Event(measure, table.terminal, table.direction)


def _check_times(analysis: Any) -> None:
    """Spans and steps are checked before the run, so that a slip is told as one of the file."""
    if not hasattr(analysis, "t_span"):
        return
    start, end = checked_span(analysis.duration, analysis.t_span)
    checked_step(analysis.step, start, end)
    output_times(analysis.outputs, start, end)


def read_measure(model: Model, text: str) -> Expression:
    """A measure by its name, or a formula of measures.

    Raises
    ------
    ExpressionError
        Unknown names or a formula outside the grammar.
    """
    try:
        return model[text]
    except KeyError:
        return model.formula(text)
