"""Page of a trajectory: motion, controls and states over time, verification."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.decision import axis_label
from dalembert.design.pages.decision import with_views
from dalembert.report import views
from dalembert.results.pictures.scene import standing

if TYPE_CHECKING:
    from dalembert.design.trajectory.trajectory_result import TrajectoryResult
    from dalembert.results.motion import Motion

CONTROL_POINTS = 240
"""Number of points by which a control is drawn."""
MAX_STATES = 6
"""Upper limit of the drawn coordinates."""
NEGLIGIBLE = 1e-9
"""Threshold of the scaled change of a coordinate below which it is not drawn [-]."""


def trajectory_page(trajectory: TrajectoryResult, **first_view: Any) -> dict[str, Any]:
    """Page of a ``TrajectoryResult``."""
    page = with_views(trajectory.final_motion.page(**first_view), trajectory, "trajectory")
    if page.get("time"):
        page["scene"]["ghosts"] = [standing(b, 0) for b in page["scene"]["bodies"] if b["shapes"]]
        page["ghost_name"] = "Initial position"
    return page


def trajectory_views(trajectory: TrajectoryResult) -> list[dict[str, Any]]:
    """Controls, planned and simulated states, dimensions, and facts of the search."""
    payload = [{**_control(trajectory, name), "place": "board"} for name in trajectory.controls]
    payload += _states(trajectory)
    if trajectory.x:
        payload.append(_dimensions(trajectory))
    rows: list[tuple[str, Any]] = [
        (trajectory.label, f"{trajectory.fun:.6g} {trajectory.unit}".rstrip()),
        ("duration", f"{trajectory.duration:.6g} s"),
        ("status", str(trajectory.status)),
        ("residual", f"{trajectory.status.residual:.2g}"),
        ("defect", f"{trajectory.defect:.2g}"),
        ("deviation of plan and run", f"{trajectory.deviation:.2g}"),
        ("change with half of the steps", f"{trajectory.step_error:.2g}"),
        ("intervals", trajectory.intervals),
        ("iterations", trajectory.iterations),
    ]
    note = "Defect: error of single intervals. Deviation: error of the whole simulation."
    payload.append(views.facts("Search", rows, note))
    return payload


def _control(trajectory: TrajectoryResult, name: str) -> dict[str, Any]:
    """Control over time, with its finite bounds."""
    control = trajectory.controls[name]
    times = np.linspace(0, trajectory.duration, CONTROL_POINTS)
    lines = [
        views.line(name, times, control(times)),
        views.line("knots", control.times[::2], control.values[::2], "dots"),
    ]
    label = axis_label(name, control.unit)
    bounds = trajectory.planned.model.parameters[name].bounds
    levels = [float(b) for b in bounds if np.isfinite(b)]
    return views.curves(f"Control {name}", "time [s]", label, lines, levels=levels)


def _states(trajectory: TrajectoryResult) -> list[dict[str, Any]]:
    """Coordinates that change, planned and simulated."""
    plan = trajectory.planned
    payload = []
    for name in _moving(plan):
        lines = [views.line("planned", plan.time, plan.values(name), "dots")]
        if trajectory.motion is not None:
            lines.insert(
                0, views.line("run", trajectory.motion.time, trajectory.motion.values(name))
            )
        unit = plan.expression(name).unit
        label = axis_label(name, unit)
        payload.append(views.curves(name, "time [s]", label, lines))
    return payload


def _moving(plan: Motion) -> list[str]:
    """Coordinates with the largest scaled changes."""
    span = np.ptp(plan.trajectory.y, axis=1) / plan.model.scales.coordinates
    names, order = plan.model.guesses.names, np.argsort(-span)
    return [names[k] for k in order[:MAX_STATES] if span[k] > NEGLIGIBLE]


def _dimensions(trajectory: TrajectoryResult) -> dict[str, Any]:
    """Parameters designed together with the motion."""
    model = trajectory.planned.model
    rows = [
        {"name": n, "cells": [trajectory.start[n], value], "unit": model.parameters[n].unit}
        for n, value in trajectory.x.items()
    ]
    heads = ["Start", "Optimum"]
    return {"kind": "rows", "title": "Dimensions", "heads": heads, "rows": rows}
