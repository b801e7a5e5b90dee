"""The page of a trajectory: the motion, controls and states over time, what the plan is worth."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.pages.plain import with_views
from dalembert.report import views
from dalembert.results.pictures.scene import standing

FINE = 240
"""Points of a control that a page draws."""
STATES = 6
"""Coordinates that are drawn at most."""
STILL = 1e-9
"""Change of a coordinate, of its natural size, that is none."""


def trajectory_page(best: Any, **first_view: Any) -> dict[str, Any]:
    """What the report of an ``OptimalTrajectory`` shows."""
    page = with_views(best.shown.page(**first_view), best, "trajectory")
    if page.get("time"):
        page["scene"]["ghosts"] = [standing(b, 0) for b in page["scene"]["bodies"] if b["shapes"]]
        page["ghost_name"] = "Beginning"
    return page


def trajectory_views(best: Any) -> list[dict[str, Any]]:
    """Controls, states planned and run, dimensions, and how the search ended."""
    made = [{**_control(best, name), "place": "board"} for name in best.controls]
    made += _states(best)
    if best.x:
        made.append(_dimensions(best))
    rows: list[tuple[str, Any]] = [
        (best.label, f"{best.fun:.6g} {best.unit}".rstrip()),
        ("duration", f"{best.duration:.6g} s"),
        ("status", str(best.status)),
        ("residual", f"{best.status.residual:.2g}"),
        ("defect", f"{best.defect:.2g}"),
        ("deviation of plan and run", f"{best.deviation:.2g}"),
        ("change with half of the steps", f"{best.step_error:.2g}"),
        ("intervals", best.intervals),
        ("iterations", best.iterations),
    ]
    note = "Defect: of intervals that are run one by one. Deviation: of the whole run."
    made.append(views.facts("Search", rows, note))
    return made


def _control(best: Any, name: str) -> dict[str, Any]:
    """A control over time, with its bounds where they are finite."""
    control = best.controls[name]
    times = np.linspace(0, best.duration, FINE)
    lines = [
        views.line(name, times, control(times)),
        views.line("knots", control.times[::2], control.values[::2], "dots"),
    ]
    label = f"{name} [{control.unit}]" if control.unit else name
    bounds = best.planned.model.parameters[name].bounds
    levels = [float(b) for b in bounds if np.isfinite(b)]
    return views.curves(f"Control {name}", "time [s]", label, lines, levels=levels)


def _states(best: Any) -> list[dict[str, Any]]:
    """Coordinates that move, planned and run."""
    plan = best.planned
    made = []
    for name in _moving(plan):
        lines = [views.line("planned", plan.time, plan.values(name), "dots")]
        if best.motion is not None:
            lines.insert(0, views.line("run", best.motion.time, best.motion.values(name)))
        unit = plan.expression(name).unit
        label = f"{name} [{unit}]" if unit else name
        made.append(views.curves(name, "time [s]", label, lines))
    return made


def _moving(plan: Any) -> list[str]:
    """Those that change most, of their sizes."""
    span = np.ptp(plan.trajectory.y, axis=1) / plan.model.scales.coordinates
    names, order = plan.model.guesses.names, np.argsort(-span)
    return [names[k] for k in order[:STATES] if span[k] > STILL]


def _dimensions(best: Any) -> dict[str, Any]:
    """What was designed with the motion."""
    model = best.planned.model
    rows = [
        {"name": n, "cells": [best.start[n], value], "unit": model.parameters[n].unit}
        for n, value in best.x.items()
    ]
    heads = ["At first", "Found"]
    return {"kind": "rows", "title": "Dimensions", "heads": heads, "rows": rows}
