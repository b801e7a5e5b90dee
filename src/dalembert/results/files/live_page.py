"""Live pages: payloads with a module that computes the result for other parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.results.files.live_responses import PageResponse, joint_rows, page_responses
from dalembert.results.labelled import LabelledRecording
from dalembert.results.live import Row
from dalembert.units.unit import shown_in

MAX_BYTES = 300_000
"""Upper limit of the size of a module that a page contains without a request."""


def live_page(
    motion: LabelledRecording,
    page: dict[str, Any],
    live: bool | None,
    responses: Sequence[PageResponse] = (),
) -> dict[str, Any]:
    """A page with its live part, or with the reason why it has none.

    Parameters
    ----------
    motion : the result
    page : its payload
    live : whether the page computes; by default if the model has parameters with bounds and its
        module is small
    responses : responses that the page lists, by default the maxima of the plotted series
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
    columns, rows, numbers = _rows(motion, page)

    def row_of(name: str, row: Row) -> int:
        if name not in numbers:
            numbers[name] = len(rows)
            rows.append(row)
        return numbers[name]

    times = np.array(page["time"])
    listed = page_responses(motion, responses, times, row_of)
    try:
        functions = motion.analysis.live_functions(motion, rows, times)
        module = functions.module
    except UnsupportedError as error:
        return page | {"live": {"reason": str(error)}}
    if live is None and len(module.code) > MAX_BYTES:
        size = f"{len(module.code) / 1e3:.0f} kB"
        return page | {"live": {"reason": f"its module has {size}; request it by live=True"}}
    parameters = _parameters(motion, page["parameters"])
    more = {"responses": listed, "joints": joint_rows(model)}
    return page | {"live": functions.page_data(columns=columns, parameters=parameters, **more)}


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


def _rows(
    motion: LabelledRecording, page: dict[str, Any]
) -> tuple[list[Any], list[Row], dict[str, int]]:
    """Places of columns in the payload with the numbers of their rows; rows; numbers by name."""
    model = motion.model
    columns: list[Any] = []
    rows: list[Row] = []
    numbers: dict[str, int] = {}

    def put(path: list[Any], name: str, row: Row, factor: float = 1.0) -> None:
        if name not in numbers:
            numbers[name] = len(rows)
            rows.append(row)
        columns.append([path, numbers[name], factor])

    total = model.expression("kinetic_energy").sx + model.expression("potential_energy").sx
    zero = ca.SX(0)
    special = {
        "energy": Row(total),
        "dissipated_energy": Row(zero, (1.0, 0.0), True),
        "input_energy": Row(zero, (0.0, 1.0), True),
        "balance_error": Row(total, (1.0, -1.0), True),
    }
    for k, series in enumerate(page["series"]):
        name = series["name"]
        if name.endswith("_violation"):
            continue
        row = special[name] if name in special else Row(model.expression(name).sx)
        unit = "J" if name in special else model.expression(name).unit
        put(["series", k, "values"], name, row, shown_in(unit, [series["unit"]])[0])
    for k, body in enumerate(page["scene"]["bodies"]):
        for coordinate in ("x", "y", "angle"):
            name = f"{body['name']}.{coordinate}"
            put(["scene", "bodies", k, coordinate], name, Row(model.expression(name).sx))
    return columns, rows, numbers
