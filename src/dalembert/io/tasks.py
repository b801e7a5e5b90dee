"""What a file asks to be computed: analyses, responses, gradients, designs."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from dalembert.analysis.events import Event
from dalembert.analysis.timeline import checked_span, checked_step, output_times
from dalembert.errors import ModelError
from dalembert.io.fields import kind_of, written
from dalembert.io.messages import nearest
from dalembert.io.model_file import ModelFile
from dalembert.io.strategies import ANALYSES, FORMULATIONS, INTEGRATORS, RESPONSES, STABILIZATIONS
from dalembert.io.tables import EventTable
from dalembert.model.model import Model
from dalembert.responses.base import Response
from dalembert.symbolic.expression import Expression

REGISTRIES = {
    "formulation": FORMULATIONS,
    "stabilization": STABILIZATIONS,
    "integrator": INTEGRATORS,
}


def make_analysis(file: ModelFile, model: Model, kind: str | None = None) -> Any:
    """The analysis that the file asks for, or one of another type with the same options.

    Raises
    ------
    ModelError, UnsupportedError, AnalysisError
        No analysis in the file, unknown type, options that cannot work; with the place.
    """
    table = file.document.analysis
    if table is None and kind is None:
        raise file.located.error(
            'is missing; add a table [analysis] with type = "Dynamics" and duration = …', "analysis"
        )
    name = kind or table.type
    if name not in ANALYSES:
        raise file.located.error(
            f"unknown type {name!r}{nearest(name, ANALYSES)}; known: {', '.join(ANALYSES)}",
            "analysis", "type",
        )
    cls = ANALYSES[name]
    with file.located("analysis"):
        analysis = cls(**_options(file, model, cls, table))
        _check_times(analysis)
    return analysis


def _options(file: ModelFile, model: Model, cls: type, table: BaseModel | None) -> dict[str, Any]:
    made = {}
    for field in written(cls, frozenset()):
        if table is None or field.name not in table.model_fields_set:
            continue
        given, kind = getattr(table, field.name), kind_of(field)
        with file.located("analysis", field.name):
            if kind in REGISTRIES:
                given = _strategy(REGISTRIES[kind], given)
            elif kind == "events":
                given = {n: _event(file, model, n, e) for n, e in given.items()}
            elif kind == "interval":
                given = tuple(given)
        made[field.name] = given
    return made


def _strategy(registry: dict[str, type], given: str | BaseModel) -> Any:
    if isinstance(given, str):
        return registry[given]()
    return registry[given.type](**_given(given))  # type: ignore[attr-defined]


def _given(table: BaseModel) -> dict[str, Any]:
    return {k: getattr(table, k) for k in table.model_fields_set - {"type"}}


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


def make_responses(file: ModelFile, model: Model) -> dict[str, Response]:
    """The responses of the file by name.

    Raises
    ------
    ModelError
        A measure or an option that cannot work, with its place.
    """
    made = {}
    for name, table in file.document.responses.items():
        with file.located("responses", name, "measure"):
            measure = read_measure(model, str(table.measure))
            if len(measure) != 1:
                raise ModelError(f"{table.measure!r} has {len(measure)} components; take .x or .y")
        with file.located("responses", name):
            options = _given(table) | {"measure": measure, "name": name}
            made[name] = RESPONSES[table.type](**options)
    return made


def chosen_responses(
    file: ModelFile, made: dict[str, Response], names: list[str] | None
) -> dict[str, Response]:
    """Some of the responses; all where no names are given."""
    if not made:
        raise ModelError(
            'has no responses; add e.g. [responses.peak] with type = "Maximum" and a measure',
            str(file.path),
        )
    for k, name in enumerate(names or []):
        if name not in made:
            raise file.located.error(
                f"unknown response {name!r}{nearest(name, made)}; known: {', '.join(made)}",
                "sensitivity", "responses", k,
            )
    return {name: made[name] for name in names or made}


def chosen_parameters(file: ModelFile, names: list[str] | None, *where: str) -> list[str]:
    """Some of the parameters; all where no names are given."""
    known = list(file.document.parameters)
    if not known:
        raise file.located.error("has no parameters; add at least one", "parameters")
    for k, name in enumerate(names or []):
        if name not in known:
            raise file.located.error(
                f"unknown parameter {name!r}{nearest(name, known)}; known: {', '.join(known)}",
                *where, k,
            )
    return list(names or known)


def report_choices(file: ModelFile, model: Model) -> dict[str, Any]:
    """What the report shows first: ``plots`` and ``trace``, each name checked."""
    report = file.document.report
    for i, group in enumerate(report.plots or []):
        for k, measure in enumerate(group):
            with file.located("report", "plots", i, k):
                read_measure(model, measure)
    points = [p.name for body in model.bodies for p in body.points.values()]
    for k, point in enumerate(report.trace or []):
        if point not in points:
            raise file.located.error(
                f"unknown point {point!r}{nearest(point, points)}; known: {', '.join(points[:12])}",
                "report", "trace", k,
            )
    return {"plots": report.plots, "trace": report.trace}


def check_tasks(file: ModelFile, model: Model) -> None:
    """Everything the file asks for can be made; nothing is computed."""
    made = make_responses(file, model)
    report_choices(file, model)
    if file.document.analysis is not None:
        make_analysis(file, model)
    if file.document.sensitivity.responses or file.document.sensitivity.wrt:
        chosen_responses(file, made, file.document.sensitivity.responses)
        chosen_parameters(file, file.document.sensitivity.wrt, "sensitivity", "wrt")
