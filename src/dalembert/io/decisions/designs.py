"""What a file asks of a design: the arguments of ``optimize`` and ``pareto``."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from dalembert.design.limit import Limit
from dalembert.design.variables import Catalogue, Integer
from dalembert.io.decisions.cases import Quantities
from dalembert.io.decisions.random import correlations, random_parameters
from dalembert.io.decisions.responses import chosen_parameters
from dalembert.io.model_file import ModelFile
from dalembert.responses.base import Response
from dalembert.units.measured import check_measured

SEARCH = ("method", "gradient", "max_iterations", "tolerance")


def make_design(file: ModelFile, model: Any) -> dict[str, Any]:
    """The arguments of ``optimize`` that the file gives; with ``beta`` of ``optimize_reliable``.

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
    sense = "minimize" if asked.minimize else "maximize"
    made = Quantities(file, model)
    design = {sense: made.checked(getattr(asked, sense), "optimize", sense)}
    design |= _limits_and_variables(file, model, made, "optimize")
    design[sense] = made.finished(design[sense])
    if asked.beta is not None:
        design |= _reliable(file, model, asked, design["subject_to"])
    return design | {key: getattr(asked, key) for key in SEARCH}


def _reliable(file: ModelFile, model: Any, asked: Any, limits: list[Limit]) -> dict[str, Any]:
    """What ``optimize_reliable`` is given beside."""
    if not asked.beta > 0:
        raise file.located.error(f"is {asked.beta:g}; it must be above zero", "optimize", "beta")
    if not limits:
        cure = "is empty; give the limits that shall hold with beta"
        raise file.located.error(cure, "optimize", "subject_to")
    for k, limit in enumerate(limits):
        if not isinstance(limit.response, Response):
            text = "a limit with a reliability is that of one response of this run"
            raise file.located.error(text, "optimize", "subject_to", k, "response")
    random = random_parameters(file, model)
    correlation = correlations(file, random) or None
    made = {"beta": float(asked.beta), "rounds": asked.rounds}
    return made | {"random": random, "correlation": correlation}


def make_front(file: ModelFile, model: Any) -> dict[str, Any]:
    """The arguments of ``pareto`` that the file gives.

    Raises
    ------
    ModelError
        No ``[pareto]``, fewer than two aims, or names and limits that cannot work.
    """
    asked = file.document.pareto
    if asked is None:
        cure = "is missing; add [pareto] with minimize = [two responses]"
        raise file.located.error(cure, "pareto")
    if len(asked.minimize) + len(asked.maximize) < 2:
        raise file.located.error("give two aims or more in minimize and maximize", "pareto")
    made = Quantities(file, model)
    design: dict[str, Any] = {
        sense: [
            made.checked(name, "pareto", sense, k) for k, name in enumerate(getattr(asked, sense))
        ]
        for sense in ("minimize", "maximize")
    }
    if asked.points < 2:
        raise file.located.error(f"is {asked.points}; give two or more", "pareto", "points")
    if asked.starts < 1:
        raise file.located.error(f"is {asked.starts}; give one or more", "pareto", "starts")
    design |= _limits_and_variables(file, model, made, "pareto")
    for sense in ("minimize", "maximize"):
        design[sense] = [made.finished(one) for one in design[sense]]
    keys = (*SEARCH, "points", "local", "starts", "generations", "rng")
    return design | {key: getattr(asked, key) for key in keys}


def make_limits(file: ModelFile, made: Any, tables: list[Any], *where: str) -> list[Limit]:
    """Limits on responses; ``made.checked(name, …)`` gives each response."""
    limits = []
    for k, table in enumerate(tables):
        here: tuple[str | int, ...] = (*where, k)
        response = made.checked(table.response, *here, "response")
        with file.located(*here):
            limits.append(Limit(response, table.lower, table.upper))
    return limits


def _limits_and_variables(
    file: ModelFile, model: Any, made: Quantities, section: str
) -> dict[str, Any]:
    asked: Any = getattr(file.document, section)
    limits = make_limits(file, made, asked.subject_to, section, "subject_to")
    vary = asked.vary or [n for n, p in model.parameters.items() if np.all(np.isfinite(p.bounds))]
    if not vary:
        raise file.located.error(
            "name the parameters to vary, or give some bounds", section, "vary"
        )
    own = [n for n in vary if n in file.document.parameters]
    others = {n for case in made.models for n in case.parameters}
    for k, name in enumerate(vary):
        if name not in others or name in vary[:k]:  # tells which, and what there is
            chosen_parameters(file, vary, section, "vary")
    chosen_parameters(file, own, section, "vary")
    limits = [replace(limit, response=made.finished(limit.response)) for limit in limits]
    return {"subject_to": limits, "vary": _with_sizes(file, model, vary, section)}


def _with_sizes(file: ModelFile, model: Any, vary: list[str], section: str) -> list[Any]:
    """What varies, with whole numbers and catalogues in place of their names."""
    asked: Any = getattr(file.document, section)
    integers = chosen_parameters(file, asked.integers, section, "integers")
    whole = integers if asked.integers else []
    made: dict[str, Any] = {name: Integer(name) if name in whole else name for name in vary}
    made |= {name: Integer(name) for name in whole}
    for k, columns in enumerate(asked.catalogues):
        names = chosen_parameters(file, list(columns), section, "catalogues", k)
        for name, values in columns.items():
            with file.located(section, "catalogues", k, name):
                check_measured(values, model.parameters[name].unit, "")
        for name in names[1:]:
            made.pop(name, None)
        made[names[0]] = Catalogue(columns)
    return list(made.values())
