"""Pages, figure and table of identified parameters and reconstructed histories."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.decision import axis_label
from dalembert.design.identification.misfit import Misfit
from dalembert.design.pages.decision import with_views
from dalembert.design.pages.live import LiveTask
from dalembert.report import views
from dalembert.results.live import PageDesigns

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from dalembert.design.identification.identification_result import IdentificationResult
    from dalembert.design.inverse.inversion_result import InversionResult

MAX_SAMPLES = 1500
"""Upper limit of the drawn samples of one column."""
MAX_UNKNOWNS = 6
"""Upper limit of the unknowns with confidence ellipses."""


def identification_page(identification: IdentificationResult, **first_view: Any) -> dict[str, Any]:
    """Page of an ``IdentificationResult``."""
    return _motion_page(identification, "identification", first_view)


def identification_task(identification: IdentificationResult) -> LiveTask:
    """First experiment of an ``IdentificationResult`` in a live page, at the estimate."""
    motion = identification.motions[0]
    values = dict(zip(motion.model.parameters, map(float, motion.parameters), strict=False))
    names = [name for name in identification.x if name in values]

    def page(**first_view: Any) -> dict[str, Any]:
        return identification_page(identification, **first_view)

    estimate = np.array([[values[name] for name in names]])
    return LiveTask(motion, page, PageDesigns(names, estimate), ())


def inversion_page(inversion: InversionResult, **first_view: Any) -> dict[str, Any]:
    """Page of an ``InversionResult``."""
    return _motion_page(inversion, "inverse problem", first_view)


def _motion_page(
    decision: IdentificationResult | InversionResult, title: str, first_view: dict[str, Any]
) -> dict[str, Any]:
    return with_views(decision.motions[0].page(**first_view), decision, title)


def identification_views(identification: IdentificationResult) -> list[dict[str, Any]]:
    """Unknowns, fit and residuals, notes; after convergence, intervals and confidence ellipses."""
    interval, start = identification.interval(), identification.misfit.unknowns.start
    converged = identification.success
    parameters = identification.misfit.model.parameters
    units = [parameters[n].unit if n in parameters else "" for n in identification.x]
    rows = [
        {
            "name": name,
            "cells": [float(first), value]
            + ([identification.deviation[name], *interval[name]] if converged else []),
            "unit": unit,
        }
        for (name, value), first, unit in zip(identification.x.items(), start, units, strict=True)
    ]
    heads = ["Start", "Estimate", "± σ", "95 % from", "to"] if converged else ["Start", "Reached"]
    table = {"kind": "rows", "title": "Unknowns", "heads": heads, "rows": rows}
    payload = [{**table, "place": "board"}, *fits(identification.misfit, identification.predicted)]
    covariance = identification.covariance.values
    finite = np.flatnonzero(np.isfinite(np.diag(covariance)))
    if converged and finite.size >= 2:
        shown = finite[:MAX_UNKNOWNS]
        names = [list(identification.x)[k] for k in shown]
        centre = np.array(list(identification.x.values()))[shown]
        note = "Joint confidence ellipses, 68 % and 95 %, of the marginal distribution."
        square = covariance[np.ix_(shown, shown)]
        units = [units[k] for k in shown]
        payload.append(views.ellipses("Confidence ellipses", names, units, centre, square, note))
    kind = "specified" if identification.noise_specified else "estimated"
    numbers: list[tuple[str, object]] = [
        ("samples", identification.samples),
        ("runs", identification.runs),
    ]
    numbers += [(f"noise of {c} ({kind})", f"{s:.3g}") for c, s in identification.noise.items()]
    payload.append(views.facts("Fit", numbers))
    if identification.notes:
        payload.append(views.notes("Notes", identification.notes))
    return payload


def inversion_views(inversion: InversionResult) -> list[dict[str, Any]]:
    """Histories with confidence bands, fit and residuals, and the L-curve."""
    payload = []
    for history in inversion.histories:
        times = np.linspace(history.knots[0], history.knots[-1], 300)
        value, (low, high) = inversion.values[history.name], inversion.intervals[history.name].T
        lines = [
            views.line("95 %", history.knots, high, "band", low=low),
            views.line(history.name, times, inversion.at(history.name, times)),
            views.line("knots", history.knots, value, "dots"),
        ]
        unit = history.parameters[0].unit
        label = axis_label(history.name, unit)
        payload.append({**views.curves(history.name, "time [s]", label, lines), "place": "board"})
    payload += fits(inversion.misfit, inversion.predicted)
    curve = inversion.curve
    positive = (curve.misfit > 0) & (curve.roughness > 0)
    lines = [
        views.line("smoother →", curve.misfit[positive], curve.roughness[positive]),
        views.line("chosen", [inversion.misfit_norm], [inversion.roughness_norm], "dots"),
    ]
    payload.append(
        views.curves("Smoothing", "misfit", "roughness", lines, logarithmic="xy", note="L-curve.")
    )
    numbers = [("smoothing μ", f"{inversion.smoothing:.4g}"), ("samples", inversion.misfit.size)]
    numbers += [("runs", inversion.misfit.runs), ("least squares", inversion.message)]
    payload.append(views.facts("Fit", numbers))
    return payload


def fits(misfit: Misfit, predicted: Sequence[np.ndarray]) -> list[dict[str, Any]]:
    """Data, model and scaled residuals of every column."""
    payload = []
    for column in dict.fromkeys(c for o in misfit.observations for c in o.columns):
        lines, residual_lines = [], []
        for o, prediction, noise in zip(misfit.observations, predicted, misfit.noise, strict=True):
            if column not in o.columns:
                continue
            j = o.columns.index(column)
            used = np.flatnonzero(np.isfinite(prediction[:, j]))
            if not used.size:
                continue
            shown = used[np.unique(np.linspace(0, used.size - 1, MAX_SAMPLES).round().astype(int))]
            lines.append(
                views.line(
                    f"{o.name}, data",
                    o.times[shown],
                    o.values[shown, j],
                    "dots",
                )
            )
            lines.append(views.line(f"{o.name}, model", o.times[shown], prediction[shown, j]))
            residuals = (prediction[shown, j] - o.values[shown, j]) / noise[shown, j]
            residual_lines.append(views.line(o.name, o.times[shown], residuals, "dots"))
        payload.append({**views.curves(column, "time [s]", column, lines), "place": "board"})
        title = f"Residuals of {column}"
        payload.append(
            views.curves(title, "time [s]", "residual / σ", residual_lines, levels=(-2.0, 2.0))
        )
    return payload


def identification_figure(identification: IdentificationResult) -> Figure:
    """Figure of data and model, with residuals in standard deviations below, per column."""
    import matplotlib.pyplot as plt

    misfit, observations = identification.misfit, identification.misfit.observations
    columns = list(dict.fromkeys(c for o in observations for c in o.columns))
    figure, axes = plt.subplots(
        *(2, len(columns)),
        figsize=(1 + 3.6 * len(columns), 4.6),
        height_ratios=(2, 1),
        sharex=True,
        squeeze=False,
        layout="constrained",
    )
    for number, (o, prediction, noise) in enumerate(
        zip(observations, identification.predicted, misfit.noise, strict=True)
    ):
        for j, column in enumerate(o.columns):
            above, below = axes[:, columns.index(column)]
            used, colour = np.isfinite(prediction[:, j]), f"C{number}"
            time = o.times[used]
            above.plot(o.times, o.values[:, j], ".", ms=4, color=colour, alpha=0.45)
            above.plot(time, prediction[used, j], color=colour, lw=1.4, label=o.name)
            residuals = (prediction - o.values)[used, j] / noise[used, j]
            below.plot(time, residuals, ".", ms=3, color=colour)
    for column, (above, below) in zip(columns, axes.T, strict=True):
        above.set_title(column, loc="left")
        below.set(xlabel="time [s]", ylabel="residual / σ")
        for level in (-2, 2):
            below.axhline(level, color="0.6", lw=0.8, ls="--")
        for ax in (above, below):
            ax.grid(alpha=0.25)
            ax.spines[["top", "right"]].set_visible(False)
    if len(observations) > 1:
        axes[0, 0].legend(frameon=False)
    return figure


def identification_table(identification: IdentificationResult) -> str:
    """HTML table of the unknowns with their intervals and notes."""
    parameters, interval = identification.misfit.model.parameters, identification.interval()
    body = ""
    for name, value in identification.x.items():
        low, high = interval[name]
        unit = parameters[name].unit if name in parameters else ""
        deviation = identification.deviation[name]
        row = (name, f"{value:.6g}", f"{deviation:.2g}", f"{low:.6g} … {high:.6g}", unit)
        body += f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>"
    head = "".join(f"<th>{h}</th>" for h in ("unknown", "value", "±", "95 % interval", "unit"))
    kind = "specified" if identification.noise_specified else "estimated"
    noise = ", ".join(f"{column}: {level:.3g}" for column, level in identification.noise.items())
    listed = "".join(f"<li>{escape(note)}</li>" for note in identification.notes)
    return (
        f"<p><b>Identification</b>, {identification.samples} samples: "
        f"{escape(identification.message)}</p>"
        f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        f"<p>{escape(f'noise ({kind}): {noise}')}</p><ul>{listed}</ul>"
    )
