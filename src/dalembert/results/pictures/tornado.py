"""Tornado charts: which parameters move a response, how far, and in which direction."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.files import atomic_path
from dalembert.results.comparison.lines import COLOURS
from dalembert.results.pictures.influence import (
    absolute_influence,
    range_influence,
    relative_influence,
)
from dalembert.text.spelling import spelled

if TYPE_CHECKING:
    import xarray as xr

RISES, FALLS, QUIET = COLOURS[0], COLOURS[1], "0.45"
KINDS = ("relative", "range")
NONE, SMALL = 1e-10, 1e-3
"""Shares of the largest influence that count as none, and that are too small to be drawn."""


@dataclass(frozen=True)
class Chart:
    """What is drawn for one response.

    Attributes
    ----------
    bars : label and size, the largest first
    others : what is said of parameters without a bar → their names
    unit : of the bars
    """

    bars: list[tuple[str, float]]
    others: dict[str, list[str]]
    unit: str

    def told(self, most: int) -> list[str]:
        """What the bars do not show."""
        left = self.bars[most:]
        lines = [f"{len(left)} more, each at most {abs(left[0][1]):.2g}"] if left else []
        for what, names in self.others.items():
            if names:
                more = f" and {len(names) - 6} more" if len(names) > 6 else ""
                lines.append(f"{what}: {', '.join(names[:6])}{more}")
        return lines


@spelled
def tornado(
    gradient: xr.DataArray, kind: str = "relative", most: int = 15, axes: Any = None
) -> Any:
    """Draw the influence of the parameters on every response, the largest on top.

    Parameters
    ----------
    gradient : as ``sensitivity`` returns it
    kind : ``"relative"``, change of the response for one percent more of a parameter, in percent,
        or in its unit where it is zero; or ``"range"``, its change from the middle to the upper
        end of the parameter's bounds
    most : bars per response; what is left is told below them
    axes : as many as there are responses; a new figure by default

    Returns
    -------
    the axes, an array of them where there are several responses

    Raises
    ------
    AnalysisError
        Another kind, parameters without bounds, or a gradient without its labels.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> a, b = system.parameter("a", 3.0), system.parameter("b", 10.0)
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(a, b)))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1)
    >>> axes = da.tornado(da.sensitivity(motion, da.final("stone.x")))
    >>> len(axes.patches)  # one bar: "b" has no influence
    1
    """
    if kind not in KINDS:
        raise AnalysisError(f"no tornado chart {kind!r}; known: {', '.join(KINDS)}")
    charts = [_chart(gradient, str(r), kind) for r in gradient["response"].values]
    rows = [min(len(chart.bars), most) + 0.45 * len(chart.told(most)) for chart in charts]
    if axes is None:
        axes, rows = _new_axes(rows, gradient)
    panels = np.atleast_1d(np.asarray(axes, dtype=object)).ravel()
    if panels.size != len(charts):
        raise AnalysisError(f"{len(charts)} responses need as many axes; got {panels.size}")
    for ax, response, chart, room in zip(
        panels, gradient["response"].values, charts, rows, strict=True
    ):
        _draw(ax, chart, most, room)
        here = gradient.sel(response=response)
        value = f"{float(here['response_value']):.5g} {here['response_unit'].item()}".rstrip()
        title = f"{response} = {value}".replace("-", "−")
        ax.set_title(title, loc="left", size=10.5, weight="bold")
        step = "1 % more of the parameter" if kind == "relative" else "half the width of its bounds"
        ax.set_xlabel(f"change [{chart.unit}] for {step}", size=9)
    return panels[0] if panels.size == 1 else panels


def save_tornado(gradient: xr.DataArray, path: str | Path, kind: str = "relative") -> Path:
    """Write the chart, its format by the name: .png, .svg or .pdf."""
    import matplotlib.pyplot as plt

    figure = np.atleast_1d(tornado(gradient, kind))[0].figure
    with atomic_path(path) as temporary:
        figure.savefig(temporary, dpi=150)
    plt.close(figure)
    return Path(path)


def _chart(gradient: xr.DataArray, response: str, kind: str) -> Chart:
    part = gradient.sel(response=[response])
    unit = str(part["response_unit"].values[0]) or "-"
    if kind == "range":
        found = range_influence(part)
        if not np.isfinite(found).any():
            raise AnalysisError(
                "no parameter has bounds on both sides; give them, or use kind='relative'"
            )
    else:
        found, percent = relative_influence(part), "%"
        unit = percent if np.isfinite(found).all() else unit
        found = found if unit == percent else absolute_influence(part) / 100
    sizes = found.values[0]
    share = np.abs(sizes) / (np.nanmax(np.abs(sizes)) or 1.0)
    still = part.values[0] == 0.0
    share[(share == 0.0) & ~still] = np.nan  # a percent of zero is nothing
    share[still] = 0.0
    order = [int(k) for k in np.argsort(-np.nan_to_num(share), kind="stable")]
    names = [str(n) for n in part["parameter"].values]
    unknown = "zero, of which 1 % is nothing" if kind == "relative" else "without bounds"
    return Chart(
        [
            (_label(part.isel(parameter=k), kind), float(sizes[k]))
            for k in order
            if share[k] > SMALL
        ],
        {
            "hardly any influence": [names[k] for k in order if NONE < share[k] <= SMALL],
            "no influence": [names[k] for k in order if share[k] <= NONE],
            unknown: [names[k] for k in order if np.isnan(share[k])],
        },
        unit,
    )


def _label(entry: xr.DataArray, kind: str) -> str:
    name, unit = str(entry["parameter"].item()), entry["parameter_unit"].item()
    if kind == "range":
        text = f"{float(entry['lower']):.4g} … {float(entry['upper']):.4g}"
    else:
        text = f"{float(entry['parameter_value']):.4g}"
    return f"{name} = {text.replace('-', '−')} {unit}".rstrip()


def _new_axes(rows: list[float], gradient: xr.DataArray) -> tuple[np.ndarray, list[float]]:
    """One pair of axes below the other, two columns of them from three on; and their rows."""
    import matplotlib.pyplot as plt
    from matplotlib.patches import Patch

    across = 1 if len(rows) < 3 else 2
    down = -(-len(rows) // across)
    tallest = [max(rows[k * across : (k + 1) * across]) for k in range(down)]
    heights = [0.27 * n + 0.8 for n in tallest]
    figure, axes = plt.subplots(
        down,
        across,
        figsize=(6.6 * across, sum(heights) + 0.75),
        height_ratios=heights,
        layout="constrained",
        squeeze=False,
    )
    for ax in axes.ravel()[len(rows) :]:
        ax.set_visible(False)
    figure.suptitle(
        f"{gradient.attrs.get('model', '')}: influence of the parameters",
        x=0.01,
        ha="left",
        size=12,
        weight="bold",
    )
    figure.legend(
        handles=[
            Patch(color=RISES, label="rises with the parameter"),
            Patch(color=FALLS, label="falls"),
        ],
        loc="outside lower left",
        ncols=2,
        frameon=False,
        fontsize=9,
    )
    return axes.ravel()[: len(rows)], [tallest[k // across] for k in range(len(rows))]


def _draw(ax: Any, chart: Chart, most: int, rows: float) -> None:
    shown = chart.bars[:most]
    sizes = np.array([x for _, x in shown])
    places = np.arange(sizes.size)
    ax.barh(places, sizes, height=0.64, color=np.where(sizes > 0, RISES, FALLS), zorder=2)
    ax.set_yticks(places, [name for name, _ in shown], size=9)
    for place, size in zip(places, sizes, strict=True):
        ax.annotate(
            _number(size),
            (size, place),
            xytext=(4 if size > 0 else -4, 0),
            textcoords="offset points",
            ha="left" if size > 0 else "right",
            va="center",
            size=8.5,
            color="0.2",
        )
    ax.axvline(0, color="0.25", lw=0.9, zorder=3)
    _room(ax, sizes)
    ax.set_ylim(max(rows, 1.0) - 0.4, -0.6)
    ax.grid(axis="x", alpha=0.25)
    ax.set_axisbelow(True)
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.tick_params(axis="y", length=0)
    ax.tick_params(axis="x", labelsize=8.5)
    ax.annotate(
        "\n".join(chart.told(most)),
        (1, 0),
        xycoords="axes fraction",
        xytext=(0, 4),
        textcoords="offset points",
        ha="right",
        va="bottom",
        size=8,
        color=QUIET,
    )


def _room(ax: Any, sizes: np.ndarray) -> None:
    """Space for the numbers at the ends of the bars."""
    low, high = min(sizes.min(initial=0.0), 0.0), max(sizes.max(initial=0.0), 0.0)
    width = (high - low) or 1.0
    text = 0.06 + 0.017 * max((len(_number(size)) for size in sizes), default=0)
    ax.set_xlim(
        low - (text if low < 0 else 0.03) * width, high + (text if high > 0 else 0.03) * width
    )


def _number(size: float) -> str:
    return f"{size:+.3g}".replace("-", "−")
