"""Lines of a comparison's pictures: looks, logarithmic axes, names beside lines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import pandas as pd

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
SMALLEST = 1e-18
"""Zero has no place on a logarithmic axis."""

Look = tuple[str, dict[str, Any]]


def looks_of(table: pd.DataFrame, order: tuple[str, ...]) -> list[Look]:
    """Column and its value → look: colours, dashes, markers, for the choices that vary."""
    varying = [name for name in order if table[name].nunique() > 1]
    fixed = [name for name in order if name not in varying]
    styles = (COLOURS, DASHES, MARKERS, ("full", "none", "left", "right"))
    return [
        (name, {v: style[k % len(style)] for k, v in enumerate(dict.fromkeys(table[name]))})
        for name, style in zip([*varying, *fixed], styles, strict=True)
    ]


def draw_lines(
    ax: Any, table: pd.DataFrame, column: str, looks: list[Look], behind: bool = False
) -> None:
    for names, rows in table.groupby([name for name, _ in looks], sort=False):
        colour, dash, marker, fill = (
            look[value] for (_, look), value in zip(looks, names, strict=True)
        )
        look = {"color": "0.85", "lw": 1.0, "zorder": 1}
        if not behind:
            full = fill == "full"
            look = {"color": colour, "lw": 1.6, "ls": dash, "marker": marker, "ms": 5}
            look |= {"fillstyle": fill, "mec": "white" if full else colour, "mew": 0.6}
        ax.plot(1e3 * rows["time"], np.maximum(rows[column], SMALLEST), **look)


def plain_ticks(ax: Any) -> None:
    """1, 2, 5, 10, 20 … instead of powers; 1, 10, 100 … where these are too many."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    low, high = ax.get_xlim()
    width = 72 / ax.figure.dpi * ax.get_window_extent().width
    dense = 3 * np.log10(high / low) * 28 < width
    ax.xaxis.set_major_locator(LogLocator(10, subs=(1.0, 2.0, 5.0) if dense else (1.0,)))
    ax.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.xaxis.set_minor_formatter(NullFormatter())


def floor(ax: Any, uncertainty: float, named: bool) -> None:
    """The band in which errors mean nothing."""
    if not uncertainty > 0:
        return
    low, high = ax.get_ylim()
    low = min(low, uncertainty * (uncertainty / high) ** 0.07)
    ax.axhspan(low, uncertainty, color="0.5", alpha=0.18, lw=0)
    ax.set_ylim(bottom=low)
    if named:
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


def make_room(ax: Any, table: pd.DataFrame, names: list[str]) -> None:
    """Space at the right for the values of ``names[0]``, beside the ends of their lines."""
    if table[names[0]].nunique() < 2:
        return
    ax.figure.draw_without_rendering()
    width = 72 / ax.figure.dpi * ax.get_window_extent().width
    low, high = ax.get_xlim()
    share = 0.0
    for value, rows in table.groupby(names):
        place = np.log(1e3 * rows["time"].max() / low) / np.log(high / low)
        text = (14 + 6.3 * len(value[0])) / width
        share = max(share, 1 - (1 - text) / place)
    share = min(share, 0.5)
    ax.set_xlim(low, high * (high / low) ** (share / (1 - share)))


def name_colours(ax: Any, table: pd.DataFrame, column: str, look: Look) -> None:
    """Each colour is named once, beside the right end of its lines."""
    from matplotlib.patheffects import withStroke

    name, colours = look
    if len(colours) < 2:
        return
    ends = []
    for value, colour in colours.items():
        rows = table[(table[name] == value) & table[column].notna()]
        if len(rows):
            last = rows.loc[rows["time"].idxmax()]
            ends.append((value, colour, 1e3 * last["time"], max(last[column], SMALLEST)))
    heights = _apart(ax, [(x, y) for _, _, x, y in ends])
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


def _apart(ax: Any, points: list[tuple[float, float]], gap: float = 12.0) -> list[float]:
    """Offsets [points] that keep names from lying on each other."""
    ax.figure.draw_without_rendering()  # the layout settles where points lie
    scale = 72 / ax.figure.dpi
    places = scale * ax.transData.transform(points)
    order = np.argsort(places[:, 1])
    heights = places[:, 1].copy()
    for n, k in enumerate(order):
        for j in order[:n]:
            if abs(places[k, 0] - places[j, 0]) < 110 and heights[k] < heights[j] + gap:
                heights[k] = heights[j] + gap
    return list(heights - places[:, 1])


def explain(ax: Any, looks: list[Look]) -> None:
    """A small legend of dashes and markers, where they tell anything."""
    from matplotlib.lines import Line2D

    kinds = ("ls", "marker", "fillstyle")
    entries = []
    for key, (_, look) in zip(kinds, looks, strict=True):
        if len(look) > 1:
            for value, style in look.items():
                base: dict[str, Any] = {"color": "0.35", "lw": 1.6, "ms": 5}
                base |= {"ls": "-"} if key == "ls" else {"ls": "", "marker": "o"}
                entries.append(Line2D([], [], label=value, **(base | {key: style})))
    if entries:
        ax.legend(handles=entries, frameon=False, fontsize=8, loc="best")


def logarithmic(ax: Any) -> None:
    ax.set(xscale="log", yscale="log")
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
