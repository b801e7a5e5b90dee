"""Plots of a comparison: errors, violations and energy errors against integration time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.comparison.lines import (
    LineStyle,
    add_legend,
    decimal_ticks,
    draw_lines,
    label_lines,
    line_styles,
    logarithmic,
    reserve_label_space,
    shade_uncertainty,
)
from dalembert.results.comparison.table import brief

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from dalembert.results.comparison.data import ComparisonData

MAX_STYLES = 2
"""Upper limit of line styles in one panel."""
EFFORT = "integration time of the run [ms]"


@dataclass(frozen=True)
class PictureKind:
    """A kind of plot: its panels, and the order of choices for colours, dashes and markers."""

    panels: tuple[tuple[str, str], ...]
    order: tuple[str, str, str, str]
    title: str


KINDS = {
    "work-precision": PictureKind(
        (("error_position", "error of {measure}"),),
        ("integrator", "formulation", "stabilization", "coordinates"),
        "accuracy against effort",
    ),
    "violations": PictureKind(
        (
            ("position_violation", "violation of the constraints [m or rad]"),
            ("velocity_violation", "violation of their rates [m/s or rad/s]"),
        ),
        ("stabilization", "integrator", "formulation", "coordinates"),
        "maximum violation against effort",
    ),
    "energy": PictureKind(
        (("energy_error", "energy error / maximum kinetic energy"),),
        ("integrator", "formulation", "stabilization", "coordinates"),
        "energy balance against effort",
    ),
}


def plot_comparison(comparison: ComparisonData, kind: str, ax: Axes | None = None) -> Any:
    """Draw one of ``KINDS``; returns the axes, or an array of axes for several panels."""
    if kind not in KINDS:
        raise AnalysisError(f"no picture {kind!r}; known: {', '.join(KINDS)}")
    picture = KINDS[kind]
    table = comparison.table()[comparison.finished]
    if not len(table):
        raise AnalysisError("nothing to draw: no run finished")
    styles = line_styles(table, picture.order)
    several = len(styles[1][1]) > MAX_STYLES and len(picture.panels) == 1 and ax is None
    draw = _small_multiples if several else _draw_panels
    axes = draw(comparison, table, picture, styles, ax)
    return axes[0] if axes.size == 1 else axes


def _draw_panels(
    comparison: ComparisonData,
    table: pd.DataFrame,
    picture: PictureKind,
    styles: list[LineStyle],
    ax: Axes | None,
) -> np.ndarray:
    """Draw all lines in one pair of axes per quantity."""
    import matplotlib.pyplot as plt

    count, creates_figure = len(picture.panels), ax is None
    if creates_figure:
        size = (8.2 if count == 1 else 11, 4.9)
        _, ax = plt.subplots(1, count, figsize=size, layout="constrained")
    axes = np.atleast_1d(np.asarray(ax, dtype=object)).ravel()
    for panel, (column, text) in zip(axes, picture.panels, strict=True):
        draw_lines(panel, table, column, styles)
        logarithmic(panel)
        panel.set_xlabel(EFFORT)
        panel.set_ylabel(text.format(measure=_measure_label(comparison)))
        reserve_label_space(panel, table, [styles[0][0]])
        decimal_ticks(panel)
        if column == "error_position":
            shade_uncertainty(panel, comparison.uncertainty, labelled=True)
        label_lines(panel, table, column, styles[0])
    add_legend(axes[-1], styles[1:])
    if not creates_figure:
        axes[0].set_title(picture.title, loc="left")
        return axes
    axes[0].set_title(_title(comparison, picture), loc="left", size=11, weight="bold", pad=20)
    note = axes[0].annotate(
        _common_settings(comparison),
        (0, 1),
        xycoords="axes fraction",
        xytext=(0, 6),
        textcoords="offset points",
        size=8.5,
        color="0.35",
    )
    note.set_in_layout(False)
    return axes


def _small_multiples(
    comparison: ComparisonData,
    table: pd.DataFrame,
    picture: PictureKind,
    styles: list[LineStyle],
    _: Any,
) -> Any:
    """Draw one panel per value of the second choice, with the other lines in grey."""
    import matplotlib.pyplot as plt

    (column, text), (name, values) = picture.panels[0], styles[1]
    across = 3 if len(values) != 4 else 2
    down = -(-len(values) // across)
    figure, axes = plt.subplots(
        down,
        across,
        figsize=(3.7 * across, 2.9 * down + 0.6),
        sharex=True,
        sharey=True,
        layout="constrained",
        squeeze=False,
    )
    panels, unused = axes.ravel()[: len(values)], axes.ravel()[len(values) :]
    inner = [styles[0], (name, dict.fromkeys(values, "-")), *styles[2:]]
    for panel, value in zip(panels, values, strict=True):
        background = table[name] != value
        draw_lines(panel, table[background], column, inner, background=True)
        draw_lines(panel, table[~background], column, inner)
        logarithmic(panel)
        panel.set_title(value, loc="left", size=10, weight="bold")
        panel.tick_params(labelbottom=True)
    for panel in unused:
        panel.set_visible(False)
    reserve_label_space(panels[0], table, [styles[0][0], name])
    for panel, value in zip(panels, values, strict=True):
        decimal_ticks(panel)
        if column == "error_position":
            shade_uncertainty(panel, comparison.uncertainty, labelled=panel is panels[0])
        label_lines(panel, table[table[name] == value], column, styles[0])
    add_legend(panels[-1], [(name, {}), *styles[2:]])
    figure.supxlabel(EFFORT, size=10)
    figure.supylabel(text.format(measure=_measure_label(comparison)), size=10)
    title = f"{_title(comparison, picture)}\n{_common_settings(comparison)}"
    figure.suptitle(title, x=0.01, ha="left", size=10)
    return panels


def _title(comparison: ComparisonData, picture: PictureKind) -> str:
    attributes = comparison.data.attrs
    return (
        f"{attributes['model']}, {attributes['start']:g}…{attributes['end']:g} s: {picture.title}"
    )


def _measure_label(comparison: ComparisonData) -> str:
    attributes = comparison.data.attrs
    return (
        f"{attributes['measure']} [{attributes['measure_unit']}]"
        if attributes["measure_unit"]
        else str(attributes["measure"])
    )


def _common_settings(comparison: ComparisonData) -> str:
    """Second line of the title: common settings, and the meaning of the markers."""
    data = comparison.data
    names = [
        str(data[name].values[0])
        for name in ("integrator", "formulation", "coordinates", "stabilization")
        if len(set(data[name].values)) == 1
    ]
    steps, tolerances = (np.unique(data[n].dropna("run")) for n in ("step", "tolerance"))
    swept = [f"step ({steps[-1]:g}…{steps[0]:g} s)"] if steps.size > 1 else []
    if tolerances.size > 1:
        swept.append(f"tolerance ({brief(tolerances[-1])}…{brief(tolerances[0])})")
    if swept:
        names.append(f"one marker per {' or '.join(swept)}")
    return ", ".join(names)
