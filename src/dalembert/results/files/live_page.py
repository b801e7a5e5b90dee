"""Live pages: payloads with a module that computes the result for other parameters."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.results.files.live_responses import (
    in_units,
    joint_rows,
    page_responses,
    state_rows,
)
from dalembert.results.live import PageDesigns, PageResponse
from dalembert.results.row_table import RowTable
from dalembert.results.sources import payload_sources
from dalembert.units.unit import shown_in

MAX_BYTES = 300_000
"""Upper limit of the size of a module that a page contains without a request."""


def live_page(
    result: Any,
    page: dict[str, Any],
    live: bool | None,
    responses: Sequence[PageResponse] = (),
    designs: PageDesigns | None = None,
    units: Sequence[str] = (),
    max_bytes: int | None = None,
) -> dict[str, Any]:
    """A page with its live part, or with the reason why it has none.

    Parameters
    ----------
    result : result of an analysis with a page
    page : its payload
    live : whether the page computes; by default if the model has parameters with bounds, or the
        designs have ranges, and its module is small
    responses : responses that the page lists
    designs : designs of its table
    units : preferred units of the responses
    max_bytes : upper limit of the size of a module that is not requested by ``live``
    """
    model, limit = result.model, max_bytes or MAX_BYTES
    bounded = any(np.isfinite(parameter.bounds).all() for parameter in model.parameters.values())
    bounded = bounded or (designs is not None and bool(designs.ranges))
    bounded = bounded or any("drawn" in row for row in page.get("parameters", ()))
    if live is False or not (bounded or live):
        return page
    if not model.parameters:
        return page | {"live": {"reason": "the model has no parameters"}}
    reason = result.analysis.live_obstacle(result)
    if reason:
        return page | {"live": {"reason": reason}}
    sources = payload_sources(page)
    structure = model.kind == "structure"
    table = RowTable(None if structure else model.ground)
    columns = [(place, table.number(source)) for place, source in sources.columns]
    times = result.page_times(page, responses)
    listed = page_responses(result, responses, times, table.number)
    listed = listed or [response.page_data(table.number) for response in result.first_responses()]
    extras = result.page_extras(table.number, listed)
    listed = [in_units(response, units) for response in listed]
    drawn = structure and result.of_any_size
    states = [(place, state_rows(sx, table.number, drawn)) for place, sx in sources.states]
    blocks = [(place, state_rows(sx, table.number, True)) for place, sx in sources.blocks]
    try:
        functions = result.analysis.live_functions(result, table.rows, times)
        p = model.p if structure else model.equations.p
        functions = functions.with_limits(*model.value_limits())
        functions = functions.with_numbers([sx for _, sx in sources.numbers], p)
        size = functions.source.smallest_size
        if live is None and size > limit:
            raise UnsupportedError(_too_large(f"at least {size / 1e3:.0f} kB"))
        size = len(functions.module.code)
        if live is None and size > limit:
            raise UnsupportedError(_too_large(f"{size / 1e3:.0f} kB"))
    except UnsupportedError as error:
        return page | {"live": {"reason": str(error)}}
    parameters = _parameters(result, page["parameters"])
    rows = None if designs is None else _designs(result, designs, parameters)
    numbers = [place for place, _ in sources.numbers]
    more = {"columns": columns, "numbers": numbers, "initial": sources.initial, "states": states}
    more |= {"responses": listed, "joints": [] if structure else joint_rows(model)}
    more |= {"blocks": blocks} if blocks else {}
    more |= extras
    more |= {} if rows is None else {"designs": rows}
    return page | {"live": functions.page_data(parameters=parameters, **more)}


def _too_large(size: str) -> str:
    return f"its module has {size}; request it by live=True"


def _parameters(result: Any, shown: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Parameters with values and bounds in SI units, and the factor of the unit that is shown."""
    rows = []
    for parameter, value, row in zip(
        result.model.parameters.values(), result.parameters, shown, strict=False
    ):
        lower, upper = (bound if np.isfinite(bound) else None for bound in parameter.bounds)
        factor, _ = shown_in(parameter.unit, [row["unit"]] if row["unit"] else [])
        rows.append(row | {"value": float(value), "lower": lower, "upper": upper, "factor": factor})
    return rows


def _designs(
    motion: Any, designs: PageDesigns, parameters: list[dict[str, Any]]
) -> list[list[float]]:
    """All parameters of the designs; their ranges include the designs, initial values are set."""
    names = list(motion.model.parameters)
    rows = designs.rows(names, np.asarray(motion.parameters, dtype=float))
    for row, column in zip(parameters, rows.T, strict=True):
        row["varies"] = row["name"] in designs.names
        if designs.initial is not None:
            row["value"] = float(column[designs.initial])
        row["lower"], row["upper"] = designs.ranges.get(row["name"], (row["lower"], row["upper"]))
        finite = column[np.isfinite(column)]
        for side, pick in (("lower", min), ("upper", max)):
            if row[side] is not None and finite.size:
                row[side] = float(pick(row[side], *finite))
    return [list(row) for row in rows.tolist()]
