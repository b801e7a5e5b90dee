"""What a file asks of a run: responses, gradients, a design, the first view of the report."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from dalembert.analysis.comparison.compare import Comparing
from dalembert.analysis.comparison.observation import observe
from dalembert.analysis.times import in_seconds
from dalembert.design.limit import Limit
from dalembert.design.studies.design import Design
from dalembert.design.variables import Catalogue, Integer
from dalembert.errors import ModelError
from dalembert.io.analyses import given_options, make_analysis, make_strategy
from dalembert.io.measures import measure_reader
from dalembert.io.model_file import ModelFile
from dalembert.io.schema import Document
from dalembert.io.strategies import RESPONSES, STRATEGIES
from dalembert.responses.base import Response
from dalembert.responses.events import AtEvent
from dalembert.results.headings import checked_units
from dalembert.results.labelled import DATA_ONLY
from dalembert.text import nearest, unknown

COMPARED = {
    "formulations": "formulation",
    "integrators": "integrator",
    "stabilizations": "stabilization",
    "coordinates": "coordinates",
}
"""Key of ``[compare]`` → kind of strategy."""


def make_responses(file: ModelFile, model: Any) -> dict[str, Response]:
    """The responses of the file by name.

    Raises
    ------
    ModelError
        A measure or an option that cannot work, with its place.
    """
    made = {}
    tables: dict[str, Any] = file.document.responses
    read = measure_reader(file.document)
    for name, table in tables.items():
        with file.located("responses", name, "measure"):
            measure = read(model, str(table.measure))
            if len(measure) != 1:
                raise ModelError(f"{table.measure!r} has {len(measure)} components; take .x or .y")
        with file.located("responses", name):
            options = given_options(table) | {"measure": measure, "name": name}
            made[name] = RESPONSES[table.type](**options)
        if isinstance(made[name], AtEvent):
            _check_event(file, table.event, "responses", name, "event")
    return made


def _check_event(file: ModelFile, name: str, *where: str) -> None:
    table: Any = file.document.analysis
    known = getattr(table, "events", None) or {}
    if name not in known:
        raise file.located.error(
            f"unknown event {name!r}{nearest(name, known)}; known in [analysis.events]: "
            f"{', '.join(known) or 'none'}",
            *where,
        )


def chosen_response(
    file: ModelFile, made: dict[str, Response], name: str, *where: str | int
) -> Response:
    """One of the file's responses.

    Raises
    ------
    ModelError
        There is none of this name.
    """
    if not made:
        raise file.located.error(
            'has none; add e.g. [responses.peak] with type = "Maximum" and a measure', "responses"
        )
    if name not in made:
        raise file.located.error(unknown("response", name, made), *where)
    return made[name]


def chosen_parameters(file: ModelFile, names: list[str] | None, *where: str | int) -> list[str]:
    """Some of the parameters; all where no names are given."""
    known = list(file.document.parameters)
    if not known:
        raise file.located.error("has no parameters; add at least one", "parameters")
    names = names or []
    for k, name in enumerate(names):
        if name not in known:
            raise file.located.error(unknown("parameter", name, known), *where, k)
        if name in names[:k]:
            raise file.located.error(f"{name!r} is named twice; name it once", *where, k)
    return list(names or known)


def make_gradient(file: ModelFile, model: Any) -> tuple[dict[str, Response], list[str]]:
    """Responses and parameters of ``[sensitivity]``; all where none are named."""
    asked, made = file.document.sensitivity, make_responses(file, model)
    names = asked.responses or list(made) or [""]
    for k, name in enumerate(names):
        if name in names[:k]:
            text = f"{name!r} is named twice; name it once"
            raise file.located.error(text, "sensitivity", "responses", k)
    responses = {
        name: chosen_response(file, made, name, "sensitivity", "responses", k)
        for k, name in enumerate(names)
    }
    return responses, chosen_parameters(file, asked.wrt, "sensitivity", "wrt")


def make_design(file: ModelFile, model: Any) -> dict[str, Any]:
    """The arguments of ``optimize`` that the file gives.

    Raises
    ------
    ModelError
        No ``[optimize]``, or names and limits that cannot work.
    """
    asked = file.document.optimize
    if asked is None:
        raise file.located.error(
            "is missing; add [optimize] with minimize = a response", "optimize"
        )
    if (asked.minimize is None) == (asked.maximize is None):
        raise file.located.error("give one objective: minimize or maximize", "optimize")
    made, sense = make_responses(file, model), "minimize" if asked.minimize else "maximize"
    design: dict[str, Any] = {
        sense: chosen_response(file, made, getattr(asked, sense), "optimize", sense),
        "subject_to": [],
    }
    for k, limit in enumerate(asked.subject_to):
        where = ("optimize", "subject_to", k)
        with file.located(*where):
            response = chosen_response(file, made, limit.response, *where, "response")
            design["subject_to"].append(Limit(response, limit.lower, limit.upper))
    vary = asked.vary or [n for n, p in model.parameters.items() if np.all(np.isfinite(p.bounds))]
    if not vary:
        raise file.located.error(
            "name the parameters to vary, or give some bounds", "optimize", "vary"
        )
    design["vary"] = _with_sizes(file, chosen_parameters(file, vary, "optimize", "vary"))
    keys = ("method", "gradient", "max_iterations", "tolerance")
    return design | {key: getattr(asked, key) for key in keys}


def _with_sizes(file: ModelFile, vary: list[str]) -> list[Any]:
    """What varies, with whole numbers and catalogues in place of their names."""
    asked: Any = file.document.optimize
    integers = chosen_parameters(file, asked.integers, "optimize", "integers")
    whole = integers if asked.integers else []
    made: dict[str, Any] = {name: Integer(name) if name in whole else name for name in vary}
    made |= {name: Integer(name) for name in whole}
    for k, columns in enumerate(asked.catalogues):
        names = chosen_parameters(file, list(columns), "optimize", "catalogues", k)
        for name in names[1:]:
            made.pop(name, None)
        made[names[0]] = Catalogue(columns)
    return list(made.values())


def make_sweep(file: ModelFile, model: Any) -> tuple[Design, list[Response]]:
    """Designs and responses of ``[sweep]``.

    Raises
    ------
    ModelError, AnalysisError
        No ``[sweep]``, or names, ranges and counts that cannot work.
    """
    asked = file.document.sweep
    if asked is None:
        raise file.located.error(
            "is missing; add [sweep] with vary = { parameter = [lower, upper] }", "sweep"
        )
    made = make_responses(file, model)
    names = asked.responses or list(made) or [""]
    where = ("sweep", "responses")
    responses = [chosen_response(file, made, n, *where, k) for k, n in enumerate(names)]
    chosen_parameters(file, list(asked.vary), "sweep", "vary")
    given = asked.vary or {
        name: list(q.bounds)
        for name, q in model.parameters.items()
        if np.all(np.isfinite(q.bounds))
    }
    listed = {"Grid": Design.grid, "Table": Design.table}
    drawn = {
        "LatinHypercube": Design.latin_hypercube,
        "MonteCarlo": Design.monte_carlo,
        "Sobol": Design.sobol,
    }
    with file.located("sweep", "vary"):
        if asked.type in listed:
            return listed[asked.type](asked.vary), responses
        return drawn[asked.type](given, asked.samples, asked.rng), responses


def make_comparison(file: ModelFile, model: Any, given: Mapping[str, Any]) -> dict[str, Any]:
    """The arguments of ``compare`` that ``[compare]`` and the times of ``[analysis]`` give.

    Parameters
    ----------
    given : what is known without the file, and not read from it

    Raises
    ------
    ModelError
        No duration, or options that cannot work, with their place.
    """
    if not isinstance(file.document, Document):
        raise file.located.error("of formulations is for mechanisms", "compare")
    asked = file.document.compare
    made: dict[str, Any] = {}
    for key in sorted(asked.model_fields_set - set(given)):
        values = getattr(asked, key)
        registry = STRATEGIES.get(COMPARED.get(key, ""))
        with file.located("compare", key):
            made[key] = [make_strategy(registry, v) for v in values] if registry else values
    with file.located("compare", "coordinates"):
        for coordinates in made.get("coordinates", []):
            coordinates.view(model, False)
    with file.located("compare", "measure"):
        observe(model, made.get("measure"))
    times = {"duration": given["duration"]} if "duration" in given else _times(file, model)
    with file.located("compare"):
        Comparing(**made, **times)
    return made | times


def _times(file: ModelFile, model: Any) -> dict[str, Any]:
    """Span and outputs of ``[analysis]``."""
    table: Any = file.document.analysis
    if table is None or table.type != "Dynamics":
        raise file.located.error(
            'is needed: add a table [analysis] with type = "Dynamics" and duration = …, '
            "or give a duration",
            "analysis",
        )
    keys = table.model_fields_set & {"duration", "t_span", "outputs"}
    with file.located("analysis"):
        given = {key: getattr(table, key) for key in sorted(keys)}
        made = in_seconds(given, model, None, "compare")
    return made | ({"t_span": tuple(made["t_span"])} if "t_span" in made else {})


def report_choices(file: ModelFile, model: Any) -> dict[str, Any]:
    """What the report of a mechanism shows first: ``plots`` and ``trace``, each name checked."""
    if not isinstance(file.document, Document):
        return {}
    report = file.document.report
    for i, group in enumerate(report.plots):
        for k, measure in enumerate(group):
            with file.located("report", "plots", i, k):
                if measure not in DATA_ONLY:
                    model.expression(measure)
    points = [p.name for body in model.bodies for p in body.points.values()]
    for k, point in enumerate(report.trace):
        if point not in points:
            raise file.located.error(unknown("point", point, points), "report", "trace", k)
    with file.located("report", "units"):
        units = checked_units(report.units)
    return {"plots": report.plots or None, "trace": report.trace or None, "units": units}


def check_tasks(file: ModelFile, model: Any) -> None:
    """Everything the file asks for can be made; nothing is computed."""
    make_responses(file, model)
    report_choices(file, model)
    if file.document.analysis is not None or file.document.usual_analysis is not None:
        make_analysis(file, model)
    if "compare" in file.document.model_fields_set:
        make_comparison(file, model, {})
    if "sensitivity" in file.document.model_fields_set:
        make_gradient(file, model)
    if file.document.optimize is not None:
        make_design(file, model)
    if file.document.sweep is not None:
        make_sweep(file, model)
