"""Static pictures with Matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from dalembert.results.labelled import LabelledRecording
from dalembert.symbolic.expression import Expression


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
        for column in series.values.reshape(series.shape[0], -1).T:
            ax.plot(motion.time, column, label=series.name, lw=1.6)
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
