"""Unknown histories of a file, and what ``[invert]`` asks of them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from dalembert.design.inverse.history import History
from dalembert.design.inverse.smoothing import CHOICES
from dalembert.elements.laws.table import Table
from dalembert.io.decisions.histories import knots_of
from dalembert.io.measures import measure_reader
from dalembert.io.model_file import ModelFile
from dalembert.io.values import constant
from dalembert.text.wording import unknown


def make_inversion(file: ModelFile, model: Any, data: list[Path] | None = None) -> dict[str, Any]:
    """The arguments of ``invert`` that the file gives.

    Parameters
    ----------
    data : file of measurements instead of the file's own

    Raises
    ------
    ModelError
        No ``[invert]``, no histories, or names that cannot work, with their place.
    """
    document: Any = file.document
    asked = getattr(document, "invert", None)
    if asked is None:
        raise file.located.error("is missing; add [invert] with data and measures", "invert")
    if not document.histories:
        cure = "is missing; add e.g. [histories.push] with knots = { end = 1.0, count = 20 }"
        raise file.located.error(cure, "histories")
    if asked.data is None and not data:
        raise file.located.error("give data, a file of measurements", "invert", "data")
    read, measures = measure_reader(file.document), {}
    for column, text in asked.measures.items():
        with file.located("invert", "measures", column):
            measures[column] = read(model, text)
    for k, name in enumerate(asked.vary):
        if name not in model.parameters:
            text = unknown("parameter", name, model.parameters)
            raise file.located.error(text, "invert", "vary", k)
    if asked.order not in (1, 2, 3):
        raise file.located.error(f"is {asked.order}; give 1, 2 or 3", "invert", "order")
    made: dict[str, Any] = {
        "data": str(data[0]) if data else str(file.path.parent / asked.data),
        "measures": measures or None,
        "histories": [_history(file, model, name) for name in document.histories],
        "vary": list(asked.vary),
        "smoothing": _smoothing(file, asked.smoothing),
        "noise": dict(asked.noise),
    }
    return made | {key: getattr(asked, key) for key in ("order", "time", "max_iterations")}


def _smoothing(file: ModelFile, given: Any) -> str | float:
    """The name of a choice, or a number above zero."""
    if given in CHOICES:
        return str(given)
    try:
        value = constant(given)
    except ValueError:
        text = unknown("smoothing", given, CHOICES)
        raise file.located.error(text, "invert", "smoothing") from None
    if not value > 0:
        raise file.located.error(f"is {value:g}; it must be above zero", "invert", "smoothing")
    return value


def _history(file: ModelFile, model: Any, name: str) -> History:
    """A history of a built model, from its parameters."""
    document: Any = file.document
    times = knots_of(document.histories[name])
    found = tuple(model.parameters[f"{name}_{k}"] for k in range(times.size))
    return History(
        name, times, found, Table(times.tolist(), list(found), ends=document.histories[name].ends)
    )
