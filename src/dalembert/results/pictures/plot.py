"""Line plots with Matplotlib: measures over time, and step studies."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.results.comparison.lines import COLOURS, MARKERS, logarithmic
from dalembert.symbolic.formulas.expression import Expression

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


BEFORE = 1e-9
"""Offset of the sample before an impact, relative to the run."""


def plot_measures(
    motion: Any, measures: Sequence[str | Expression], ax: Axes | None = None
) -> Axes:
    """Plot measures over time in one pair of axes, with units and events."""
    import matplotlib.pyplot as plt

    if ax is None:
        _, ax = plt.subplots(figsize=(7, 3.6), layout="constrained")
    units = []
    for measure in measures:
        series = motion[measure]
        units.append(series.attrs["units"])
        time, values = split_at_impacts(motion, measure, series.values)
        for column in values.reshape(time.size, -1).T:
            ax.plot(time, column, label=series.name, lw=1.6)
    for event in motion.events:
        ax.axvline(event.time, color="0.6", lw=0.8, ls="--")
        ax.annotate(event.name, (event.time, 1), xycoords=("data", "axes fraction"), fontsize=8)
    ax.set_xlabel("time [s]")
    shared = set(units)
    unit = f" [{units[0]}]" if len(shared) == 1 and units[0] else ""
    ax.set_ylabel((str(measures[0]) if len(measures) == 1 else "") + unit)
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
    if len(measures) > 1:
        ax.legend(frameon=False)
    return ax


def split_at_impacts(
    motion: Any, measure: str | Expression, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Times and values with samples before and after every impact, separated by NaN."""
    span = motion.time[[0, -1]] if motion.time.size else np.zeros(2)
    inside = np.unique([i.time for i in motion.impacts if span[0] < i.time < span[1]])
    if not inside.size:
        return motion.time, values
    before = motion.at(np.maximum(inside - BEFORE * np.ptp(span), span[0]))
    after = motion.at(inside)
    gap = np.full((inside.size, *values.shape[1:]), np.nan)
    rows = [before[measure].values, gap, after[measure].values, values]
    times = np.concatenate([before.time, inside, inside, motion.time])
    order = np.argsort(times, kind="stable")
    return times[order], np.concatenate(rows)[order]


ORDERS = {"forward": 1, "backward": 1, "central": 2, "richardson": 4}


def plot_step_study(data: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the errors, relative ones where the exact derivative is not zero; returns the axes.

    An error of zero is drawn at round-off level, because the axis is logarithmic.

    Parameters
    ----------
    data : ``scheme × step`` as returned by ``step_study``
    """
    import matplotlib.pyplot as plt

    if ax is None:
        _, ax = plt.subplots(figsize=(7, 4.4), layout="constrained")
    relative = bool(np.isfinite(data["relative_error"]).any())
    error = data["relative_error" if relative else "error"]
    floor = np.finfo(float).eps / 4 * (1.0 if relative else max(abs(float(data["exact"])), 1.0))
    for k, scheme in enumerate(data["scheme"].values):
        order = ORDERS.get(str(scheme))
        ax.plot(
            data["step"],
            np.maximum(error.sel(scheme=scheme), floor),
            color=COLOURS[k % len(COLOURS)],
            marker=MARKERS[k % len(MARKERS)],
            ms=5,
            mec="white",
            mew=0.6,
            lw=1.6,
            label=f"{scheme}, order {order}" if order else str(scheme),
        )
    logarithmic(ax)
    unit = data["error"].attrs.get("units", "")
    ax.set_xlabel("step, relative to the parameter")
    ax.set_ylabel("relative error [-]" if relative else f"error [{unit or '-'}]")
    attributes = data.attrs
    ax.set_title(
        f"{attributes['model']}: d {attributes['response']} / d {attributes['parameter']}",
        loc="left",
    )
    for text, position, side in (("← round-off", 0.02, "left"), ("truncation →", 0.98, "right")):
        place = (position, 0.985)
        ax.annotate(
            text, place, xycoords="axes fraction", ha=side, va="top", size=8.5, color="0.35"
        )
    ax.legend(frameon=False, loc="lower right", fontsize=8.5)
    return ax
