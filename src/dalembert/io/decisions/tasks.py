"""What a file asks of a run: responses, gradients, a design, the first view of the report."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from dalembert.analysis.comparison.compare import Comparing
from dalembert.analysis.comparison.reference import observe
from dalembert.analysis.times import in_seconds
from dalembert.design.studies.design import Design
from dalembert.io.analyses import make_analysis, make_strategy
from dalembert.io.decisions.designs import make_design, make_front
from dalembert.io.decisions.identification import make_identification
from dalembert.io.decisions.inversion import make_inversion
from dalembert.io.decisions.reliability import make_reliability, make_tolerance
from dalembert.io.decisions.responses import chosen_parameters, chosen_response, make_responses
from dalembert.io.decisions.synthesis import make_synthesis
from dalembert.io.decisions.task_tables import ReportTable
from dalembert.io.decisions.trajectories import make_trajectory
from dalembert.io.model_file import ModelFile
from dalembert.io.schema import Document
from dalembert.io.strategies import STRATEGIES
from dalembert.responses.base import Response
from dalembert.results.files.headings import checked_units
from dalembert.results.labelled import DATA_ONLY
from dalembert.text.wording import unknown
from dalembert.units.measured import check_measured

COMPARED = {
    "formulations": "formulation",
    "integrators": "integrator",
    "stabilizations": "stabilization",
    "coordinates": "coordinates",
}
"""Key of ``[compare]`` → kind of strategy."""


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
    for name, values in asked.vary.items():
        with file.located("sweep", "vary", name):
            check_measured(values, model.parameters[name].unit, "")
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
    """What the report shows first: ``plots``, ``trace`` and ``units``, each name checked."""
    report = file.document.report
    with file.located("report", "units"):
        units = checked_units(report.units)
    if not isinstance(report, ReportTable):
        return {"units": units}
    for i, group in enumerate(report.plots):
        for k, measure in enumerate(group):
            with file.located("report", "plots", i, k):
                if measure not in DATA_ONLY:
                    model.expression(measure)
    points = [p.name for body in model.bodies for p in body.points.values()]
    points += [body.name for body in model.bodies]
    for k, point in enumerate(report.trace):
        if point not in points:
            raise file.located.error(unknown("point", point, points), "report", "trace", k)
    return {"plots": report.plots or None, "trace": report.trace or None, "units": units}


CHECKED: dict[str, Callable[[ModelFile, Any], Any]] = {
    "compare": lambda file, model: make_comparison(file, model, {}),
    "sensitivity": make_gradient,
    "optimize": make_design,
    "pareto": make_front,
    "sweep": make_sweep,
    "reliability": make_reliability,
    "tolerance": make_tolerance,
    "identify": make_identification,
    "invert": make_inversion,
    "trajectory": make_trajectory,
    "synthesis": make_synthesis,
}
"""Table of a file → what reads it."""


def check_tasks(file: ModelFile, model: Any) -> None:
    """Everything the file asks for can be made; nothing is computed."""
    make_responses(file, model)
    report_choices(file, model)
    if file.document.analysis is not None or file.document.usual_analysis is not None:
        make_analysis(file, model)
    for section, read in CHECKED.items():
        if section in file.document.model_fields_set and getattr(file.document, section):
            read(file, model)
