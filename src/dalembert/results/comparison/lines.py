"""Lines of comparison plots: styles, logarithmic axes and labels."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

COLOURS = (
    "#0072b2",
    "#d55e00",
    "#009e73",
    "#b65c98",
    "#c98b00",
    "#3f9bd6",
    "#7a4f9a",
    "#8c3b2e",
    "#4d6b1f",
    "#1f4e5f",
    "#a02060",
    "#555555",
)
DASHES = (
    "-",
    (0, (5, 2)),
    (0, (1.2, 1.6)),
    (0, (6, 2, 1.2, 2)),
    (0, (3, 1, 1, 1, 1, 1)),
    (0, (9, 3)),
    (0, (9, 2, 1, 2, 1, 2)),
    (0, (2, 4)),
)
MARKERS = "osD^vP*X"
MIN_VALUE = 1e-18
"""Lower limit of values on a logarithmic axis."""

LineStyle = tuple[str, dict[str, Any]]


def line_styles(table: pd.DataFrame, order: tuple[str, ...]) -> list[LineStyle]:
    """Column and its values → colours, dashes, markers or fills, varying choices first."""
    varying = [name for name in order if table[name].nunique() > 1]
    fixed = [name for name in order if name not in varying]
    styles = (COLOURS, DASHES, MARKERS, ("full", "none", "left", "right"))
    return [
        (name, {v: style[k % len(style)] for k, v in enumerate(dict.fromkeys(table[name]))})
        for name, style in zip([*varying, *fixed], styles, strict=True)
    ]


def draw_lines(
    ax: Axes, table: pd.DataFrame, column: str, styles: list[LineStyle], background: bool = False
) -> None:
    for names, rows in table.groupby([name for name, _ in styles], sort=False):
        colour, dash, marker, fill = (
            look[value] for (_, look), value in zip(styles, names, strict=True)
        )
        look: dict[str, Any] = {"color": "0.85", "lw": 1.0, "zorder": 1}
        if not background:
            full = fill == "full"
            look = {"color": colour, "lw": 1.6, "ls": dash, "marker": marker, "ms": 5}
            look |= {"fillstyle": fill, "mec": "white" if full else colour, "mew": 0.6}
        ax.plot(1e3 * rows["time"], np.maximum(rows[column], MIN_VALUE), **look)


def decimal_ticks(ax: Axes) -> None:
    """Tick labels 1, 2, 5, 10, … instead of powers; 1, 10, 100, … if these are too dense."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = ax.get_xlim()
    width = 72 / ax.figure.dpi * ax.get_window_extent().width
    dense = 3 * np.log10(high / low) * 28 < width
    ax.xaxis.set_major_locator(LogLocator(10, subs=(1.0, 2.0, 5.0) if dense else (1.0,)))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())


def shade_uncertainty(ax: Axes, uncertainty: float, labelled: bool) -> None:
    """Shade the band below the uncertainty of the reference."""
    if not uncertainty > 0:
        return
    low, high = ax.get_ylim()
    low = min(low, uncertainty * (uncertainty / high) ** 0.07)
    ax.axhspan(low, uncertainty, color="0.5", alpha=0.18, lw=0)
    ax.set_ylim(bottom=low)
    if labelled:
        ax.annotate(
            "uncertainty of the reference",
            (0, uncertainty),
            xycoords=("axes fraction", "data"),
            xytext=(4, -2),
            textcoords="offset points",
            va="top",
            size=8,
            color="0.35",
        )


def reserve_label_space(ax: Any, table: pd.DataFrame, names: list[str]) -> None:
    """Widen the x-axis for the labels of ``names[0]`` at the right ends of the lines."""
    if table[names[0]].nunique() < 2:
        return
    ax.figure.draw_without_rendering()
    width = 72 / ax.figure.dpi * ax.get_window_extent().width
    low, high = ax.get_xlim()
    share = 0.0
    for value, rows in table.groupby(names):
        position = np.log(1e3 * rows["time"].max() / low) / np.log(high / low)
        label_width = (14 + 6.3 * len(value[0])) / width
        share = max(share, 1 - (1 - label_width) / position)
    share = min(share, 0.5)
    ax.set_xlim(low, high * (high / low) ** (share / (1 - share)))


def label_lines(ax: Axes, table: pd.DataFrame, column: str, style: LineStyle) -> None:
    """Label each colour once, at the right end of its lines."""
    from matplotlib.patheffects import withStroke

    name, colours = style
    if len(colours) < 2:
        return
    ends = []
    for value, colour in colours.items():
        rows = table[(table[name] == value) & table[column].notna()]
        if len(rows):
            last = rows.loc[rows["time"].idxmax()]
            ends.append((value, colour, 1e3 * last["time"], max(last[column], MIN_VALUE)))
    heights = _label_offsets(ax, [(x, y) for _, _, x, y in ends])
    for (value, colour, x, y), height in zip(ends, heights, strict=True):
        label = ax.annotate(
            value,
            (x, y),
            xytext=(8, height),
            textcoords="offset points",
            va="center",
            size=9,
            color=colour,
            weight="bold",
            path_effects=[withStroke(linewidth=3, foreground="white")],
        )
        label.set_in_layout(False)


def _label_offsets(ax: Any, points: list[tuple[float, float]], gap: float = 12.0) -> list[float]:
    """Vertical offsets [points] of labels that avoid overlaps."""
    ax.figure.draw_without_rendering()  # the layout determines the positions
    scale = 72 / ax.figure.dpi
    positions = scale * ax.transData.transform(points)
    order = np.argsort(positions[:, 1])
    heights = positions[:, 1].copy()
    for n, k in enumerate(order):
        for j in order[:n]:
            if abs(positions[k, 0] - positions[j, 0]) < 110 and heights[k] < heights[j] + gap:
                heights[k] = heights[j] + gap
    return list(heights - positions[:, 1])


def add_legend(ax: Axes, styles: list[LineStyle]) -> None:
    """Add a small legend of the dashes and markers that vary."""
    from matplotlib.lines import Line2D

    kinds = ("ls", "marker", "fillstyle")
    entries = []
    for key, (_, choices) in zip(kinds, styles, strict=True):
        if len(choices) > 1:
            for value, value_style in choices.items():
                base: dict[str, Any] = {"color": "0.35", "lw": 1.6, "ms": 5}
                base |= {"ls": "-"} if key == "ls" else {"ls": "", "marker": "o"}
                entries.append(Line2D([], [], label=value, **(base | {key: value_style})))
    if entries:
        ax.legend(handles=entries, frameon=False, fontsize=8, loc="best")


def logarithmic(ax: Axes) -> None:
    ax.set(xscale="log", yscale="log")
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
