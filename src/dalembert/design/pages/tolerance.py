"""Page of a tolerance analysis: scatter of the response, and contributions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.decision import axis_label
from dalembert.design.pages.decision import plain_page, with_views
from dalembert.report import views

if TYPE_CHECKING:
    from dalembert.design.tolerance.tolerance_result import ToleranceResult


def tolerance_page(result: ToleranceResult, **first_view: Any) -> dict[str, Any]:
    """Page of a ``ToleranceResult``."""
    if result.run is None or not result.run.has_page:
        return plain_page(result)
    return with_views(result.run.page(**first_view), result, "tolerances")


def tolerance_views(result: ToleranceResult) -> list[dict[str, Any]]:
    """Scatter, contributions, effects and tolerances."""
    unit = result.unit
    mean, std = (result.nominal, result.std) if result.hessian is None else result.second_order
    marks = {"nominal": result.nominal}
    if result.worst is not None:
        marks |= {"minimum": result.worst[0], "maximum": result.worst[1]}
    values = np.zeros(0) if result.sampled is None else result.sampled
    order = "first" if result.hessian is None else "second"
    note = f"Curve: normal, mean and deviation to {order} order."
    label = axis_label(result.label, unit)
    rows = [
        ("nominal", f"{result.nominal:.6g} {unit}"),
        (
            f"± {result.sigmas:g} σ, first order",
            f"{result.sigmas * result.std:.4g} {unit}",
        ),
    ]
    if result.hessian is not None:
        rows.append(("mean, second order", f"{mean:.6g} {unit}"))
        rows.append((f"± {result.sigmas:g} σ, second order", f"{result.sigmas * std:.4g} {unit}"))
    if result.worst is not None:
        rows.append(("worst case", f"{result.worst[0]:.6g} … {result.worst[1]:.6g} {unit}"))
    if result.sampled is not None:
        rows.append(("samples", f"{result.sampled.size}"))
        spread = result.sigmas * float(np.std(result.sampled, ddof=1))
        rows.append((f"± {result.sigmas:g} σ, samples", f"{spread:.4g} {unit}"))
    payload = [
        {
            **views.histogram(result.label, label, values, marks, (mean, std), note),
            "place": "board",
        },
        {**views.bars("Contributions", result.contributions, share=True), "place": "board"},
        views.facts("Scatter", rows),
        views.bars(
            "Effects",
            result.effects,
            unit,
            "Change of the response for a deviation by the full tolerance.",
        ),
        _table(result),
    ]
    return payload


def _table(result: ToleranceResult) -> dict[str, Any]:
    heads, columns = ["Tolerance ±"], [result.tolerances]
    if result.allocated is not None:
        heads.append("Allocated ±")
        columns.append(result.allocated)
    rows = [
        {"name": n, "cells": [float(c[n]) for c in columns], "unit": result.units.get(n, "")}
        for n in result.tolerances
    ]
    return {"kind": "rows", "title": "Tolerances", "heads": heads, "rows": rows}
