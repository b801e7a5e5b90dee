"""The responses of a file."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from dalembert.errors import ModelError
from dalembert.io.analyses import given_options
from dalembert.io.measures import measure_reader
from dalembert.io.model_file import ModelFile
from dalembert.io.strategies import RESPONSES
from dalembert.responses.base import Response
from dalembert.responses.events import AtEvent
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.wording import nearest, unknown


def make_responses(file: ModelFile, model: Any) -> dict[str, Response]:
    """The responses of the run that the file asks for, by name; not those of its cases.

    Raises
    ------
    ModelError
        A measure or an option that cannot work, with its place.
    """
    tables: dict[str, Any] = file.document.responses
    read = measure_reader(file.document)
    analysis = file.document.analysis
    return {
        name: make_response(file, model, name, table, read, analysis)
        for name, table in tables.items()
        if getattr(table, "case", None) is None
    }


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
        options = given_options(table) | {"measure": measure, "name": name}
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
