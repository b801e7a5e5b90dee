"""The picture of a step study: errors of difference quotients over their steps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.results.comparison.lines import COLOURS, MARKERS, logarithmic

if TYPE_CHECKING:
    import xarray as xr

ORDERS = {"forward": 1, "backward": 1, "central": 2, "richardson": 4}


def plot_step_study(data: xr.Dataset, ax: Any = None) -> Any:
    """Draw the errors, relative ones where the exact derivative is not zero; returns the axes.

    An error of zero is drawn at the smallest round-off, where it would have no place.

    Parameters
    ----------
    data : ``scheme × step`` as ``step_study`` makes it
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
    about = data.attrs
    ax.set_title(f"{about['model']}: d {about['response']} / d {about['parameter']}", loc="left")
    for text, place, side in (("← round-off", 0.02, "left"), ("truncation →", 0.98, "right")):
        look = {"ha": side, "va": "top", "size": 8.5, "color": "0.35"}
        ax.annotate(text, (place, 0.985), xycoords="axes fraction", **look)
    ax.legend(frameon=False, loc="lower right", fontsize=8.5)
    return ax
