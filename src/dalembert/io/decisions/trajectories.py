"""What ``[trajectory]`` of a file asks."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.trajectory.optimize_trajectory import duration_of
from dalembert.design.trajectory.physics import Physics
from dalembert.design.trajectory.quantities import check_response
from dalembert.design.trajectory.registry import TRAJECTORY_METHODS
from dalembert.io.analyses import make_method
from dalembert.io.decisions.cases import Quantities
from dalembert.io.decisions.designs import make_limits
from dalembert.io.decisions.responses import chosen_parameters
from dalembert.io.decisions.trajectory_tables import GUESSES
from dalembert.io.model_file import ModelFile
from dalembert.responses.values import Final
from dalembert.text.wording import unknown


def make_trajectory(file: ModelFile, model: Any) -> dict[str, Any]:
    """The arguments of ``optimize_trajectory`` that the file gives.

    Raises
    ------
    ModelError
        No ``[trajectory]``, or names and numbers that cannot work, with their place.
    """
    asked: Any = getattr(file.document, "trajectory", None)
    if asked is None:
        cure = "is missing; add [trajectory] with controls, duration and end"
        raise file.located.error(cure, "trajectory")
    if not asked.controls:
        raise file.located.error("is empty; name parameters of forces", "trajectory", "controls")
    controls = chosen_parameters(file, asked.controls, "trajectory", "controls")
    vary = chosen_parameters(file, asked.vary, "trajectory", "vary") if asked.vary else []
    for k, name in enumerate(vary):
        if name in controls:
            text = f"{name!r} is a control; it cannot vary as well"
            raise file.located.error(text, "trajectory", "vary", k)
    with file.located("trajectory", "controls"):
        physics = Physics(model, controls, vary, model.nominal)
    if asked.guess not in (None, *GUESSES):
        text = unknown("guess", asked.guess, GUESSES)
        raise file.located.error(text, "trajectory", "guess")
    with file.located("trajectory", "duration"):
        duration = duration_of(asked.duration)
    method = make_method(file, model, TRAJECTORY_METHODS, asked.method, "trajectory", "method")
    with file.located("trajectory", "method"):
        method.transcription(physics, duration)
    return {
        **_judged(file, model, asked),
        **{"controls": controls, "vary": vary, "duration": duration, "accuracy": asked.accuracy},
        **{"guess": asked.guess, "method": method},
        "begin": _conditions(file, model, "begin", asked.begin) or None,
        "end": _conditions(file, model, "end", asked.end),
        "cyclic": _measures(file, model, asked.cyclic),
    }


def _judged(file: ModelFile, model: Any, asked: Any) -> dict[str, Any]:
    """Objective and limits."""
    made = Quantities(file, model)
    if asked.minimize == "time" and "time" not in made.names:
        objective: Any = Final("time", name="time")
    else:
        objective = made.checked(asked.minimize, "trajectory", "minimize")
    limits = make_limits(file, made, asked.subject_to, "trajectory", "subject_to")
    with file.located("trajectory", "minimize"):
        check_response(objective)
    for k, limit in enumerate(limits):
        with file.located("trajectory", "subject_to", k):
            check_response(limit)
    return {"minimize": objective, "subject_to": limits}


def _conditions(file: ModelFile, model: Any, key: str, given: dict[str, Any]) -> dict[str, Any]:
    """Measure → value, or bounds of which None is open."""
    made: dict[str, Any] = {}
    for measure, value in given.items():
        with file.located("trajectory", key, measure):
            model.expression(measure)
        bounded = isinstance(value, list)
        made[measure] = tuple(_side(side) for side in value) if bounded else value
    return made


def _side(side: float | None) -> float | None:
    return None if side is None or not np.isfinite(side) else side


def _measures(file: ModelFile, model: Any, names: list[str]) -> list[str]:
    for k, name in enumerate(names):
        with file.located("trajectory", "cyclic", k):
            model.expression(name)
    return names
