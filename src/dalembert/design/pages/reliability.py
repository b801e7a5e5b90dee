"""Pages of a reliability analysis and of a reliability-based optimum."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.pages.decision import plain_page, verdict, with_views
from dalembert.design.pages.live import LiveTask, responses_of
from dalembert.design.pages.optimum import optimum_page
from dalembert.design.reliability.limit_state import RunLimits
from dalembert.report import views
from dalembert.results.live import PageDesigns

if TYPE_CHECKING:
    from dalembert.design.reliability.reliability_result import ReliabilityResult
    from dalembert.design.reliability.reliable_optimization_result import ReliableOptimizationResult

SPREAD = 4.0
"""Standard deviations from the median to the ends of the sliders of random parameters [-]."""


def reliability_page(reliability: ReliabilityResult, **first_view: Any) -> dict[str, Any]:
    """Page of a ``ReliabilityResult``."""
    result = reliability.result()
    if result is None:
        return plain_page(reliability)
    return with_views(result.page(**first_view), reliability, "design point")


def reliability_task(reliability: ReliabilityResult) -> LiveTask | None:
    """Design points, median and samples of a ``ReliabilityResult`` in a live page.

    The sliders range over ``SPREAD`` standard deviations about the median.
    """
    limits, result = reliability.searches[0].limits, reliability.result()
    if not isinstance(limits, RunLimits) or result is None:
        return None
    nataf, points = reliability.nataf, reliability.points
    names, median = list(nataf.random), nataf.values(np.zeros(nataf.size))
    first = [np.array(list(point.x.values())) for point in points]
    runs = [(x, limits.responses(x)) for x in (*first, median)]
    numbers = [""] if len(points) == 1 else [f" {k + 1}" for k in range(len(points))]
    labels = [*(f"design point{number}" for number in numbers), "median"]
    labels += [f"sample {k + 1}" for k in range(len(limits.samples))]
    runs += [(x, limits.responses_of(g)) for x, g in limits.samples]
    x = np.array([point for point, _ in runs])
    values = np.array([responses for _, responses in runs])
    chosen = next(k for k, point in enumerate(points) if point is reliability.point)
    ends = np.stack([nataf.values(np.full(nataf.size, u)) for u in (-SPREAD, SPREAD)])
    ranges = {n: (float(min(e)), float(max(e))) for n, e in zip(names, ends.T, strict=True)}
    quantities = limits.problem.quantities

    def page(**first_view: Any) -> dict[str, Any]:
        payload = with_views(result.page(**first_view), reliability, "design point")
        units = [
            limits.problem.unit(k, {quantities[0].terms[0].case: result})
            for k in range(len(quantities))
        ]
        columns = [
            (quantity.label, unit, "aim", column)
            for quantity, unit, column in zip(quantities, units, values.T, strict=True)
        ]
        columns += [
            (name, result.model.parameters[name].unit, "parameter", column)
            for name, column in zip(names, x.T, strict=True)
        ]
        weightiest = len(quantities) + int(np.argmax(np.abs(reliability.point.alpha)))
        cloud = views.of_designs(
            "front", "Points and samples", x=weightiest, y=0, choose=True, place="board"
        )
        table = views.of_designs("table", "Designs")
        return payload | {
            "designs": views.designs(columns, labels=labels, chosen=chosen),
            "views": [cloud, *payload["views"], table],
        }

    designs = PageDesigns(names, x, None, ranges)
    case = quantities[0].terms[0].case
    return LiveTask(result, page, designs, responses_of(quantities, case))


def reliability_views(reliability: ReliabilityResult) -> list[dict[str, Any]]:
    """Index, design point, importance, sensitivities and samples."""
    point = reliability.point
    rows = [
        ("reliability index β", f"{reliability.beta:.5g}"),
        ("probability of failure", f"{reliability.probability:.4g}"),
        ("residual at the design point", f"{reliability.residual:.1e}"),
        ("evaluations", reliability.searches[0].limits.calls),
    ]
    if reliability.sampled is not None:
        low, high = reliability.sampled.interval
        rows[2:2] = [
            (f"by {reliability.sampled.samples} samples", f"{reliability.sampled.probability:.4g}"),
            ("their coefficient of variation", f"{100 * reliability.sampled.variation:.2g} %"),
            ("their 95 % interval", f"{low:.3g} … {high:.3g}"),
        ]
    payload = [
        {**views.facts("Reliability", rows), "place": "board"},
        {**_design_point_view(reliability), "place": "board"},
        views.bars(
            "Importance",
            reliability.importance,
            share=True,
            note="Shares of the variance at the point.",
        ),
    ]
    if len(reliability.points) > 1:
        betas = {f"{k + 1}. {p.limit}": p.beta for k, p in enumerate(reliability.points)}
        payload.append(views.bars("β of every design point", betas))
    payload.append(_table(reliability))
    changes = {
        f"{name}, {number}": rate * _size(reliability, name, number)
        for name, rates in reliability.sensitivity.items()
        for number, rate in rates.items()
    }
    note = "Change of β if a parameter of a distribution increases by 10 %."
    payload.append(
        views.bars("Sensitivity of β", {k: 0.1 * v for k, v in changes.items()}, note=note)
    )
    nonrandom = {n: v for n, v in reliability.parameter_sensitivity.items() if v}
    if nonrandom:
        values = _nominal(reliability)
        note = "Change of β if a deterministic parameter increases by 10 %."
        steps = {n: 0.1 * v * (abs(values.get(n, 0.0)) or 1.0) for n, v in nonrandom.items()}
        payload.append(views.bars("Deterministic parameters", steps, note=note))
    assert point is not None
    return payload


def _size(reliability: ReliabilityResult, name: str, number: str) -> float:
    return abs(reliability.nataf.random[name].numbers[number]) or 1.0


def _nominal(reliability: ReliabilityResult) -> dict[str, float]:
    model = reliability.searches[0].limits.model
    return {} if model is None else dict(zip(model.parameters, map(float, model.nominal)))  # noqa: B905


def _design_point_view(reliability: ReliabilityResult) -> dict[str, Any]:
    """Design point in standard normal space, in the plane of its two largest components."""
    point, names = reliability.point, list(reliability.nataf.random)
    order = np.argsort(-abs(point.u))[:2]
    if len(names) < 2:
        u = np.linspace(-4, 4, 161)
        bell = views.line("density", u, np.exp(-0.5 * u**2) / np.sqrt(2 * np.pi))
        mark = views.line("design point", [point.u[0]], [0.0], "dots")
        return views.curves("Design point", f"u of {names[0]}", "density", [bell, mark])
    i, j = order
    angles = np.linspace(0, 2 * np.pi, 121)
    circles = [
        views.line(f"{r} σ", r * np.cos(angles), r * np.sin(angles), "dashed", quiet=True)
        for r in range(1, max(3, int(np.ceil(abs(point.beta)))) + 1)
    ]
    centre = point.u[[i, j]]
    lines = [*circles, views.line("from the median", [0, centre[0]], [0, centre[1]])]
    normal = point.alpha[[i, j]]
    if (size := np.linalg.norm(normal)) > 1e-9:
        along = np.array([-normal[1], normal[0]]) / size * 2.5
        tangent = np.array([centre - along, centre + along])
        lines.append(views.line("limit, to first order", tangent[:, 0], tangent[:, 1], "dashed"))
    lines.append(views.line("design point", [centre[0]], [centre[1]], "dots"))
    note = "Standard normal variables; the circles are 1, 2, 3 … deviations from the median."
    return views.curves(
        "Design point", f"u of {names[i]}", f"u of {names[j]}", lines, equal=True, note=note
    )


def _table(reliability: ReliabilityResult) -> dict[str, Any]:
    """Medians and design point in the units of the random parameters."""
    median = reliability.nataf.values(np.zeros(reliability.nataf.size))
    names = list(reliability.nataf.random)
    model = reliability.searches[0].limits.model
    units = [model.parameters[n].unit if model is not None else "" for n in names]
    rows = [
        {"name": n, "cells": [float(m), float(reliability.point.x[n]), float(u)], "unit": unit}
        for n, m, u, unit in zip(names, median, reliability.point.u, units, strict=True)
    ]
    heads = ["Median", "Design point", "Deviations"]
    return {"kind": "rows", "title": "Random parameters", "heads": heads, "rows": rows}


def reliable_page(optimum: ReliableOptimizationResult, **first_view: Any) -> dict[str, Any]:
    """Page of a ``ReliableOptimizationResult``: the page of the optimum with further views."""
    page = optimum_page(optimum.optimum, **first_view)
    return page | {
        "views": [*first_view.get("views", ()), *optimum.views()],
        "verdict": verdict(optimum),
    }


def reliable_views(optimum: ReliableOptimizationResult) -> list[dict[str, Any]]:
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
