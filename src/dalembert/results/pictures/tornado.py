"""Tornado charts: magnitude and sign of the influence of parameters on a response."""

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
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

RISING, FALLING, NOTE_COLOUR = COLOURS[0], COLOURS[1], "0.45"
KINDS = ("relative", "range")
NEGLIGIBLE, MIN_SHARE = 1e-10, 1e-3
"""Thresholds, relative to the largest influence, for no influence and for drawn bars."""


@dataclass(frozen=True)
class Chart:
    """Chart of one response.

    Attributes
    ----------
    bars : label and size, the largest first
    unlisted : reason → names of parameters without a bar
    unit : of the bars
    """

    bars: list[tuple[str, float]]
    unlisted: dict[str, list[str]]
    unit: str

    def notes(self, most: int) -> list[str]:
        """Notes on parameters without a bar."""
        remaining = self.bars[most:]
        lines = (
            [f"{len(remaining)} more, each at most {abs(remaining[0][1]):.2g}"] if remaining else []
        )
        for reason, names in self.unlisted.items():
            if names:
                more = f" and {len(names) - 6} more" if len(names) > 6 else ""
                lines.append(f"{reason}: {', '.join(names[:6])}{more}")
        return lines


@check_arguments
def tornado(
    gradient: xr.DataArray, kind: str = "relative", most: int = 15, axes: Any = None
) -> Any:
    """Draw the influence of the parameters on every response, in descending order.

    Parameters
    ----------
    gradient : as ``sensitivity`` returns it
    kind : ``"relative"``, change of the response for one percent more of a parameter, in percent,
        or in its unit where it is zero; or ``"range"``, its change from the middle to the upper
        end of the parameter's bounds
    most : maximum number of bars per response; the others are summarised below
    axes : as many as there are responses; a new figure by default

    Returns
    -------
    the axes, an array of axes for several responses

    Raises
    ------
    AnalysisError
        Unknown kind, parameters without bounds, or a gradient without labels.

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
    rows = [min(len(chart.bars), most) + 0.45 * len(chart.notes(most)) for chart in charts]
    if axes is None:
        axes, rows = _new_axes(rows, gradient)
    panels = np.atleast_1d(np.asarray(axes, dtype=object)).ravel()
    if panels.size != len(charts):
        raise AnalysisError(f"{len(charts)} responses need as many axes; got {panels.size}")
    for ax, response, chart, height in zip(
        panels, gradient["response"].values, charts, rows, strict=True
    ):
        _draw(ax, chart, most, height)
        entry = gradient.sel(response=response)
        value = f"{float(entry['response_value']):.5g} {entry['response_unit'].item()}".rstrip()
        title = f"{response} = {value}".replace("-", "−")
        ax.set_title(title, loc="left", size=10.5, weight="bold")
        step = "1 % more of the parameter" if kind == "relative" else "half the width of its bounds"
        ax.set_xlabel(f"change [{chart.unit}] for {step}", size=9)
    return panels[0] if panels.size == 1 else panels


def save_tornado(gradient: xr.DataArray, path: str | Path, kind: str = "relative") -> Path:
    """Write the chart; the suffix selects the format: .png, .svg or .pdf."""
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
        influence = range_influence(part)
        if not np.isfinite(influence).any():
            raise AnalysisError(
                "no parameter has bounds on both sides; give them, or use kind='relative'"
            )
    else:
        influence, percent = relative_influence(part), "%"
        unit = percent if np.isfinite(influence).all() else unit
        influence = influence if unit == percent else absolute_influence(part) / 100
    sizes = influence.values[0]
    share = np.abs(sizes) / (np.nanmax(np.abs(sizes)) or 1.0)
    independent = part.values[0] == 0.0
    share[(share == 0.0) & ~independent] = np.nan  # a relative change of zero is undefined
    share[independent] = 0.0
    order = [int(k) for k in np.argsort(-np.nan_to_num(share), kind="stable")]
    names = [str(n) for n in part["parameter"].values]
    undefined = "zero, without relative change" if kind == "relative" else "without bounds"
    return Chart(
        [
            (_label(part.isel(parameter=k), kind), float(sizes[k]))
            for k in order
            if share[k] > MIN_SHARE
        ],
        {
            "hardly any influence": [names[k] for k in order if NEGLIGIBLE < share[k] <= MIN_SHARE],
            "no influence": [names[k] for k in order if share[k] <= NEGLIGIBLE],
            undefined: [names[k] for k in order if np.isnan(share[k])],
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
    """New axes in one column, two from three responses on; and their heights in rows."""
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
            Patch(color=RISING, label="rises with the parameter"),
            Patch(color=FALLING, label="falls"),
        ],
        loc="outside lower left",
        ncols=2,
        frameon=False,
        fontsize=9,
    )
    return axes.ravel()[: len(rows)], [tallest[k // across] for k in range(len(rows))]


def _draw(ax: Axes, chart: Chart, most: int, height: float) -> None:
    bars = chart.bars[:most]
    sizes = np.array([x for _, x in bars])
    positions = np.arange(sizes.size)
    ax.barh(positions, sizes, height=0.64, color=np.where(sizes > 0, RISING, FALLING), zorder=2)
    ax.set_yticks(positions, [name for name, _ in bars], size=9)
    for position, size in zip(positions, sizes, strict=True):
        ax.annotate(
            _number(size),
            (size, position),
            xytext=(4 if size > 0 else -4, 0),
            textcoords="offset points",
            ha="left" if size > 0 else "right",
            va="center",
            size=8.5,
            color="0.2",
        )
    ax.axvline(0, color="0.25", lw=0.9, zorder=3)
    _reserve_label_space(ax, sizes)
    ax.set_ylim(max(height, 1.0) - 0.4, -0.6)
    ax.grid(axis="x", alpha=0.25)
    ax.set_axisbelow(True)
    ax.spines[["top", "right", "left"]].set_visible(False)
    ax.tick_params(axis="y", length=0)
    ax.tick_params(axis="x", labelsize=8.5)
    ax.annotate(
        "\n".join(chart.notes(most)),
        (1, 0),
        xycoords="axes fraction",
        xytext=(0, 4),
        textcoords="offset points",
        ha="right",
        va="bottom",
        size=8,
        color=NOTE_COLOUR,
    )


def _reserve_label_space(ax: Axes, sizes: np.ndarray) -> None:
    """Widen the axis for the numbers at the ends of the bars."""
    low, high = min(sizes.min(initial=0.0), 0.0), max(sizes.max(initial=0.0), 0.0)
    width = (high - low) or 1.0
    label_width = 0.06 + 0.017 * max((len(_number(size)) for size in sizes), default=0)
    ax.set_xlim(
        low - (label_width if low < 0 else 0.03) * width,
        high + (label_width if high > 0 else 0.03) * width,
    )


def _number(size: float) -> str:
    return f"{size:+.3g}".replace("-", "−")
