"""Live pages: payloads with a module that computes the result for other parameters."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.model.graph.absolute import at_ground
from dalembert.results.labelled import LabelledRecording
from dalembert.results.live import Row
from dalembert.results.sources import Place, Sources, payload_sources

MAX_BYTES = 300_000
"""Upper limit of the size of a module that a page contains without a request."""


def live_page(motion: LabelledRecording, page: dict[str, Any], live: bool | None) -> dict[str, Any]:
    """A page with its live part, or with the reason why it has none.

    Parameters
    ----------
    motion : the result
    page : its payload
    live : whether the page computes; by default if the model has parameters with bounds and its
        module is small
    """
    model = motion.model
    bounded = any(None not in parameter.bounds for parameter in model.parameters.values())
    if live is False or not (bounded or live):
        return page
    if not model.parameters:
        return page | {"live": {"reason": "the model has no parameters"}}
    reason = motion.analysis.live_obstacle(motion)
    if reason:
        return page | {"live": {"reason": reason}}
    sources = payload_sources(page)
    columns, rows = _rows(sources, model.ground)
    try:
        functions = motion.analysis.live_functions(motion, rows, np.array(page["time"]))
        functions = functions.with_numbers([sx for _, sx in sources.numbers], model.equations.p)
        module = functions.module
    except UnsupportedError as error:
        return page | {"live": {"reason": str(error)}}
    if live is None and len(module.code) > MAX_BYTES:
        size = f"{len(module.code) / 1e3:.0f} kB"
        return page | {"live": {"reason": f"its module has {size}; request it by live=True"}}
    parameters = _parameters(motion, page["parameters"])
    numbers = [place for place, _ in sources.numbers]
    more = {"columns": columns, "numbers": numbers, "initial": sources.initial}
    return page | {"live": functions.page_data(parameters=parameters, **more)}


def _parameters(motion: LabelledRecording, shown: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Parameters with values and bounds in SI units, and the factor of the unit that is shown."""
    rows = []
    for parameter, value, row in zip(
        motion.model.parameters.values(), motion.parameters, shown, strict=False
    ):
        lower, upper = parameter.bounds
        factor = parameter.value / row["value"] if row["value"] else 1.0
        rows.append(row | {"value": float(value), "lower": lower, "upper": upper, "factor": factor})
    return rows


def _rows(sources: Sources, ground: Any) -> tuple[list[tuple[Place, int]], list[Row]]:
    """Places of columns in the payload with the numbers of their rows, and the distinct rows."""
    rows: dict[Any, Row] = {}
    numbers: dict[Any, int] = {}
    columns = []
    for place, source in sources.columns:
        if isinstance(source, ca.SX):
            row = Row(source)
        else:
            row = Row(source.sx, source.work, source.relative)
        key = (row.expression.element_hash(), row.work, row.relative)
        if key not in rows:
            rows[key] = replace(row, expression=at_ground(ground, row.expression))
        columns.append((place, numbers.setdefault(key, len(numbers))))
    return columns, list(rows.values())
