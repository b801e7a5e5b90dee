"""Page of a synthesis: candidate mechanisms, targets and their errors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.pages.decision import CHANGING, plain_page, with_views
from dalembert.design.pages.live import LiveTask
from dalembert.errors import UnsupportedError
from dalembert.report import views
from dalembert.results.live import PageDesigns

if TYPE_CHECKING:
    from dalembert.design.synthesis.candidates import Candidate, Candidates
    from dalembert.design.synthesis.target import Target

MAX_MECHANISMS = 12
"""Upper limit of the mechanisms on a page."""
MARKER_SIZE = 0.012
"""Radius of a target marker relative to the extent of the target [-]."""


def synthesis_page(candidates: Candidates[Candidate], **first_view: Any) -> dict[str, Any]:
    """Page of ``Candidates``."""
    pages = [
        _candidate_page(candidates, solution) for solution in candidates.solutions[:MAX_MECHANISMS]
    ]
    first = next((page for page in pages if page is not None), None)
    if first is None:
        return plain_page(candidates)
    page = _with_candidates(first, candidates)
    changing = CHANGING[page["kind"]]
    page["designs"]["alternatives"] = [
        {} if other is None else {k: other[k] for k in (*changing, "parameters") if k in other}
        for other in pages
    ]
    return page


def _with_candidates(first: dict[str, Any], candidates: Candidates[Candidate]) -> dict[str, Any]:
    """Page of the first candidate, extended by the views of all."""
    page = with_views(dict(first), candidates, "candidates")
    page["title"], page["subtitle"] = f"{candidates.name}: candidates", candidates.message
    series_names = {series["name"] for series in page["series"]}
    page["default_plots"] = [[m] for m in candidates.best.plotted_measures if m in series_names]
    return page


def synthesis_task(candidates: Candidates[Candidate]) -> LiveTask | None:
    """Candidates of one topology in a live page.

    Raises
    ------
    UnsupportedError
        Each candidate has a model of its own.
    """
    best, solutions = candidates.best, candidates.solutions[:MAX_MECHANISMS]
    motion = best.parametric_motion
    if motion is None:
        raise UnsupportedError("each candidate has a model of its own, without parameters")
    names = list(best.numbers)
    values = np.array([[solution.numbers[n] for n in names] for solution in solutions])

    def page(**first_view: Any) -> dict[str, Any]:
        first = _candidate_page(candidates, best)
        assert first is not None
        return _with_candidates(first, candidates)

    return LiveTask(motion, page, PageDesigns(names, values), ())


def _candidate_page(
    candidates: Candidates[Candidate], candidate: Candidate
) -> dict[str, Any] | None:
    """Page of a mechanism over one turn, with the target points."""
    page: dict[str, Any] | None = candidate.page()
    if page is None:
        return None
    if candidates.target.points is not None:
        points = candidates.target.points
        size = MARKER_SIZE * float(np.max(np.ptp(points, axis=0)))
        markers = [{"kind": "disc", "center": p, "radius": size} for p in points.tolist()]
        page["scene"]["ground"]["shapes"] = [*page["scene"]["ground"].get("shapes", []), *markers]
    page["title"] = candidates.name
    return page


def synthesis_designs(candidates: Candidates[Candidate]) -> dict[str, Any]:
    """Table of the mechanisms."""
    solutions = candidates.solutions[:MAX_MECHANISMS]
    columns = [("error", "", "aim", [solution.error for solution in solutions])]
    worst = [float(np.max(solution.distances, initial=0.0)) for solution in solutions]
    columns.append(("largest distance", "", "aim", worst))
    criteria = [solution.criteria() for solution in solutions]
    for name, (unit, _) in criteria[0].items():
        columns.append((name, unit, "aim", [row[name][1] for row in criteria]))
    numbers = [solution.numbers for solution in solutions]
    for name in numbers[0]:
        values = [row[name] for row in numbers]
        if np.ptp(values) > 0 or any(values):
            columns.append((name, solutions[0].units.get(name, ""), "parameter", values))
    labels = [f"{candidates.candidate_kind[:-1]} {k + 1}" for k in range(len(solutions))]
    return views.designs(columns, labels=labels)


def synthesis_views(candidates: Candidates[Candidate]) -> list[dict[str, Any]]:
    """Table, target against result, and the dimensions in parallel coordinates."""
    target, solutions = candidates.target, candidates.solutions[:MAX_MECHANISMS]
    payload = [
        views.of_designs("table", "Candidates", place="board", note="Click a row, or use ↑ ↓."),
    ]
    if target.points is not None:
        lines = [views.line("target", target.points[:, 0], target.points[:, 1], "dots")]
        for k, solution in enumerate(solutions):
            path = solution.curve()
            lines.append(views.line("obtained", path[:, 0], path[:, 1], design=k))
            points = solution.points()
            lines.append(
                views.line(
                    "at the entries", points[:, 0], points[:, 1], "dots", design=k, open=True
                )
            )
        payload.append(
            {
                **views.curves("Target and path", "x", "y", lines, equal=True, follows="design"),
                "place": "board",
            }
        )
    if target.outputs is not None:
        payload.append(_function_view(target, target.outputs, solutions))
    distances = [
        views.line("distance", np.arange(len(target)), solution.distances, design=k)
        for k, solution in enumerate(solutions)
    ]
    payload.append(
        views.curves("Distance at each entry", "entry", "distance", distances, follows="design")
    )
    payload.append(views.of_designs("parallel", "Dimensions", wide=True))
    return payload


def _function_view(
    target: Target, outputs: np.ndarray, solutions: Sequence[Candidate]
) -> dict[str, Any]:
    """Outputs over the crank angle, relative to their means."""
    crank_angles = target.crank_angles
    abscissa = np.arange(len(target)) if crank_angles is None else np.asarray(crank_angles)
    lines = [views.line("target", abscissa, outputs - np.mean(outputs), "dots")]
    for k, solution in enumerate(solutions):
        output = solution.outputs()
        lines.append(views.line("obtained", abscissa, output - output.mean(), design=k))
    x = "entry" if crank_angles is None else "crank angle [rad]"
    curves = views.curves("Target and output", x, "output from its mean", lines, follows="design")
    return {**curves, "place": "board"}
