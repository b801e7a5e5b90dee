"""Parts that the pages of all results have: what is told, numbers, parameters."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from dalembert.results.files.headings import checked_units
from dalembert.results.status import Status
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.units.unit import shown_in


def diagnosis(
    summary: str,
    items: Iterable[tuple[str, Any]],
    messages: Iterable[tuple[str, str]],
    status: Status | None = None,
) -> dict[str, Any]:
    """What is told of a model: labelled values, and messages by level; a status comes first."""
    told = list(messages)
    if status is not None:
        told.insert(0, ("info" if status.success else "error", str(status)))
    return {
        "summary": summary,
        "items": [{"label": label, "value": str(value)} for label, value in items],
        "messages": [{"level": level, "text": text} for level, text in told],
    }


def statistics(rows: Iterable[tuple[Any, Any]]) -> list[dict[str, str]]:
    """Labelled numbers."""
    return [
        {"label": str(k), "value": f"{v:.6g}" if isinstance(v, float) else str(v)} for k, v in rows
    ]


def parameter_rows(
    parameters: Mapping[str, Parameter], values: np.ndarray, units: Sequence[str] = ()
) -> list[dict[str, Any]]:
    """Parameters with their values and bounds.

    Each is in the first of ``units`` that fits, else in the unit of its declaration.
    """
    rows = []
    for parameter, value in zip(parameters.values(), values, strict=False):
        own = [parameter.given_unit] if parameter.given_unit else []
        factor, unit = shown_in(parameter.unit, [*checked_units(units), *own])
        lower, upper = (None if b is None else b / factor for b in parameter.bounds)
        row = {"name": parameter.name, "value": float(value) / factor, "unit": unit}
        rows.append(row | {"lower": lower, "upper": upper, "description": parameter.description})
    return rows
