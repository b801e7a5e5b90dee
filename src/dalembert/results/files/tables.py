"""Tables of pages and CSV files: units of headings, parameters, statistics and diagnosis."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import AnalysisError, ModelError
from dalembert.results.status import Status
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.units.unit import shown_in, unit

if TYPE_CHECKING:
    import pandas as pd


def checked_units(units: Sequence[str]) -> tuple[str, ...]:
    """Preferred units of results, one per dimension.

    Raises
    ------
    AnalysisError
        An unknown unit.
    """
    names = (units,) if isinstance(units, str) else tuple(units)
    for text in names:
        try:
            unit(text)
        except ModelError as error:
            raise AnalysisError(f"units: {error.message}") from None
    return names


def preferred_units(
    si_units: Iterable[str], preferred: Sequence[str]
) -> dict[str, tuple[float, str]]:
    """SI unit → factor and name of the preferred unit, if there is one."""
    converted = {si: shown_in(si, checked_units(preferred)) for si in sorted(si_units)}
    return {si: conversion for si, conversion in converted.items() if conversion[1] != si}


def with_unit_headings(
    table: pd.DataFrame, si: Mapping[str, str], units: Sequence[str]
) -> pd.DataFrame:
    """The table in preferred units, which are added to the column headings.

    Parameters
    ----------
    si : name of a column → SI unit of its numbers
    units : preferred units, such as ``["mm", "deg"]``; each applies to its dimension
    """
    preferred, columns = checked_units(units), {}
    for name in table.columns:
        factor, label = shown_in(si.get(name, ""), preferred)
        heading = f"{name} [{label}]" if label and label != "1" else str(name)
        columns[heading] = table[name] if factor == 1.0 else table[name] / factor
    import pandas as pd

    result = pd.DataFrame(columns, index=table.index)
    if table.index.name == "time":
        factor, label = shown_in("s", preferred)
        result.index = pd.Index(table.index.to_numpy() / factor, name=f"time [{label}]")
    return result


def diagnosis(
    summary: str,
    items: Iterable[tuple[str, Any]],
    messages: Iterable[tuple[str, str]],
    status: Status | None = None,
) -> dict[str, Any]:
    """Diagnosis of a page: labelled values, and messages by level; the status comes first."""
    entries = list(messages)
    if status is not None:
        entries.insert(0, ("info" if status.success else "error", str(status)))
    return {
        "summary": summary,
        "items": [{"label": label, "value": str(value)} for label, value in items],
        "messages": [{"level": level, "text": text} for level, text in entries],
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

    Each is converted to the first of ``units`` that fits, else to the unit of its declaration.
    """
    rows = []
    for parameter, value in zip(parameters.values(), values, strict=False):
        declared = [parameter.declared_unit] if parameter.declared_unit else []
        factor, unit = shown_in(parameter.unit, [*checked_units(units), *declared])
        lower, upper = (None if b is None else b / factor for b in parameter.bounds)
        row = {"name": parameter.name, "value": float(value) / factor, "unit": unit}
        rows.append(row | {"lower": lower, "upper": upper, "description": parameter.description})
    return rows
