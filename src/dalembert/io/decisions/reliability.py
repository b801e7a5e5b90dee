"""Reliability and tolerance tasks of a file: ``[reliability]``, ``[[random]]``, ``[tolerance]``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from dalembert.design.reliability.distribution import Distribution
from dalembert.design.reliability.nataf import Nataf
from dalembert.io.analyses import table_options
from dalembert.io.decisions.design_tables import AllocateTable, ToleranceTable, distribution
from dalembert.io.decisions.responses import (
    find_response,
    make_limits,
    make_responses,
    require_parameter,
)
from dalembert.io.model_file import ModelFile
from dalembert.responses.base import Response
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import unknown
from dalembert.units.measured import check_measured


class Responses:
    """Responses of the run of the file; errors state the location."""

    def __init__(self, file: ModelFile, model: ParametricModel):
        self.file, self.responses = file, make_responses(file, model)

    def require(self, name: str, *where: str | int) -> Response:
        """The response of this name."""
        return find_response(self.file, self.responses, name, *where)


def make_reliability(file: ModelFile, model: ParametricModel) -> dict[str, Any]:
    """Arguments of ``reliability`` from ``[reliability]``.

    Raises
    ------
    ModelError
        No ``[reliability]``, nothing random, or invalid numbers; states the location.
    """
    table = file.document.reliability
    if table is None:
        cure = "is missing; add [reliability] with limits, and [[random]] for each random parameter"
        raise file.located.error(cure, "reliability")
    if not table.limits:
        cure = "is empty; give e.g. [{ response = 'stress', upper = 2e8 }]"
        raise file.located.error(cure, "reliability", "limits")
    limits = make_limits(file, Responses(file, model), table.limits, "reliability", "limits")
    random = random_parameters(file, model)
    correlation = correlations(file, random)
    keys = ("system", "method", "starts", "tolerance", "max_iterations")
    return {
        **{"limit_state": limits, "random": random, "correlation": correlation or None},
        **{key: getattr(table, key) for key in (*keys, "samples", "sampling", "rng")},
    }


def make_tolerance(
    file: ModelFile, model: ParametricModel
) -> tuple[dict[str, Any], dict[str, Any] | None]:
    """Arguments of ``tolerance``, and of ``allocate`` if the file requests it.

    Raises
    ------
    ModelError
        No ``[tolerance]``, or invalid names or numbers; states the location.
    """
    table = file.document.tolerance
    if table is None:
        cure = "is missing; add [tolerance] with a response and tolerances = { parameter = 1e-4 }"
        raise file.located.error(cure, "tolerance")
    response = Responses(file, model).require(table.response, "tolerance", "response")
    if not table.tolerances:
        cure = "is empty; give e.g. { l1 = 1e-4 }"
        raise file.located.error(cure, "tolerance", "tolerances")
    for name, width in table.tolerances.items():
        require_parameter(file, model, name, "tolerance", "tolerances", name)
        with file.located("tolerance", "tolerances", name):
            check_measured([width], model.parameters[name].unit, "")
        if not width > 0:
            text = f"is {width:g}; a half width is above zero"
            raise file.located.error(text, "tolerance", "tolerances", name)
    if not table.sigmas > 0:
        text = f"is {table.sigmas:g}; it must be above zero"
        raise file.located.error(text, "tolerance", "sigmas")
    keys = ("tolerances", "sigmas", "second_order", "worst_case", "samples", "rng")
    arguments = {"response": response, **{key: getattr(table, key) for key in keys}}
    return arguments, None if table.allocate is None else _allocation_options(
        file, table, table.allocate, response.declared_unit
    )


def _allocation_options(
    file: ModelFile, table: ToleranceTable, allocate: AllocateTable, unit: str
) -> dict[str, Any]:
    for name in table.tolerances:
        if name not in allocate.costs:
            text = f"has no cost of {name}; give every tolerance one"
            raise file.located.error(text, "tolerance", "allocate", "costs")
    with file.located("tolerance", "allocate", "limit"):
        check_measured([allocate.limit], unit, "")
    for key in ("limit", "exponent"):
        if not getattr(allocate, key) > 0:
            text = f"is {getattr(allocate, key):g}; it must be above zero"
            raise file.located.error(text, "tolerance", "allocate", key)
    options = table_options(allocate)
    options["costs"] = dict(allocate.costs)
    return options


def random_parameters(file: ModelFile, model: ParametricModel) -> dict[str, Distribution]:
    """Random parameter → distribution.

    Raises
    ------
    ModelError
        Nothing is random, or an unknown parameter; states the location.
    """
    tables: list[Any] = file.document.random
    if not tables:
        cure = "is missing; add [[random]] with parameter, type and its numbers"
        raise file.located.error(cure, "random")
    distributions: dict[str, Distribution] = {}
    for k, table in enumerate(tables):
        name = table.parameter
        require_parameter(file, model, name, "random", k, "parameter")
        if name in distributions:
            text = f"{name!r} is random twice; give it one table"
            raise file.located.error(text, "random", k, "parameter")
        with file.located("random", k):
            distributions[name] = _distribution(table)
            distributions[name].check_units(model.parameters[name].unit)
    return distributions


def _distribution(table: Any) -> Distribution:
    options = table_options(table)
    options.pop("parameter", None)
    if "of" in options:
        options["of"] = _distribution(table.of)
    return distribution(table.type)(**options)


def correlations(
    file: ModelFile, random: Mapping[str, Distribution]
) -> dict[tuple[str, str], float]:
    """Pair of random parameters → correlation coefficient, from ``[reliability]``.

    Raises
    ------
    ModelError
        An unknown name, or invalid correlations; states the location.
    """
    coefficients: dict[tuple[str, str], float] = {}
    reliability = file.document.reliability
    for k, table in enumerate([] if reliability is None else reliability.correlation):
        for j, name in enumerate(table.between):
            if name not in random:
                text = unknown("random parameter", name, random)
                raise file.located.error(text, "reliability", "correlation", k, "between", j)
        first, second = table.between
        coefficients[first, second] = float(table.value)
    with file.located("reliability", "correlation"):
        Nataf(random, coefficients)
    return coefficients
