"""The page of an optimum: that of its best run, the first design as a ghost, and how it came."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from dalembert.design.pages.plain import plain_page, verdict
from dalembert.report import views
from dalembert.results.files.tables import checked_units
from dalembert.units.unit import shown_in

FLAT = 1e-6
"""Change of the objective, relative, that is none: an optimum inside of its bounds."""
STILL = ("name", "node", "shapes")


def optimum_page(best: Any, **first_view: Any) -> dict[str, Any]:
    """What the report of an ``Optimum`` shows, as plain data."""
    units = checked_units(first_view.get("units") or ())
    if not best.motion.has_page:
        return plain_page(best) | {"optimum": told(best, units)}
    page = best.motion.page(**first_view)
    page["title"] = f"{page['title']}: optimum"
    page["optimum"] = told(best, units)
    page["views"], page["verdict"] = optimum_views(best, units), verdict(best)
    if units:
        page["verdict"]["text"] = _sentence(page["optimum"])
    first = best.initial.page() if best.initial.has_page else {}
    if "scene" in page and page.get("time"):
        page["scene"]["ghosts"] = _ghosts(first, np.array(page["time"]))
    elif page.get("kind") == "structure" and first:
        page["ghost"] = {"drawing": first["drawing"], "moved": first["moved"]}
    return page


def told(best: Any, units: Sequence[str] = ()) -> dict[str, Any]:
    """Objective, limits, prices and the way there, each in the first of ``units`` that fits."""
    factor, unit = shown_in(best.unit, units)
    variables = [one.shown_in(units, (factor, unit)) for one in best.variables]
    limits = [one.shown_in(units, (factor, unit)) for one in best.limits]
    prices = [one.cost(unit) for one in (*limits, *variables)]
    return {
        "label": best.label,
        "unit": unit,
        "start": best.history[0].objective / factor,
        "value": best.fun / factor,
        "success": best.success,
        "message": best.message,
        "variables": [asdict(one) for one in variables],
        "limits": [asdict(one) for one in limits],
        "prices": [text for text in prices if text],
        "history": [
            {"objective": i.objective / factor, "violation": i.violation} for i in best.history
        ],
    }


def _sentence(told: dict[str, Any]) -> str:
    """How it ended, as ``Optimum.sentence`` in the units of the page."""
    unit = f" {told['unit']}" if told["unit"] else ""
    state = "optimal" if told["success"] else "not optimal"
    return f"{told['label']} {told['start']:.4g} → {told['value']:.4g}{unit}, {state}"


def optimum_views(best: Any, units: Sequence[str] = ()) -> list[dict[str, Any]]:
    """What each parameter still does to the objective, the way there, and other optima."""
    width = {one.name: _room(one) for one in best.variables}
    reach = {n: slope * width[n] for n, slope in best.gradient.items()}
    made = []
    if max(map(abs, reach.values()), default=0.0) > FLAT * abs(best.fun):
        title = f"What each parameter does to {best.label}"
        note = "Slope at the best design, times a tenth of the range of the parameter."
        factor, unit = shown_in(best.unit, units)
        made.append(views.bars(title, {n: r / factor for n, r in reach.items()}, unit, note))
    if len(best.history) > 1:
        names = list(best.history[0].parameters)
        way = np.array([[i.parameters[n] for n in names] for i in best.history])
        low, span = way.min(axis=0), np.ptp(way, axis=0)
        moved = (way - low) / np.where(span > 0, span, 1.0)
        lines = [views.line(n, np.arange(len(way)), moved[:, k]) for k, n in enumerate(names[:7])]
        note = "Each from its least (0) to its largest value on the way (1)."
        made.append(views.curves("Parameters on the way", "iteration", "", lines, note=note))
    if len(best.optima) > 1:
        rows = [(f"optimum {k + 1}", o.objective) for k, o in enumerate(best.optima)]
        made.append(views.facts("Distinct optima", rows))
    return made


def _room(one: Any) -> float:
    """A tenth of the range of a parameter, of its size where that is open."""
    if one.lower is None or one.upper is None:
        return 0.1 * abs(one.value)
    return 0.1 * float(one.upper - one.lower)


def _ghosts(first: dict[str, Any], time: np.ndarray) -> list[dict[str, Any]]:
    """Bodies of the first design at these instants; none after its run ended."""
    at = np.array(first["time"])
    made = []
    for body in first["scene"]["bodies"]:
        if not body["shapes"] or not at.size:
            continue
        columns = {k: np.array(v, dtype=float) for k, v in body.items() if k not in STILL}
        ghost = {
            k: np.interp(time, at, column, right=np.nan).tolist() if at.size > 1 else column[0]
            for k, column in columns.items()
            if column.shape == at.shape
        }
        made.append({"shapes": body["shapes"], **ghost})
    return made
