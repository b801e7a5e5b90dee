"""Pages of what was found from measurements: parameters, or histories."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.design.pages.plain import plain_page, with_views
from dalembert.report import views

MOST_SAMPLES = 1500
"""Dots of one curve; of more samples some are left out, evenly."""
MOST_UNKNOWNS = 6
"""Unknowns of which all pairs have an ellipse."""


def identification_page(found: Any, **first_view: Any) -> dict[str, Any]:
    """What the report of an ``Identification`` shows."""
    return _of_motion(found, "identification", first_view)


def inversion_page(found: Any, **first_view: Any) -> dict[str, Any]:
    """What the report of an ``Inversion`` shows."""
    return _of_motion(found, "inverse problem", first_view)


def _of_motion(found: Any, title: str, first_view: dict[str, Any]) -> dict[str, Any]:
    motion = found.motions[0]
    if not motion.has_page:
        return plain_page(found)
    return with_views(motion.page(**first_view), found, title)


def identification_views(found: Any) -> list[dict[str, Any]]:
    """Unknowns with their intervals, data and residuals, ellipses, and what is doubtful."""
    interval, start = found.interval(), found.misfit.unknowns.start
    parameters = found.misfit.model.parameters
    units = [parameters[n].unit if n in parameters else "" for n in found.x]
    rows = [
        {
            "name": name,
            "cells": [float(first), value, found.deviation[name], *interval[name]],
            "unit": unit,
        }
        for (name, value), first, unit in zip(found.x.items(), start, units, strict=True)
    ]
    heads = ["Start", "Found", "± σ", "95 % from", "to"]
    table = {"kind": "rows", "title": "Unknowns", "heads": heads, "rows": rows}
    made = [{**table, "place": "board"}, *fits(found.misfit, found.predicted)]
    covariance = found.covariance.values
    known = np.flatnonzero(np.isfinite(np.diag(covariance)))
    if known.size >= 2:
        some = known[:MOST_UNKNOWNS]
        names = [list(found.x)[k] for k in some]
        centre = np.array(list(found.x.values()))[some]
        note = "Ellipses of 68 % and 95 % confidence, the other unknowns free."
        square = covariance[np.ix_(some, some)]
        units = [units[k] for k in some]
        made.append(views.ellipses("How sure", names, units, centre, square, note))
    kind = "given" if found.noise_given else "estimated"
    numbers = [("samples", found.samples), ("runs", found.runs)]
    numbers += [(f"noise of {c} ({kind})", f"{s:.3g}") for c, s in found.noise.items()]
    made.append(views.facts("Fit", numbers))
    if found.notes:
        made.append({"kind": "notes", "title": "Doubts", "texts": list(found.notes)})
    return made


def inversion_views(found: Any) -> list[dict[str, Any]]:
    """Histories with their bands, data and residuals, and the L-curve."""
    made = []
    for h in found.histories:
        times = np.linspace(h.knots[0], h.knots[-1], 300)
        value, (low, high) = found.values[h.name], found.intervals[h.name].T
        lines = [
            views.line("95 %", h.knots, high, "band", low=low),
            views.line(h.name, times, found.at(h.name, times)),
            views.line("knots", h.knots, value, "dots"),
        ]
        unit = h.parameters[0].unit
        label = f"{h.name} [{unit}]" if unit else h.name
        made.append({**views.curves(h.name, "time [s]", label, lines), "place": "board"})
    made += fits(found.misfit, found.predicted)
    seen = found.curve
    keep = (seen.misfit > 0) & (seen.roughness > 0)
    lines = [
        views.line("smoother →", seen.misfit[keep], seen.roughness[keep]),
        views.line("chosen", [found.misfit_norm], [found.roughness_norm], "dots"),
    ]
    made.append(
        views.curves("Smoothing", "misfit", "roughness", lines, logarithmic="xy", note="L-curve.")
    )
    numbers = [("smoothing μ", f"{found.smoothing:.4g}"), ("samples", found.misfit.size)]
    numbers += [("runs", found.misfit.runs), ("least squares", found.message)]
    made.append(views.facts("Fit", numbers))
    return made


def fits(misfit: Any, predicted: list[np.ndarray]) -> list[dict[str, Any]]:
    """Data and model of every column, and the residuals over their noise."""
    made = []
    for column in dict.fromkeys(c for o in misfit.observations for c in o.columns):
        lines, rest = [], []
        for o, model, noise in zip(misfit.observations, predicted, misfit.noise, strict=True):
            if column not in o.columns:
                continue
            j = o.columns.index(column)
            used = np.flatnonzero(np.isfinite(model[:, j]))
            if not used.size:
                continue
            some = used[np.unique(np.linspace(0, used.size - 1, MOST_SAMPLES).round().astype(int))]
            lines.append(views.line(f"{o.name}, data", o.times[some], o.values[some, j], "dots"))
            lines.append(views.line(f"{o.name}, model", o.times[some], model[some, j]))
            off = (model[some, j] - o.values[some, j]) / noise[some, j]
            rest.append(views.line(o.name, o.times[some], off, "dots"))
        made.append({**views.curves(column, "time [s]", column, lines), "place": "board"})
        title = f"Residuals of {column}"
        made.append(views.curves(title, "time [s]", "residual / σ", rest, levels=(-2.0, 2.0)))
    return made
