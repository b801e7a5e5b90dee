"""The page of a synthesis: mechanisms to choose from, what they shall do and what they do."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.pages.alternatives import CHANGING
from dalembert.design.pages.plain import plain_page, with_views
from dalembert.report import views

SHOWN = 12
"""Mechanisms that a page has."""
DOT = 0.012
"""Radius of a point of the target, of the size of the whole."""


def synthesis_page(found: Any, **first_view: Any) -> dict[str, Any]:
    """What the report of ``Candidates`` shows."""
    pages = [_candidate_page(found, s) for s in found.solutions[:SHOWN]]
    first = next((page for page in pages if page is not None), None)
    if first is None:
        return plain_page(found)
    page = with_views(dict(first), found, "candidates")
    page["title"], page["subtitle"] = f"{found.name}: candidates", found.message
    kept = CHANGING[page["kind"]]
    page["designs"]["alternatives"] = [
        {} if other is None else {k: other[k] for k in (*kept, "parameters") if k in other}
        for other in pages
    ]
    there = {series["name"] for series in page["series"]}
    page["default_plots"] = [[m] for m in found.best.watched if m in there]
    return page


def _candidate_page(found: Any, candidate: Any) -> dict[str, Any] | None:
    """The page of a mechanism over one turn, with the points that it shall pass."""
    page: dict[str, Any] | None = candidate.page()
    if page is None:
        return None
    if found.target.points is not None:
        points = found.target.points
        size = DOT * float(np.max(np.ptp(points, axis=0)))
        wanted = [{"kind": "disc", "center": p, "radius": size} for p in points.tolist()]
        page["scene"]["ground"]["shapes"] = [*page["scene"]["ground"].get("shapes", []), *wanted]
    page["title"] = found.name
    return page


def synthesis_designs(found: Any) -> dict[str, Any]:
    """The mechanisms as a table of designs."""
    some = found.solutions[:SHOWN]
    columns = [("error", "", "aim", [s.error for s in some])]
    worst = [float(np.max(s.distances, initial=0.0)) for s in some]
    columns.append(("largest distance", "", "aim", worst))
    judged = [s.judged() for s in some]
    for name, (unit, _) in judged[0].items():
        columns.append((name, unit, "aim", [one[name][1] for one in judged]))
    numbers = [s.numbers for s in some]
    for name in numbers[0]:
        values = [one[name] for one in numbers]
        if np.ptp(values) > 0 or any(values):
            columns.append((name, some[0].units.get(name, ""), "parameter", values))
    labels = [f"{found.noun[:-1]} {k + 1}" for k in range(len(some))]
    return views.designs(columns, labels=labels)


def synthesis_views(found: Any) -> list[dict[str, Any]]:
    """The list, target against what is obtained, and the dimensions side by side."""
    target, some = found.target, found.solutions[:SHOWN]
    made = [
        views.of_designs("table", "Candidates", place="board", note="Click a row, or use ↑ ↓."),
    ]
    if target.points is not None:
        lines = [views.line("target", target.points[:, 0], target.points[:, 1], "dots")]
        for k, s in enumerate(some):
            path = s.curve()
            lines.append(views.line("obtained", path[:, 0], path[:, 1], design=k))
            at = s.passed()
            lines.append(
                views.line("at the entries", at[:, 0], at[:, 1], "dots", design=k, open=True)
            )
        made.append(
            {
                **views.curves("Target and path", "x", "y", lines, equal=True, follows="design"),
                "place": "board",
            }
        )
    if target.outputs is not None:
        made.append(_function(target, some))
    off = [
        views.line("distance", np.arange(len(target)), s.distances, design=k)
        for k, s in enumerate(some)
    ]
    made.append(views.curves("Distance at each entry", "entry", "distance", off, follows="design"))
    made.append(views.of_designs("parallel", "Dimensions", wide=True))
    return made


def _function(target: Any, some: list[Any]) -> dict[str, Any]:
    """Outputs over the turn of the crank, each from its mean."""
    given = target.crank_angles
    at = np.arange(len(target)) if given is None else np.asarray(given)
    lines = [views.line("target", at, target.outputs - np.mean(target.outputs), "dots")]
    for k, s in enumerate(some):
        output = s.reached()
        lines.append(views.line("obtained", at, output - output.mean(), design=k))
    x = "entry" if given is None else "crank angle [rad]"
    made = views.curves("Target and output", x, "output from its mean", lines, follows="design")
    return {**made, "place": "board"}
