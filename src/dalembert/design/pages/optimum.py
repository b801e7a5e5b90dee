"""Page and notebook table of an optimum, with the initial design as a ghost."""

from __future__ import annotations

import html
from collections.abc import Sequence
from copy import deepcopy
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.limit import Bounded
from dalembert.design.pages.decision import verdict
from dalembert.design.pages.live import LiveTask, responses_of
from dalembert.report import views
from dalembert.results.files.tables import checked_units
from dalembert.results.live import PageDesigns
from dalembert.units.unit import shown_in

if TYPE_CHECKING:
    from dalembert.design.optimize.optimization_result import OptimizationResult

FLAT = 1e-6
"""Threshold of the relative change of the objective below which slopes are not drawn [-]."""
CONSTANT_KEYS = ("name", "node", "shapes")
"""Keys of a body that do not depend on time."""


def optimum_page(optimum: OptimizationResult, **first_view: Any) -> dict[str, Any]:
    """Page of an ``OptimizationResult``."""
    units = checked_units(first_view.get("units") or ())
    page = optimum.motion.page(**first_view)
    page["title"] += ": optimum" if optimum.success else ": best design reached"
    page["optimum"] = optimum_payload(optimum, units)
    page["views"] = [*page.get("views", ()), *optimum_views(optimum, units)]
    page["verdict"] = verdict(optimum)
    if units:
        page["verdict"]["text"] = _sentence(page["optimum"], optimum.state)
    first = optimum.initial.page()
    if page.get("kind") == "structure":
        page["scene"]["ghosts"] = [{"mesh": first["scene"]["mesh"]}]
    elif "states" in page:
        page["scene"]["ghosts"] = deepcopy(first["scene"]["bodies"])  # without formulas
    elif "scene" in page and page.get("time"):
        page["scene"]["ghosts"] = _ghosts(first, np.array(page["time"]))
    return page


def optimum_task(optimum: OptimizationResult) -> LiveTask | None:
    """Iterates of an ``OptimizationResult`` in a live page; the start is the initial design."""
    quantities, names = optimum.quantities, list(optimum.x)
    cases = [term.case for quantity in quantities for term in quantity.terms]
    if not cases:
        return None
    values = np.array([[iterate.parameters[n] for n in names] for iterate in optimum.history])
    own = [n in optimum.motion.model.parameters for n in names]
    designs = PageDesigns(
        [n for n, is_own in zip(names, own, strict=True) if is_own], values[:, own], 0
    )

    def page(**first_view: Any) -> dict[str, Any]:
        units = checked_units(first_view.get("units") or ())
        return optimum_page(optimum, **first_view) | {"designs": _iterates(optimum, units)}

    return LiveTask(optimum.motion, page, designs, responses_of(quantities, cases[0]))


def _iterates(optimum: OptimizationResult, units: Sequence[str]) -> dict[str, Any]:
    """Table of the iterates; the last one is the optimum, or the best design reached."""
    factor, unit = shown_in(optimum.unit, units)
    history, last = optimum.history, len(optimum.history) - 1
    columns = [(optimum.label, unit, "aim", [iterate.objective / factor for iterate in history])]
    if optimum.limits:
        violations = [iterate.violation for iterate in history]
        columns.append(("violation", "", "aim", violations))
    for variable in optimum.variables:
        size, shown = shown_in(variable.unit, (*units, *filter(None, [variable.declared_unit])))
        values = [iterate.parameters[variable.name] / size for iterate in history]
        columns.append((variable.name, shown, "parameter", values))
    end = "optimum" if optimum.success else "best design"
    labels = ["start", *(f"iteration {k}" for k in range(1, last)), end]
    return views.designs(columns, labels=labels[: last + 1], chosen=last)


def optimum_payload(optimum: OptimizationResult, units: Sequence[str] = ()) -> dict[str, Any]:
    """Objective, variables, limits, prices and history, in the first of ``units`` that fits."""
    factor, unit = shown_in(optimum.unit, units)
    variables = [bounded.shown_in(units, (factor, unit)) for bounded in optimum.variables]
    limits = [bounded.shown_in(units, (factor, unit)) for bounded in optimum.limits]
    prices = [bounded.cost(unit) for bounded in (*limits, *variables)]
    return {
        "label": optimum.label,
        "unit": unit,
        "start": optimum.history[0].objective / factor,
        "value": optimum.fun / factor,
        "success": optimum.success,
        "message": optimum.message,
        "variables": [asdict(bounded) for bounded in variables],
        "limits": [asdict(bounded) for bounded in limits],
        "prices": [text for text in prices if text],
        "history": [
            {"objective": iterate.objective / factor, "violation": iterate.violation}
            for iterate in optimum.history
        ],
    }


def _sentence(payload: dict[str, Any], state: str) -> str:
    """``OptimizationResult.sentence`` in the units of the page."""
    unit = f" {payload['unit']}" if payload["unit"] else ""
    return f"{payload['label']} {payload['start']:.4g} → {payload['value']:.4g}{unit}, {state}"


def optimum_views(optimum: OptimizationResult, units: Sequence[str] = ()) -> list[dict[str, Any]]:
    """Slopes of the objective, history of the parameters, and other optima."""
    width = {variable.name: _tenth_of_range(variable) for variable in optimum.variables}
    reach = {n: slope * width[n] for n, slope in optimum.gradient.items()}
    payload = []
    if max(map(abs, reach.values()), default=0.0) > FLAT * abs(optimum.fun):
        title = f"Sensitivity of {optimum.label}"
        note = "Gradient at the best design times a tenth of the range of the parameter."
        factor, unit = shown_in(optimum.unit, units)
        payload.append(
            views.bars(title, {n: change / factor for n, change in reach.items()}, unit, note)
        )
    if len(optimum.history) > 1:
        names = list(optimum.history[0].parameters)
        designs = np.array([[iterate.parameters[n] for n in names] for iterate in optimum.history])
        low, span = designs.min(axis=0), np.ptp(designs, axis=0)
        scaled = (designs - low) / np.where(span > 0, span, 1.0)
        lines = [
            views.line(n, np.arange(len(designs)), scaled[:, k]) for k, n in enumerate(names[:7])
        ]
        note = "Each scaled from its minimum (0) to its maximum (1) over the iterations."
        payload.append(views.curves("History of the parameters", "iteration", "", lines, note=note))
    if len(optimum.optima) > 1:
        rows = [(f"optimum {k + 1}", other.objective) for k, other in enumerate(optimum.optima)]
        payload.append(views.facts("Distinct optima", rows))
    return payload


def _tenth_of_range(variable: Bounded) -> float:
    """Tenth of the range of a parameter, or of its value if it is unbounded."""
    if variable.lower is None or variable.upper is None:
        return 0.1 * abs(variable.value)
    return 0.1 * float(variable.upper - variable.lower)


def _ghosts(first: dict[str, Any], time: np.ndarray) -> list[dict[str, Any]]:
    """Bodies of the initial design at given instants; NaN after the end of its run."""
    instants = np.array(first["time"])
    ghosts = []
    for body in first["scene"]["bodies"]:
        if not body["shapes"] or not instants.size:
            continue
        columns = {k: np.array(v, dtype=float) for k, v in body.items() if k not in CONSTANT_KEYS}
        ghost = {
            k: np.interp(time, instants, column, right=np.nan).tolist()
            if instants.size > 1
            else column[0]
            for k, column in columns.items()
            if column.shape == instants.shape
        }
        ghosts.append({"shapes": deepcopy(body["shapes"]), **ghost})  # without formulas
    return ghosts


def optimum_table(optimum: OptimizationResult) -> str:
    """HTML of an optimum: objective, parameters, limits and prices; names are escaped."""
    unit = html.escape(optimum.unit)
    start = optimum.history[0].objective
    rows = [_row("th", "", "unit", "lower", "start", "best", "upper", "price")]
    rows.append(_row("td", optimum.label, optimum.unit, "", start, optimum.fun, "", ""))
    for bounded in (*optimum.limits, *optimum.variables):
        rows.append(_bounded_row(bounded.shown_in((), (1.0, optimum.unit))))
    mark = "✓" if optimum.success else "✗"
    return (
        f"<div><b>{mark} {html.escape(optimum.message)}</b><table>{''.join(rows)}</table>"
        f"<small>price: improvement of the objective{f' [{unit}]' if unit else ''} per unit by "
        f"which an active limit is relaxed; {optimum.runs} runs, {optimum.gradients} "
        f"gradients</small></div>"
    )


def _bounded_row(bounded: Bounded) -> str:
    def side(name: str) -> str:
        value = getattr(bounded, name)
        text = "" if value is None else f"{value:.6g}"
        return f"<b>{text}</b>" if bounded.active == name else text

    cells = [html.escape(bounded.name), html.escape(bounded.unit), side("lower")]
    cells += [f"{bounded.start:.6g}", f"{bounded.value:.6g}", side("upper")]
    cells.append(f"{bounded.price:.4g}" if bounded.active and bounded.price else "")
    return "<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


def _row(tag: str, *cells: str | float) -> str:
    texts = [html.escape(c) if isinstance(c, str) else f"{c:.6g}" for c in cells]
    return "<tr>" + "".join(f"<{tag}>{text}</{tag}>" for text in texts) + "</tr>"
