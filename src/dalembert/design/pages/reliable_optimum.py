"""Views of an optimum with a given reliability: the limits at their worst points, the rounds."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.pages.optimum import optimum_page
from dalembert.design.pages.plain import verdict
from dalembert.report import views


def reliable_page(best: Any, **first_view: Any) -> dict[str, Any]:
    """What the report of a ``ReliableOptimum`` shows: the page of the optimum, and these views."""
    page = optimum_page(best.optimum, **first_view)
    return page | {"views": best.views(), "verdict": verdict(best)}


def reliable_views(best: Any) -> list[dict[str, Any]]:
    """Index of each limit, its worst point, and how the rounds came to rest."""
    names = list(best.limits[0].point)
    rows = [
        {
            "name": one.label,
            "cells": [np.nan if one.beta is None else one.beta, one.value, *one.point.values()],
            "unit": "",
        }
        for one in best.limits
    ]
    heads = ["β", "Distance at the worst point", *names]
    made: list[dict[str, Any]] = [
        {"kind": "rows", "title": "Limits and their worst points", "heads": heads, "rows": rows}
    ]
    if len(best.rounds) > 1:
        count = np.arange(1, len(best.rounds) + 1)
        line = views.line("objective", count, [one.objective for one in best.rounds])
        margin = views.line("least margin", count, [one.margin for one in best.rounds])
        made.append(views.curves("Objective", "round", best.optimum.label, [line]))
        made.append(views.curves("Least margin", "round", "of its limit", [margin], levels=[0.0]))
    facts = [("β wanted", f"{best.beta:g}"), ("rounds", len(best.rounds))]
    made.append(views.facts("Reliability", [*facts, ("runs", best.runs)]))
    return [*made, *best.optimum.views()]
