"""The responses of a file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca

from dalembert.errors import ExpressionError, ModelError
from dalembert.io.analyses import table_options
from dalembert.io.measures import measure_reader
from dalembert.io.model_file import ModelFile
from dalembert.io.strategies import RESPONSES
from dalembert.responses.base import Response, combined_terms
from dalembert.responses.events import AtEvent
from dalembert.symbolic.formulas.expression import Expression, stack
from dalembert.symbolic.formulas.parser import parse_formula
from dalembert.text.wording import nearest, unknown


def make_responses(file: ModelFile, model: Any) -> dict[str, Response]:
    """The responses of the run that the file asks for, by name; not those of its cases.

    Combinations that are sums of these, with factors, are among them.

    Raises
    ------
    ModelError
        A measure or an option that cannot work, with its place.
    """
    tables: dict[str, Any] = file.document.responses
    read = measure_reader(file.document)
    analysis = file.document.analysis
    made = {
        name: make_response(file, model, name, table, read, analysis)
        for name, table in tables.items()
        if getattr(table, "case", None) is None
    }
    return made | _linear_combinations(file, made)


def _linear_combinations(file: ModelFile, made: dict[str, Response]) -> dict[str, Response]:
    """Those of the file's combinations that are sums of responses of its own run."""
    symbols = {name: Expression(ca.SX.sym(name), name) for name in made}
    x = stack(symbol.sx for symbol in symbols.values())
    found: dict[str, Response] = {}
    for name, table in getattr(file.document, "combined", {}).items():
        try:
            formula = parse_formula(table.formula, symbols.get, lambda: list(symbols)).sx
        except ExpressionError:  # of other cases or of other combinations; designs know them
            continue
        slopes, rest = ca.Function("f", [x], [ca.gradient(formula, x), formula])(0.0)
        if name in made or not ca.is_linear(formula, x):
            continue
        terms = [(float(slopes[k]), made[own]) for k, own in enumerate(made) if float(slopes[k])]
        if terms:
            total = combined_terms([*terms, (1.0, float(rest))])
            found[name] = total.named(name)
    return found


def make_response(
    file: ModelFile,
    model: Any,
    name: str,
    table: Any,
    read: Callable[[Any, str], Expression],
    analysis: Any,
) -> Response:
    """One of them.

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
        made: Response = RESPONSES[table.type](**options)
    if isinstance(made, AtEvent):
        _check_event(file, table.event, analysis, "responses", name, "event")
    return made


def _check_event(file: ModelFile, name: str, analysis: Any, *where: str) -> None:
    known = getattr(analysis, "events", None) or {}
    if name not in known:
        raise file.located.error(
            f"unknown event {name!r}{nearest(name, known)}; known in the events of its analysis: "
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
        if name in file.document.responses:
            raise file.located.error(f"{name!r} belongs to a case; take one without", *where)
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
