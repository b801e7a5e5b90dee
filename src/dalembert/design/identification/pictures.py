"""Figure and table of an identification."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np

from dalembert.design.identification.misfit import Misfit


def plot_fit(misfit: Misfit, predicted: Sequence[np.ndarray]) -> Any:
    """Figure of data and model, with residuals in standard deviations below, per column."""
    import matplotlib.pyplot as plt

    observations = misfit.observations
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
        zip(observations, predicted, misfit.noise, strict=True)
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


def identification_table(
    rows: Sequence[Sequence[str]], lines: tuple[str, str], notes: Sequence[str]
) -> str:
    """HTML table of the unknowns with their intervals and notes."""
    head = "".join(f"<th>{h}</th>" for h in ("unknown", "value", "±", "95 % interval", "unit"))
    cells = ("".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rows)
    body = "".join(f"<tr>{row}</tr>" for row in cells)
    listed = "".join(f"<li>{escape(note)}</li>" for note in notes)
    return (
        f"<p><b>Identification</b>, {escape(lines[0])}</p>"
        f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        f"<p>{escape(lines[1])}</p><ul>{listed}</ul>"
    )
