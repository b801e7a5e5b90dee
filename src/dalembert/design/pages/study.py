"""The page of a study: its designs in scatter plots and side by side, and why some failed."""

from __future__ import annotations

import re
from collections import Counter
from typing import Any

import numpy as np

from dalembert.design.pages.plain import plain_page
from dalembert.report import views

MOST = 1500
"""Designs that a page draws; of more some are left out, evenly."""
NUMBER = re.compile(r"[-−]?\d[\d.]*(?:e[-+]?\d+)?")
"""What tells reasons of one kind apart."""
MATRIX = 7
"""Columns of which all pairs are drawn."""


def study_page(study: Any) -> dict[str, Any]:
    """What the report of a ``Study`` shows."""
    return plain_page(study)


def study_designs(study: Any) -> dict[str, Any]:
    """Designs and responses as a table."""
    keep = _kept(study)
    unit = study.units.get
    columns = [
        (name, unit(name, ""), "aim", column[keep])
        for name, column in zip(study.responses, study.values.T, strict=True)
    ]
    columns += [
        (name, unit(name, ""), "parameter", column[keep])
        for name, column in zip(study.design.names, study.design.values.T, strict=True)
    ]
    labels, reasons = [f"design {k}" for k in keep], [study.reasons[k] for k in keep]
    first = next((n for n, reason in enumerate(reasons) if not reason), 0)
    return views.designs(columns, labels=labels, reasons=reasons, chosen=first)


def _kept(study: Any) -> np.ndarray:
    count = len(study.design)
    return np.unique(np.linspace(0, count - 1, min(count, MOST)).round().astype(int))


def study_views(study: Any) -> list[dict[str, Any]]:
    """Side by side, in pairs, by their spread, and the reasons of failures."""
    names = [*study.responses, *study.design.names]
    made = [views.of_designs("parallel", "All designs", wide=True, brush=True)]
    if len(names) <= MATRIX:
        made.append(views.of_designs("matrix", "Scatter of all pairs", wide=True))
    else:
        x = len(study.responses)
        made.append(views.of_designs("front", "Scatter", x=x, y=0, choose=True))
    done = study.success
    for name in study.responses[:3]:
        column = study.column(name)[done]
        unit = study.units.get(name, "")
        label = f"{name} [{unit}]" if unit else name
        if column.size:
            marks = {"mean": float(column.mean())}
            made.append(views.histogram(name, label, column, marks))
    counted = Counter(NUMBER.sub("…", text) for text in study.failures.values()).most_common(12)
    if counted:
        reasons = {reason: float(count) for reason, count in counted}
        note = f"{len(study.failures)} of {len(study.design)} designs failed."
        made.append(views.bars("Failed designs", reasons, "designs", note))
    rows: list[tuple[str, Any]] = [("designs", len(study.design)), ("failed", len(study.failures))]
    if len(study.design) > MOST:
        rows.append(("drawn", f"{MOST} of them, evenly"))
    made.append(views.of_designs("table", "Designs", wide=True))
    made.append(views.facts("Study", rows))
    return made
