"""Work–precision pictures and the chart of speed ratios."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import EngFormatter, LogLocator, NullFormatter

from benchmarks.precision import Curve
from benchmarks.sample import Row
from benchmarks.table import ratio, ratio_text

MARKS = "osv^D*Px"
CHART = (
    ("four-bar", "one step", "four-bar, one step"),
    ("40 four-bars", "time to an error of 1e-06 m", "40 four-bars, run to an error of 1 µm"),
    ("7-link arm", "one step", "7-link arm, one step"),
    ("plate of 103362 unknowns", "analysis", "plate of 100,000 unknowns, linear statics"),
    ("40 four-bars, 81 parameters", "run and gradient", "40 four-bars, gradient by 81 parameters"),
)
"""Case, quantity and label of the bars of the chart."""


def draw(name: str, curves: Sequence[Curve], folder: Path) -> Path:
    """Error over time, both logarithmic, one line for everyone."""
    figure, ax = plt.subplots(figsize=(6, 4.2), layout="constrained")
    for mark, curve in zip(MARKS * 2, curves, strict=False):
        shown = [p for p in curve.points if np.isfinite(p.error)]
        seconds, errors = [p.seconds for p in shown], [p.error for p in shown]
        ax.loglog(seconds, errors, marker=mark, label=curve.contestant.name)
    ax.xaxis.set_major_locator(LogLocator(subs=(1.0, 3.0)))
    ax.xaxis.set_major_formatter(EngFormatter("s"))
    ax.xaxis.set_minor_formatter(NullFormatter())
    ax.set_xlabel("time of the run")
    ax.set_ylabel("error of the observed point [m]")
    ax.set_title(name)
    ax.grid(which="major", alpha=0.3)
    ax.legend(fontsize=8)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{name.replace(' ', '_')}.svg"
    figure.savefig(path)
    plt.close(figure)
    return path


def speed_chart(rows: Sequence[Row], path: Path) -> None:
    """Bars of the time of the fastest peer divided by that of dalembert, on a logarithmic axis."""
    by_name = {(row.case, row.quantity): row for row in rows}
    bars = [
        (label, value, f"{ratio_text(row)} ({_fastest_peer(row)})")
        for case, quantity, label in CHART
        if (row := by_name.get((case, quantity))) and (value := ratio(row))
    ]
    if not bars:
        return
    figure, ax = plt.subplots(figsize=(8, 0.45 * len(bars) + 0.8), layout="constrained")
    for k, (_, value, text) in enumerate(bars):
        ax.barh(k, value, color="#0b63a5", height=0.6)
        ax.text(value * 1.1, k, text, va="center", fontsize=9)
    ax.set_yticks(range(len(bars)), [label for label, _, _ in bars])
    ax.invert_yaxis()
    ax.set_xscale("log")
    ax.set_xlim(1, 30 * max(value for _, value, _ in bars))
    ax.xaxis.set_major_formatter(lambda value, _: f"{value:,.0f}")
    ax.set_xlabel("time of the fastest peer ÷ time of dalembert")
    ax.spines[["top", "right"]].set_visible(False)
    with plt.rc_context({"svg.fonttype": "none", "svg.hashsalt": "speed"}):
        figure.savefig(path, metadata={"Date": None})
    plt.close(figure)


def _fastest_peer(row: Row) -> str:
    peers = {name: s.median for name, s in row.samples.items() if not name.startswith("dalembert")}
    return min(peers, key=peers.__getitem__)
