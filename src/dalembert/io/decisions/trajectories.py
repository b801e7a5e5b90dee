"""Trajectory optimisation of a file: ``[trajectory]``."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.trajectory.optimize_trajectory import duration_of
from dalembert.design.trajectory.physics import Physics
from dalembert.design.trajectory.quantities import check_response
from dalembert.io.analyses import make_method
from dalembert.io.decisions.cases import Quantities
from dalembert.io.decisions.responses import make_limits, select_parameters
from dalembert.io.decisions.task_tables import GUESSES
from dalembert.io.model_file import ModelFile
from dalembert.io.strategies import TRAJECTORY_METHODS
from dalembert.model.graph.model import Model
from dalembert.responses.values import Final
from dalembert.text.wording import unknown


def make_trajectory(file: ModelFile, model: Model) -> dict[str, Any]:
    """Arguments of ``optimize_trajectory`` from ``[trajectory]``.

    Raises
    ------
    ModelError
        No ``[trajectory]``, or invalid names or numbers; states the location.
    """
    table: Any = getattr(file.document, "trajectory", None)
    if table is None:
        cure = "is missing; add [trajectory] with controls, duration and end"
        raise file.located.error(cure, "trajectory")
    if not table.controls:
        raise file.located.error("is empty; name parameters of forces", "trajectory", "controls")
    controls = select_parameters(file, table.controls, "trajectory", "controls")
    vary = select_parameters(file, table.vary, "trajectory", "vary") if table.vary else []
    for k, name in enumerate(vary):
        if name in controls:
            text = f"{name!r} is a control; it cannot vary as well"
            raise file.located.error(text, "trajectory", "vary", k)
    with file.located("trajectory", "controls"):
        physics = Physics(model, controls, vary, model.nominal)
    if table.guess not in (None, *GUESSES):
        text = unknown("guess", table.guess, GUESSES)
        raise file.located.error(text, "trajectory", "guess")
    with file.located("trajectory", "duration"):
        duration = duration_of(table.duration)
    method = make_method(file, model, TRAJECTORY_METHODS, table.method, "trajectory", "method")
    with file.located("trajectory", "method"):
        method.transcription(physics, duration)
    return {
        **_objective_and_limits(file, model, table),
        **{"controls": controls, "vary": vary, "duration": duration, "accuracy": table.accuracy},
        **{"guess": table.guess, "method": method},
        "begin": _conditions(file, model, "begin", table.begin) or None,
        "end": _conditions(file, model, "end", table.end),
        "cyclic": _measures(file, model, table.cyclic),
    }


def _objective_and_limits(file: ModelFile, model: Model, table: Any) -> dict[str, Any]:
    """Objective and limits."""
    quantities = Quantities(file, model)
    if table.minimize == "time" and "time" not in quantities.names:
        objective: Any = Final("time", name="time")
    else:
        objective = quantities.require(table.minimize, "trajectory", "minimize")
    limits = make_limits(file, quantities, table.subject_to, "trajectory", "subject_to")
    with file.located("trajectory", "minimize"):
        check_response(objective)
    for k, limit in enumerate(limits):
        with file.located("trajectory", "subject_to", k):
            check_response(limit)
    return {"minimize": objective, "subject_to": limits}


def _conditions(file: ModelFile, model: Model, key: str, table: dict[str, Any]) -> dict[str, Any]:
    """Measure → value, or bounds; None is no bound."""
    conditions: dict[str, Any] = {}
    for measure, value in table.items():
        with file.located("trajectory", key, measure):
            model.expression(measure)
        bounded = isinstance(value, list)
        conditions[measure] = tuple(_finite_or_none(side) for side in value) if bounded else value
    return conditions


def _finite_or_none(side: float | None) -> float | None:
    return None if side is None or not np.isfinite(side) else side


def _measures(file: ModelFile, model: Model, names: list[str]) -> list[str]:
    for k, name in enumerate(names):
        with file.located("trajectory", "cyclic", k):
            model.expression(name)
    return names
