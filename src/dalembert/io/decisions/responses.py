"""Measures, responses and limits of a file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import casadi as ca
from pydantic import BaseModel

from dalembert.design.limit import Limit
from dalembert.design.quantity import Objective
from dalembert.errors import ExpressionError, ModelError
from dalembert.io.analyses import table_options
from dalembert.io.decisions.design_tables import LimitTable
from dalembert.io.documents import Document, StructureDocument
from dalembert.io.model_file import ModelFile
from dalembert.io.strategies import RESPONSES
from dalembert.responses.base import Response, combined_terms
from dalembert.responses.events import AtEvent
from dalembert.symbolic.formulas.expression import Expression, stack
from dalembert.symbolic.formulas.parser import parse_formula
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.wording import misspelt, unknown

ReadMeasure = Callable[[ParametricModel, str], Expression]
"""Measure of a model, from its name or formula."""


class NamedQuantities(Protocol):
    """Quantities by name; errors state the location."""

    def require(self, name: str, *where: str | int) -> Objective:
        """The quantity of this name."""
        ...


def measure_reader(document: Document | StructureDocument) -> ReadMeasure:
    """The function ``(model, text) → measure`` for the analysis of a document."""
    if document.analysis is not None:
        return document.analyses[document.analysis.type].expression  # type: ignore[no-any-return]
    return lambda model, text: model.expression(text)


def read_measures(
    file: ModelFile, model: ParametricModel, texts: Mapping[str, str], *where: str
) -> dict[str, Expression]:
    """Name → measure of a table of texts; errors state the location."""
    read, measures = measure_reader(file.document), {}
    for name, text in texts.items():
        with file.located(*where, name):
            measures[name] = read(model, text)
    return measures


def make_responses(file: ModelFile, model: ParametricModel) -> dict[str, Response]:
    """Responses of the run of the file, by name, without those of its cases.

    Linear combinations of these responses are included.

    Raises
    ------
    ModelError
        An invalid measure or option; states the location.
    """
    tables: dict[str, Any] = file.document.responses
    read = measure_reader(file.document)
    analysis = file.document.analysis
    responses = {
        name: make_response(file, model, name, table, read, analysis)
        for name, table in tables.items()
        if getattr(table, "case", None) is None
    }
    return responses | _linear_combinations(file, responses)


def _linear_combinations(file: ModelFile, responses: dict[str, Response]) -> dict[str, Response]:
    """Combinations that are linear in the responses of the run of the file."""
    symbols = {name: Expression(ca.SX.sym(name), name) for name in responses}
    x = stack(symbol.sx for symbol in symbols.values())
    combinations: dict[str, Response] = {}
    for name, table in getattr(file.document, "combined", {}).items():
        try:
            formula = parse_formula(table.formula, symbols.get, lambda: list(symbols)).sx
        except ExpressionError:  # refers to other cases or combinations, which designs evaluate
            continue
        slopes, rest = ca.Function("f", [x], [ca.gradient(formula, x), formula])(0.0)
        if name in responses or not ca.is_linear(formula, x):
            continue
        terms = [
            (float(slopes[k]), responses[response_name])
            for k, response_name in enumerate(responses)
            if float(slopes[k])
        ]
        if terms:
            total = combined_terms([*terms, (1.0, float(rest))])
            combinations[name] = total.named(name)
    return combinations


def make_response(
    file: ModelFile,
    model: ParametricModel,
    name: str,
    table: Any,
    read: ReadMeasure,
    analysis: BaseModel | None,
) -> Response:
    """One response.

    Parameters
    ----------
    read : ``(model, text) → measure`` of its run
    analysis : the table of its run
    """
    with file.located("responses", name, "measure"):
        measure = read(model, str(table.measure))
        if len(measure) != 1:
            raise ModelError(f"{table.measure!r} has {len(measure)} components; take .x or .y")
    with file.located("responses", name):
        options = table_options(table) | {"measure": measure, "name": name}
        options.pop("case", None)
        response: Response = RESPONSES[table.type](**options)
    if isinstance(response, AtEvent):
        _check_event(file, table.event, analysis, "responses", name, "event")
    return response


def _check_event(file: ModelFile, name: str, analysis: BaseModel | None, *where: str) -> None:
    events = getattr(analysis, "events", None) or {}
    if name not in events:
        raise file.located.error(
            misspelt(
                f"unknown event {name!r}",
                name,
                events,
                f"; known in the events of its analysis: {', '.join(events) or 'none'}",
            ),
            *where,
        )


def find_response(
    file: ModelFile, responses: dict[str, Response], name: str, *where: str | int
) -> Response:
    """The response of this name.

    Raises
    ------
    ModelError
        Unknown name, or a response of a case.
    """
    if not responses:
        raise file.located.error(
            'has none; add e.g. [responses.peak] with type = "Maximum" and a measure', "responses"
        )
    if name not in responses:
        if name in file.document.responses:
            raise file.located.error(f"{name!r} belongs to a case; take one without", *where)
        raise file.located.error(unknown("response", name, responses), *where)
    return responses[name]


def select_parameters(file: ModelFile, names: list[str] | None, *where: str | int) -> list[str]:
    """Checked names of parameters; all parameters if no names are given."""
    available = list(file.document.parameters)
    if not available:
        raise file.located.error("has no parameters; add at least one", "parameters")
    names = names or []
    for k, name in enumerate(names):
        if name not in available:
            raise file.located.error(unknown("parameter", name, available), *where, k)
        if name in names[:k]:
            raise file.located.error(f"{name!r} is named twice; name it once", *where, k)
    return list(names or available)


def require_parameter(
    file: ModelFile, model: ParametricModel, name: str, *where: str | int
) -> None:
    """Check that a model has a parameter.

    Raises
    ------
    ModelError
        Unknown parameter; states the location.
    """
    if name not in model.parameters:
        raise file.located.error(unknown("parameter", name, model.parameters), *where)


def make_limits(
    file: ModelFile, source: NamedQuantities, tables: Sequence[LimitTable], *where: str
) -> list[Limit]:
    """Limits on responses; ``source.require(name, …)`` returns each response."""
    limits = []
    for k, table in enumerate(tables):
        location: tuple[str | int, ...] = (*where, k)
        response = source.require(table.response, *location, "response")
        with file.located(*location):
            limits.append(Limit(response, table.lower, table.upper))
    return limits
