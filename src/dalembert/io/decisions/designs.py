"""Optimisation tasks of a file: ``[optimize]`` and ``[pareto]``."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from dalembert.design.limit import Limit
from dalembert.design.variables import Catalogue, Integer, Variable
from dalembert.io.decisions.cases import Quantities
from dalembert.io.decisions.design_tables import OptimizeTable
from dalembert.io.decisions.reliability import correlations, random_parameters
from dalembert.io.decisions.responses import make_limits, select_parameters
from dalembert.io.model_file import ModelFile
from dalembert.responses.base import Response
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.units.measured import check_measured

SEARCH = ("method", "gradient", "max_iterations", "tolerance")


def make_design(file: ModelFile, model: ParametricModel) -> dict[str, Any]:
    """Arguments of ``optimize`` from ``[optimize]``; with ``beta``, of ``optimize_reliable``.

    Raises
    ------
    ModelError
        No ``[optimize]``, or invalid names or limits.
    """
    table = file.document.optimize
    if table is None:
        raise file.located.error(
            "is missing; add [optimize] with minimize = a response", "optimize"
        )
    if (table.minimize is None) == (table.maximize is None):
        raise file.located.error("give one objective: minimize or maximize", "optimize")
    sense = "minimize" if table.minimize else "maximize"
    quantities = Quantities(file, model)
    design: dict[str, Any] = {sense: quantities.require(getattr(table, sense), "optimize", sense)}
    design |= _limits_and_variables(file, model, quantities, "optimize")
    design[sense] = quantities.bind(design[sense])
    if table.beta is not None:
        design |= _reliability_arguments(file, model, table, design["subject_to"])
    return design | {key: getattr(table, key) for key in SEARCH}


def _reliability_arguments(
    file: ModelFile, model: ParametricModel, table: OptimizeTable, limits: list[Limit]
) -> dict[str, Any]:
    """Additional arguments of ``optimize_reliable``."""
    if not table.beta > 0:
        raise file.located.error(f"is {table.beta:g}; it must be above zero", "optimize", "beta")
    if not limits:
        cure = "is empty; give the limits that must hold with beta"
        raise file.located.error(cure, "optimize", "subject_to")
    for k, limit in enumerate(limits):
        if not isinstance(limit.response, Response):
            text = "a limit with a reliability must refer to a response of this run"
            raise file.located.error(text, "optimize", "subject_to", k, "response")
    random = random_parameters(file, model)
    correlation = correlations(file, random) or None
    arguments = {"beta": float(table.beta), "rounds": table.rounds}
    return arguments | {"random": random, "correlation": correlation}


def make_front(file: ModelFile, model: ParametricModel) -> dict[str, Any]:
    """Arguments of ``pareto`` from ``[pareto]``.

    Raises
    ------
    ModelError
        No ``[pareto]``, fewer than two objectives, or invalid names or limits.
    """
    table = file.document.pareto
    if table is None:
        cure = "is missing; add [pareto] with minimize = [two responses]"
        raise file.located.error(cure, "pareto")
    if len(table.minimize) + len(table.maximize) < 2:
        raise file.located.error("give two or more objectives in minimize and maximize", "pareto")
    quantities = Quantities(file, model)
    design: dict[str, Any] = {
        sense: [
            quantities.require(name, "pareto", sense, k)
            for k, name in enumerate(getattr(table, sense))
        ]
        for sense in ("minimize", "maximize")
    }
    if table.points < 2:
        raise file.located.error(f"is {table.points}; give two or more", "pareto", "points")
    if table.starts < 1:
        raise file.located.error(f"is {table.starts}; give one or more", "pareto", "starts")
    design |= _limits_and_variables(file, model, quantities, "pareto")
    for sense in ("minimize", "maximize"):
        design[sense] = [quantities.bind(quantity) for quantity in design[sense]]
    keys = (*SEARCH, "points", "local", "starts", "generations", "rng")
    return design | {key: getattr(table, key) for key in keys}


def _limits_and_variables(
    file: ModelFile, model: ParametricModel, quantities: Quantities, section: str
) -> dict[str, Any]:
    table: Any = getattr(file.document, section)
    limits = make_limits(file, quantities, table.subject_to, section, "subject_to")
    vary = table.vary or [n for n, p in model.parameters.items() if np.all(np.isfinite(p.bounds))]
    if not vary:
        raise file.located.error(
            "name the parameters to vary, or give some bounds", section, "vary"
        )
    own_names = [n for n in vary if n in file.document.parameters]
    available = {n for case in quantities.models for n in case.parameters}
    for k, name in enumerate(vary):
        if name not in available or name in vary[:k]:  # raises with the name and the choices
            select_parameters(file, vary, section, "vary")
    select_parameters(file, own_names, section, "vary")
    limits = [replace(limit, response=quantities.bind(limit.response)) for limit in limits]
    return {"subject_to": limits, "vary": _variables(file, model, vary, section)}


def _variables(
    file: ModelFile, model: ParametricModel, vary: list[str], section: str
) -> list[Variable]:
    """Design variables: names, integers and catalogues."""
    table: Any = getattr(file.document, section)
    integers = select_parameters(file, table.integers, section, "integers")
    whole = integers if table.integers else []
    variables: dict[str, Variable] = {
        name: Integer(name) if name in whole else name for name in vary
    }
    variables |= {name: Integer(name) for name in whole}
    for k, columns in enumerate(table.catalogues):
        names = select_parameters(file, list(columns), section, "catalogues", k)
        for name, values in columns.items():
            with file.located(section, "catalogues", k, name):
                check_measured(values, model.parameters[name].unit, "")
        for name in names[1:]:
            variables.pop(name, None)
        variables[names[0]] = Catalogue(columns)
    return list(variables.values())
