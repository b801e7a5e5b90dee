"""Work–precision pictures."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import EngFormatter, LogLocator, NullFormatter

from benchmarks.precision import Curve

MARKS = "osv^D*Px"


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
