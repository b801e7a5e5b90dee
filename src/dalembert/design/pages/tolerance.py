"""Page of a tolerance analysis: scatter of the response, and contributions."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.decision import axis_label
from dalembert.design.pages.decision import plain_page, with_views
from dalembert.design.pages.live import LiveTask, drawn
from dalembert.report import views
from dalembert.results.live import PageDesigns

if TYPE_CHECKING:
    from dalembert.design.tolerance.tolerance_result import ToleranceResult


def tolerance_page(result: ToleranceResult, **first_view: Any) -> dict[str, Any]:
    """Page of a ``ToleranceResult``."""
    if result.run is None:
        return plain_page(result)
    return with_views(result.run.page(**first_view), result, "tolerances")


def tolerance_task(result: ToleranceResult) -> LiveTask | None:
    """Nominal design and samples of a ``ToleranceResult`` in a live page.

    The sliders range over the tolerances.
    """
    run, names = result.run, list(result.tolerances)
    if run is None or result.response is None:
        return None
    parameters = dict(zip(run.model.parameters, map(float, run.parameters), strict=False))
    designs, values = np.array([[parameters[n] for n in names]]), np.array([result.nominal])
    labels = ["nominal"]
    if result.samples is not None and result.sampled is not None:
        indices = drawn(result.sampled.size)
        designs = np.vstack([designs, result.samples[indices]])
        values = np.append(values, result.sampled[indices])
        labels += [f"sample {k + 1}" for k in indices]
    ranges = {n: (parameters[n] - t, parameters[n] + t) for n, t in result.tolerances.items()}

    def page(**first_view: Any) -> dict[str, Any]:
        payload = with_views(run.page(**first_view), result, "tolerances")
        if len(labels) == 1:
            return payload
        columns = [(result.label, result.unit, "aim", values)]
        columns += [
            (name, result.units.get(name, ""), "parameter", column)
            for name, column in zip(names, designs.T, strict=True)
        ]
        widest = max(names, key=lambda name: result.contributions[name])
        samples = [
            views.of_designs(
                "front", "Samples", x=1 + names.index(widest), y=0, choose=True, place="board"
            ),
            views.of_designs("table", "Designs"),
        ]
        return payload | {
            "designs": views.designs(columns, labels=labels),
            "views": [*payload["views"], *samples],
        }

    return LiveTask(run, page, PageDesigns(names, designs, None, ranges), [result.response])


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
