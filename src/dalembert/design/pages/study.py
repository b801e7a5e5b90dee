"""Page of a study: scatter plots, parallel coordinates, histograms and failures."""

from __future__ import annotations

import re
from collections import Counter
from typing import TYPE_CHECKING, Any

from dalembert.design.decision import axis_label
from dalembert.design.pages.decision import plain_page, with_views
from dalembert.design.pages.live import MAX_DESIGNS, LiveTask, drawn
from dalembert.report import views
from dalembert.results.live import PageDesigns

if TYPE_CHECKING:
    from dalembert.design.studies.sweep_result import SweepResult

NUMBER = re.compile(r"[-−]?\d[\d.]*(?:e[-+]?\d+)?")
"""Numbers in the reasons of failures, which are masked to group them."""
MAX_MATRIX = 7
"""Upper limit of the columns of which all pairs are drawn."""


def study_page(study: SweepResult) -> dict[str, Any]:
    """Page of a ``SweepResult``."""
    return plain_page(study)


def study_task(study: SweepResult) -> LiveTask | None:
    """Designs of a ``SweepResult`` in a live page, which shows the first successful one."""
    task, indices = study.task, drawn(len(study.design))
    first = next((k for k in indices if not study.reasons[k]), None)
    if task is None or first is None:
        return None
    values = dict(zip(study.design.names, map(float, study.design.values[first]), strict=True))
    result = task.analysis.run(task.model, values)

    def page(**first_view: Any) -> dict[str, Any]:
        """The page with the first view beside the drawing."""
        payload = with_views(result.page(**first_view), study, "study")
        views_below = [view for view in payload["views"] if view.get("place") != "board"]
        views_below[0] |= {"place": "board", "wide": False}
        return payload

    return LiveTask(
        result,
        page,
        PageDesigns(study.design.names, study.design.values[indices]),
        task.responses,
    )


def study_designs(study: SweepResult) -> dict[str, Any]:
    """Table of designs and responses."""
    indices = drawn(len(study.design))
    unit = study.units.get
    columns = [
        (name, unit(name, ""), "aim", column[indices])
        for name, column in zip(study.responses, study.values.T, strict=True)
    ]
    columns += [
        (name, unit(name, ""), "parameter", column[indices])
        for name, column in zip(study.design.names, study.design.values.T, strict=True)
    ]
    labels, reasons = [f"design {k}" for k in indices], [study.reasons[k] for k in indices]
    first = next((n for n, reason in enumerate(reasons) if not reason), 0)
    return views.designs(columns, labels=labels, reasons=reasons, chosen=first)


def study_views(study: SweepResult) -> list[dict[str, Any]]:
    """Parallel coordinates, scatter plots, histograms and reasons of failures."""
    names = [*study.responses, *study.design.names]
    payload = [views.of_designs("parallel", "All designs", wide=True, brush=True)]
    if len(names) <= MAX_MATRIX:
        payload.append(views.of_designs("matrix", "Scatter of all pairs", wide=True))
    else:
        x = len(study.responses)
        payload.append(views.of_designs("front", "Scatter", x=x, y=0, choose=True))
    success = study.success
    for name in study.responses[:3]:
        column = study.column(name)[success]
        unit = study.units.get(name, "")
        label = axis_label(name, unit)
        if column.size:
            marks = {"mean": float(column.mean())}
            payload.append(views.histogram(name, label, column, marks))
    common = Counter(NUMBER.sub("…", text) for text in study.failures.values()).most_common(12)
    if common:
        reasons = {reason: float(count) for reason, count in common}
        note = f"{len(study.failures)} of {len(study.design)} designs failed."
        payload.append(views.bars("Failed designs", reasons, "designs", note))
    rows: list[tuple[str, Any]] = [("designs", len(study.design)), ("failed", len(study.failures))]
    if len(study.design) > MAX_DESIGNS:
        rows.append(("drawn", f"{MAX_DESIGNS}, evenly spaced"))
    payload.append(views.of_designs("table", "Designs", wide=True))
    payload.append(views.facts("Study", rows))
    return payload
