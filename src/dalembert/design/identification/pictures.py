"""Pictures and the page of an identification."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from dalembert.design.identification.identified import Identification


def plot_fit(found: Identification) -> Any:
    """Data with the model above, residuals in standard deviations below; one column each."""
    import matplotlib.pyplot as plt

    columns = list(found.noise)
    figure, axes = plt.subplots(
        *(2, len(columns)),
        figsize=(1 + 3.6 * len(columns), 4.6),
        height_ratios=(2, 1),
        sharex=True,
        squeeze=False,
        layout="constrained",
    )
    observations = found.misfit.observations
    for e, (o, model, noise) in enumerate(
        zip(observations, found.predicted, found.misfit.noise, strict=True)
    ):
        for j, column in enumerate(o.columns):
            above, below = axes[:, columns.index(column)]
            used, colour = np.isfinite(model[:, j]), f"C{e}"
            time = o.times[used]
            above.plot(o.times, o.values[:, j], ".", ms=4, color=colour, alpha=0.45)
            above.plot(time, model[used, j], color=colour, lw=1.4, label=o.name)
            rest = (model - o.values)[used, j] / noise[used, j]
            below.plot(time, rest, ".", ms=3, color=colour)
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


def html(found: Identification) -> str:
    """Table of the unknowns with their intervals, and what is doubtful."""
    parameters = found.misfit.model.parameters
    interval, rows = found.interval(), []
    for (name, value), deviation in zip(found.x.items(), found.deviation.values(), strict=True):
        low, high = interval[name]
        unit = parameters[name].unit if name in parameters else ""
        cells = (name, f"{value:.6g}", f"{deviation:.2g}", f"{low:.6g} … {high:.6g}", unit)
        rows.append("".join(f"<td>{escape(cell)}</td>" for cell in cells))
    head = "".join(f"<th>{h}</th>" for h in ("unknown", "value", "±", "95 % interval", "unit"))
    body = "".join(f"<tr>{row}</tr>" for row in rows)
    noise = ", ".join(f"{escape(c)}: {s:.3g}" for c, s in found.noise.items())
    notes = "".join(f"<li>{escape(note)}</li>" for note in found.notes)
    kind = "given" if found.noise_given else "estimated"
    return (
        f"<p><b>Identification</b>, {found.samples} samples: {escape(found.message)}</p>"
        f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
        f"<p>noise ({kind}): {noise}</p><ul>{notes}</ul>"
    )
