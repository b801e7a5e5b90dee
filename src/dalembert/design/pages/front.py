"""Page of a Pareto front: parameters and mechanism of the selected point."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.pages.decision import alternative, plain_page, thinned, with_views
from dalembert.design.pages.live import LiveTask, responses_of
from dalembert.report import views
from dalembert.results.live import PageDesigns

if TYPE_CHECKING:
    from dalembert.design.pareto.pareto_result import ParetoResult

MAX_MATRIX = 6
"""Upper limit of the aims of which all pairs are drawn."""


def front_page(front: ParetoResult, **first_view: Any) -> dict[str, Any]:
    """Page of a ``ParetoResult``."""
    first = front.result(0) if len(front) else None
    if first is None:
        return plain_page(front)
    page = thinned(first.page(**first_view), len(front))
    page = with_views(page, front, "front")
    page["designs"]["alternatives"] = [
        alternative(front.result(k), page, **first_view) for k in range(len(front))
    ]
    return page


def front_task(front: ParetoResult) -> LiveTask | None:
    """Points of a ``ParetoResult`` in a live page, which shows the knee first."""
    result = front.result(_knee(front)) if len(front) else None
    if result is None or not front.quantities:
        return None
    case = front.quantities[0].terms[0].case
    own = [name in case.model.parameters for name in front.names]
    names = [name for name, is_own in zip(front.names, own, strict=True) if is_own]
    return LiveTask(
        result,
        lambda **first_view: with_views(result.page(**first_view), front, "front"),
        PageDesigns(names, front.designs[:, own]),
        responses_of(front.quantities, case),
    )


def front_designs(front: ParetoResult) -> dict[str, Any]:
    """Table of the points; the knee is selected first."""
    units = front.parameter_units or [""] * len(front.names)
    aims = zip(front.labels, front.units, front.values.T, strict=True)
    parameters = zip(front.names, units, front.designs.T, strict=True)
    columns = [(name, unit, "aim", values) for name, unit, values in aims]
    columns += [(name, unit, "parameter", values) for name, unit, values in parameters]
    return views.designs(columns, chosen=_knee(front))


def _knee(front: ParetoResult) -> int:
    return knee(front.values * np.asarray(front.senses))


def knee(values: np.ndarray) -> int:
    """Index of the point nearest to the ideal point, with aims scaled by their ranges."""
    if not len(values):
        return 0
    span = np.ptp(values, axis=0)
    unit = (values - values.min(axis=0)) / np.where(span > 0, span, 1.0)
    return int(np.argmin(np.linalg.norm(unit, axis=1)))


def front_views(front: ParetoResult) -> list[dict[str, Any]]:
    """Front, parallel coordinates, scatter matrix, table and facts."""
    better = ["less" if sense > 0 else "more" for sense in front.senses]
    payload = [
        views.of_designs(
            "front", "Front", x=0, y=1, better=better, place="board", note="Click, or use ← →."
        ),
        views.of_designs("parallel", "All aims and parameters", place="board"),
    ]
    if 2 < len(front.labels) <= MAX_MATRIX:
        payload.append(views.of_designs("matrix", "Pairs of aims", role="aim"))
    payload.append(views.of_designs("table", "Designs"))
    rows = [("designs", len(front)), ("runs", front.runs), ("gradients", front.gradients)]
    payload.append(views.facts("Search", [*rows, ("found by", front.message)]))
    return payload
