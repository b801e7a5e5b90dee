"""What ``[reliability]`` with ``[[random]]``, and ``[tolerance]``, of a file ask."""

from __future__ import annotations

from typing import Any

from dalembert.io.analyses import table_options
from dalembert.io.decisions.designs import make_limits
from dalembert.io.decisions.random import correlations, random_parameters
from dalembert.io.decisions.responses import chosen_response, make_responses
from dalembert.io.model_file import ModelFile
from dalembert.responses.base import Response
from dalembert.text.wording import unknown
from dalembert.units.measured import check_measured


class Responses:
    """The responses of the file's own run, told with their place."""

    def __init__(self, file: ModelFile, model: Any):
        self.file, self.made = file, make_responses(file, model)

    def checked(self, name: str, *where: str | int) -> Response:
        """The one of this name."""
        return chosen_response(self.file, self.made, name, *where)


def make_reliability(file: ModelFile, model: Any) -> dict[str, Any]:
    """The arguments of ``reliability`` that the file gives.

    Raises
    ------
    ModelError
        No ``[reliability]``, nothing random, or numbers that cannot work, with their place.
    """
    asked = file.document.reliability
    if asked is None:
        cure = "is missing; add [reliability] with limits, and [[random]] for each random parameter"
        raise file.located.error(cure, "reliability")
    if not asked.limits:
        cure = "is empty; give e.g. [{ response = 'stress', upper = 2e8 }]"
        raise file.located.error(cure, "reliability", "limits")
    limits = make_limits(file, Responses(file, model), asked.limits, "reliability", "limits")
    random = random_parameters(file, model)
    correlation = correlations(file, random)
    keys = ("system", "method", "starts", "tolerance", "max_iterations")
    return {
        **{"limit_state": limits, "random": random, "correlation": correlation or None},
        **{key: getattr(asked, key) for key in (*keys, "samples", "sampling", "rng")},
    }


def make_tolerance(file: ModelFile, model: Any) -> tuple[dict[str, Any], dict[str, Any] | None]:
    """The arguments of ``tolerance``, and of ``allot`` where the file asks for it.

    Raises
    ------
    ModelError
        No ``[tolerance]``, or names and numbers that cannot work, with their place.
    """
    asked = file.document.tolerance
    if asked is None:
        cure = "is missing; add [tolerance] with a response and tolerances = { parameter = 1e-4 }"
        raise file.located.error(cure, "tolerance")
    response = Responses(file, model).checked(asked.response, "tolerance", "response")
    if not asked.tolerances:
        cure = "is empty; give e.g. { l1 = 1e-4 }"
        raise file.located.error(cure, "tolerance", "tolerances")
    for name, width in asked.tolerances.items():
        if name not in model.parameters:
            text = unknown("parameter", name, model.parameters)
            raise file.located.error(text, "tolerance", "tolerances", name)
        with file.located("tolerance", "tolerances", name):
            check_measured([width], model.parameters[name].unit, "")
        if not width > 0:
            text = f"is {width:g}; a half width is above zero"
            raise file.located.error(text, "tolerance", "tolerances", name)
    if not asked.sigmas > 0:
        text = f"is {asked.sigmas:g}; it must be above zero"
        raise file.located.error(text, "tolerance", "sigmas")
    keys = ("tolerances", "sigmas", "second_order", "worst_case", "samples", "rng")
    made = {"response": response, **{key: getattr(asked, key) for key in keys}}
    return made, None if asked.allot is None else _allot(file, asked, response.known_unit)


def _allot(file: ModelFile, asked: Any, unit: str) -> dict[str, Any]:
    for name in asked.tolerances:
        if name not in asked.allot.costs:
            text = f"has no cost of {name}; give every tolerance one"
            raise file.located.error(text, "tolerance", "allot", "costs")
    with file.located("tolerance", "allot", "limit"):
        check_measured([asked.allot.limit], unit, "")
    for key in ("limit", "exponent"):
        if not getattr(asked.allot, key) > 0:
            text = f"is {getattr(asked.allot, key):g}; it must be above zero"
            raise file.located.error(text, "tolerance", "allot", key)
    options = table_options(asked.allot)
    options["costs"] = dict(asked.allot.costs)
    return options
