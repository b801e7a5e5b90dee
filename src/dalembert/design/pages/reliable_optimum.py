"""Page of a reliability-based optimum: limits at their design points, and convergence."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.pages.optimum import optimum_page
from dalembert.design.pages.plain import verdict
from dalembert.report import views


def reliable_page(optimum: Any, **first_view: Any) -> dict[str, Any]:
    """Page of a ``ReliableOptimum``: the page of the optimum with further views."""
    page = optimum_page(optimum.optimum, **first_view)
    return page | {"views": optimum.views(), "verdict": verdict(optimum)}


def reliable_views(optimum: Any) -> list[dict[str, Any]]:
    """Reliability index and design point of each limit, and the convergence of the rounds."""
    names = list(optimum.limits[0].point)
    rows = [
        {
            "name": entry.label,
            "cells": [
                np.nan if entry.beta is None else entry.beta,
                entry.value,
                *entry.point.values(),
            ],
            "unit": "",
        }
        for entry in optimum.limits
    ]
    heads = ["β", "Distance at the worst point", *names]
    payload: list[dict[str, Any]] = [
        {"kind": "rows", "title": "Limits and their worst points", "heads": heads, "rows": rows}
    ]
    if len(optimum.rounds) > 1:
        count = np.arange(1, len(optimum.rounds) + 1)
        line = views.line("objective", count, [entry.objective for entry in optimum.rounds])
        margin = views.line("minimum margin", count, [entry.margin for entry in optimum.rounds])
        payload.append(views.curves("Objective", "round", optimum.optimum.label, [line]))
        payload.append(
            views.curves("Minimum margin", "round", "of its limit", [margin], levels=[0.0])
        )
    facts = [("required β", f"{optimum.beta:g}"), ("rounds", len(optimum.rounds))]
    payload.append(views.facts("Reliability", [*facts, ("runs", optimum.runs)]))
    return [*payload, *optimum.optimum.views()]
