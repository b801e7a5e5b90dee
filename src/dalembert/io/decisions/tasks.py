"""Tasks of a file: gradients, sweeps and comparisons."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from dalembert.analysis.comparison.compare import Comparing
from dalembert.analysis.comparison.reference import observe
from dalembert.analysis.times import in_seconds
from dalembert.design.studies.design_table import DesignTable
from dalembert.io.analyses import make_analysis, make_strategy
from dalembert.io.decisions.designs import make_design, make_front
from dalembert.io.decisions.estimation import make_identification, make_inversion
from dalembert.io.decisions.reliability import make_reliability, make_tolerance
from dalembert.io.decisions.responses import find_response, make_responses, select_parameters
from dalembert.io.decisions.synthesis import make_synthesis
from dalembert.io.decisions.trajectories import make_trajectory
from dalembert.io.documents import Document
from dalembert.io.model_file import ModelFile
from dalembert.io.report import report_choices
from dalembert.io.strategies import STRATEGIES
from dalembert.model.graph.model import Model
from dalembert.responses.base import Response
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.units.measured import check_measured

STRATEGY_KINDS = {
    "formulations": "formulation",
    "integrators": "integrator",
    "stabilizations": "stabilization",
    "coordinates": "coordinates",
}
"""Key of ``[compare]`` → key of ``STRATEGIES``."""


def make_gradient(file: ModelFile, model: ParametricModel) -> tuple[dict[str, Response], list[str]]:
    """Responses and parameters of ``[sensitivity]``; all if none are named."""
    table, available = file.document.sensitivity, make_responses(file, model)
    names = table.responses or list(available) or [""]
    for k, name in enumerate(names):
        if name in names[:k]:
            text = f"{name!r} is named twice; name it once"
            raise file.located.error(text, "sensitivity", "responses", k)
    responses = {
        name: find_response(file, available, name, "sensitivity", "responses", k)
        for k, name in enumerate(names)
    }
    return responses, select_parameters(file, table.wrt, "sensitivity", "wrt")


def make_sweep(file: ModelFile, model: ParametricModel) -> tuple[DesignTable, list[Response]]:
    """Designs and responses of ``[sweep]``.

    Raises
    ------
    ModelError, AnalysisError
        No ``[sweep]``, or invalid names, ranges or counts.
    """
    table = file.document.sweep
    if table is None:
        raise file.located.error(
            "is missing; add [sweep] with vary = { parameter = [lower, upper] }", "sweep"
        )
    available = make_responses(file, model)
    names = table.responses or list(available) or [""]
    where = ("sweep", "responses")
    responses = [find_response(file, available, n, *where, k) for k, n in enumerate(names)]
    select_parameters(file, list(table.vary), "sweep", "vary")
    for name, values in table.vary.items():
        with file.located("sweep", "vary", name):
            check_measured(values, model.parameters[name].unit, "")
    ranges = table.vary or {
        name: list(q.bounds)
        for name, q in model.parameters.items()
        if np.all(np.isfinite(q.bounds))
    }
    explicit = {"Grid": DesignTable.grid, "Table": DesignTable.table}
    random = {
        "LatinHypercube": DesignTable.latin_hypercube,
        "MonteCarlo": DesignTable.monte_carlo,
        "Sobol": DesignTable.sobol,
    }
    with file.located("sweep", "vary"):
        if table.type in explicit:
            return explicit[table.type](table.vary), responses
        return random[table.type](ranges, table.samples, table.rng), responses


def make_comparison(file: ModelFile, model: Model, preset: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of ``compare`` from ``[compare]`` and the times of ``[analysis]``.

    Parameters
    ----------
    preset : arguments that override those of the file

    Raises
    ------
    ModelError
        No duration, or invalid options; states the location.
    """
    if not isinstance(file.document, Document):
        raise file.located.error("of formulations is for mechanisms", "compare")
    table = file.document.compare
    arguments: dict[str, Any] = {}
    for key in sorted(table.model_fields_set - set(preset)):
        values = getattr(table, key)
        registry = STRATEGIES.get(STRATEGY_KINDS.get(key, ""))
        with file.located("compare", key):
            arguments[key] = [make_strategy(registry, v) for v in values] if registry else values
    with file.located("compare", "coordinates"):
        for coordinates in arguments.get("coordinates", []):
            coordinates.view(model, False)
    with file.located("compare", "measure"):
        observe(model, arguments.get("measure"))
    times = {"duration": preset["duration"]} if "duration" in preset else _times(file, model)
    with file.located("compare"):
        Comparing(**arguments, **times)
    return arguments | times


def _times(file: ModelFile, model: ParametricModel) -> dict[str, Any]:
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
        values = {key: getattr(table, key) for key in sorted(keys)}
        times = in_seconds(values, model, None, "compare")
    return times | ({"t_span": tuple(times["t_span"])} if "t_span" in times else {})


READERS: dict[str, Callable[[ModelFile, Any], Any]] = {
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
"""Section of a file → its reader."""


def check_tasks(file: ModelFile, model: ParametricModel) -> None:
    """Check that all tasks of a file can be constructed; nothing is computed."""
    make_responses(file, model)
    report_choices(file, model)
    if file.document.analysis is not None or file.document.usual_analysis is not None:
        make_analysis(file, model)
    for section, read in READERS.items():
        if section in file.document.model_fields_set and getattr(file.document, section):
            read(file, model)
