"""The page of a reliability: the run at the design point, β, and what it depends on."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.pages.plain import plain_page, with_views
from dalembert.report import views


def reliability_page(found: Any, **first_view: Any) -> dict[str, Any]:
    """What the report of a ``Reliability`` shows."""
    result = found.result()
    if result is None or not result.has_page:
        return plain_page(found)
    return with_views(result.page(**first_view), found, "design point")


def reliability_views(found: Any) -> list[dict[str, Any]]:
    """Index, design point, importance, sensitivities, and samples beside."""
    point = found.point
    rows = [
        ("reliability index β", f"{found.beta:.5g}"),
        ("probability of failure", f"{found.probability:.4g}"),
        ("residual at the design point", f"{found.residual:.1e}"),
        ("evaluations", found.searches[0].limits.calls),
    ]
    if found.sampled is not None:
        low, high = found.sampled.interval
        rows[2:2] = [
            ("by samples", f"{found.sampled.probability:.4g}"),
            ("their 95 % interval", f"{low:.3g} … {high:.3g}"),
        ]
    made = [
        {**views.facts("Reliability", rows), "place": "board"},
        {**_where(found), "place": "board"},
        views.bars(
            "Importance", found.importance, share=True, note="Shares of the variance at the point."
        ),
    ]
    if len(found.points) > 1:
        betas = {f"{k + 1}. {p.limit}": p.beta for k, p in enumerate(found.points)}
        made.append(views.bars("β of every design point", betas))
    made.append(_table(found))
    moved = {
        f"{name}, {number}": rate * _size(found, name, number)
        for name, rates in found.sensitivity.items()
        for number, rate in rates.items()
    }
    note = "Change of β where a number of a distribution grows by a tenth of its size."
    made.append(views.bars("What β depends on", {k: 0.1 * v for k, v in moved.items()}, note=note))
    others = {n: v for n, v in found.parameter_sensitivity.items() if v}
    if others:
        values = _nominal(found)
        note = "Change of β where a parameter that is not random grows by a tenth of its size."
        steps = {n: 0.1 * v * (abs(values.get(n, 0.0)) or 1.0) for n, v in others.items()}
        made.append(views.bars("Other parameters", steps, note=note))
    assert point is not None
    return made


def _size(found: Any, name: str, number: str) -> float:
    return abs(found.nataf.random[name].numbers[number]) or 1.0


def _nominal(found: Any) -> dict[str, float]:
    model = found.searches[0].limits.model
    return {} if model is None else dict(zip(model.parameters, map(float, model.nominal)))  # noqa: B905


def _where(found: Any) -> dict[str, Any]:
    """The design point in standard normal space, along its two largest directions."""
    point, names = found.point, list(found.nataf.random)
    order = np.argsort(-abs(point.u))[:2]
    if len(names) < 2:
        u = np.linspace(-4, 4, 161)
        bell = views.line("density", u, np.exp(-0.5 * u**2) / np.sqrt(2 * np.pi))
        mark = views.line("design point", [point.u[0]], [0.0], "dots")
        return views.curves("Design point", f"u of {names[0]}", "density", [bell, mark])
    i, j = order
    turn = np.linspace(0, 2 * np.pi, 121)
    rings = [
        views.line(f"{r} σ", r * np.cos(turn), r * np.sin(turn), "dashed", quiet=True)
        for r in range(1, max(3, int(np.ceil(abs(point.beta)))) + 1)
    ]
    at = point.u[[i, j]]
    lines = [*rings, views.line("from the median", [0, at[0]], [0, at[1]])]
    normal = point.alpha[[i, j]]
    if (size := np.linalg.norm(normal)) > 1e-9:
        along = np.array([-normal[1], normal[0]]) / size * 2.5
        ends = np.array([at - along, at + along])
        lines.append(views.line("limit, to first order", ends[:, 0], ends[:, 1], "dashed"))
    lines.append(views.line("design point", [at[0]], [at[1]], "dots"))
    note = "Standard normal variables; the circles are 1, 2, 3 … deviations from the median."
    return views.curves(
        "Design point", f"u of {names[i]}", f"u of {names[j]}", lines, equal=True, note=note
    )


def _table(found: Any) -> dict[str, Any]:
    """Medians and the design point in the units of the random parameters."""
    median = found.nataf.values(np.zeros(found.nataf.size))
    names = list(found.nataf.random)
    model = found.searches[0].limits.model
    units = [model.parameters[n].unit if model is not None else "" for n in names]
    rows = [
        {"name": n, "cells": [float(m), float(found.point.x[n]), float(u)], "unit": unit}
        for n, m, u, unit in zip(names, median, found.point.u, units, strict=True)
    ]
    heads = ["Median", "Design point", "Deviations"]
    return {"kind": "rows", "title": "Random parameters", "heads": heads, "rows": rows}
