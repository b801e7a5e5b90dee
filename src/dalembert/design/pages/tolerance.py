"""The page of tolerances: how the response scatters, and what each tolerance adds."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.pages.plain import plain_page, with_views
from dalembert.report import views


def tolerance_page(found: Any, **first_view: Any) -> dict[str, Any]:
    """What the report of a ``Toleranced`` shows."""
    if found.run is None or not found.run.has_page:
        return plain_page(found)
    return with_views(found.run.page(**first_view), found, "tolerances")


def tolerance_views(found: Any) -> list[dict[str, Any]]:
    """Scatter, contributions, effects and the tolerances themselves."""
    unit = found.unit
    mean, std = (found.nominal, found.std) if found.hessian is None else found.second_order
    marks = {"nominal": found.nominal}
    if found.worst is not None:
        marks |= {"least": found.worst[0], "largest": found.worst[1]}
    values = np.zeros(0) if found.sampled is None else found.sampled
    about = "first" if found.hessian is None else "second"
    note = f"Curve: normal, mean and deviation to {about} order."
    label = f"{found.label} [{unit}]" if unit else found.label
    rows = [
        ("nominal", f"{found.nominal:.6g} {unit}"),
        (f"± {found.sigmas:g} σ, first order", f"{found.sigmas * found.std:.4g} {unit}"),
    ]
    if found.hessian is not None:
        rows.append(("mean, second order", f"{mean:.6g} {unit}"))
        rows.append((f"± {found.sigmas:g} σ, second order", f"{found.sigmas * std:.4g} {unit}"))
    if found.worst is not None:
        rows.append(("worst case", f"{found.worst[0]:.6g} … {found.worst[1]:.6g} {unit}"))
    if found.sampled is not None:
        rows.append(("samples", f"{found.sampled.size}"))
        spread = found.sigmas * float(np.std(found.sampled, ddof=1))
        rows.append((f"± {found.sigmas:g} σ, samples", f"{spread:.4g} {unit}"))
    made = [
        {
            **views.histogram(found.label, label, values, marks, (mean, std), note),
            "place": "board",
        },
        {**views.bars("Contributions", found.contributions, share=True), "place": "board"},
        views.facts("Scatter", rows),
        views.bars(
            "Effects", found.effects, unit, "Change of the response where a tolerance is used up."
        ),
        _table(found),
    ]
    return made


def _table(found: Any) -> dict[str, Any]:
    heads, columns = ["Tolerance ±"], [found.tolerances]
    if found.allotted is not None:
        heads.append("Allotted ±")
        columns.append(found.allotted)
    rows = [
        {"name": n, "cells": [float(c[n]) for c in columns], "unit": found.units.get(n, "")}
        for n in found.tolerances
    ]
    return {"kind": "rows", "title": "Tolerances", "heads": heads, "rows": rows}
