"""Static pictures with Matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from dalembert.results.labelled import LabelledRecording
from dalembert.symbolic.formulas.expression import Expression

BEFORE = 1e-9
"""Time before an impact, relative to the run, at which it is looked at."""


def plot_measures(
    motion: LabelledRecording, measures: Sequence[str | Expression], ax: Any = None
) -> Any:
    """Measures over time in one pair of axes; units on the axis, events as lines."""
    import matplotlib.pyplot as plt

    if ax is None:
        _, ax = plt.subplots(figsize=(7, 3.6), layout="constrained")
    units = []
    for measure in measures:
        series = motion[measure]
        units.append(series.attrs["units"])
        time, values = broken_at_impacts(motion, measure, series.values)
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


def broken_at_impacts(
    motion: LabelledRecording, measure: str | Expression, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Times and values with both sides of every impact, and nothing to be drawn between them."""
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
