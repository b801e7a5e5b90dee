"""Supports and loads of structures in Matplotlib axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.elements.point import AXES

if TYPE_CHECKING:
    from matplotlib.path import Path

ARROW = 0.11
"""Length of the longest arrow, relative to the extent."""
MAX_LONG_ARROWS = 6
"""Upper limit of loaded nodes for arrows of this length; else arrows have half of it."""
COLOUR, SUPPORT = "#c8381f", "0.3"


def draw_supports(ax: Any, scene: dict[str, Any], places: np.ndarray) -> None:
    """Draw supports: triangles (pinned), triangles with a bar (roller), hatched bars (clamped)."""
    supports = [symbol for symbol in scene["symbols"] if symbol["symbol"] == "support"]
    size = 18.0 if sum(len(support["nodes"]) for support in supports) <= 12 else 10.0
    for support in supports:
        at, style = places[support["nodes"]], {"mec": SUPPORT, "ls": "", "mew": 1.0, "zorder": 6}
        if scene["dimension"] == 3:
            ax.plot(*at.T, "^", ms=7, mfc=SUPPORT, **(style | {"mec": "white"}))
            continue
        path = _symbol(np.array(support["axis"]), support["roller"], support["clamp"])
        ax.plot(at[:, 0], at[:, 1], marker=path, mfc="white", ms=size, clip_on=False, **style)


def _symbol(axis: np.ndarray, roller: bool, clamp: bool) -> Path:
    """Matplotlib path of a support along ``axis``, with its tip at the node."""
    from matplotlib.path import Path

    side = np.array([-axis[1], axis[0]])

    def line(*points: tuple[float, float]) -> Path:
        return Path([along * axis + across * side for along, across in points])

    base = 0.95
    if clamp:
        parts = [line((0, -0.75), (0, 0.75))]
        hatch = np.linspace(-0.75, 0.5, 6)
        parts += [line((0.0, h + 0.25), (0.4, h)) for h in hatch]
        return Path.make_compound_path(*parts)
    corner = [(0.0, 0.0), (base, -0.55), (base, 0.55), (0.0, 0.0)]
    triangle = Path(
        [a * axis + b * side for a, b in corner],
        [Path.MOVETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY],
    )
    ground = (base + 0.3, 0.7) if roller else (base, 0.8)
    return Path.make_compound_path(triangle, line((ground[0], -ground[1]), ground))


def draw_loads(ax: Any, scene: dict[str, Any], places: np.ndarray, state: int) -> None:
    """Draw forces, with their heads at the nodes if they push, and arcs of moments."""
    loads = [symbol for symbol in scene["symbols"] if symbol["symbol"] in ("arrow", "twist")]
    arrows = [load for load in loads if load["symbol"] == "arrow"]
    force = np.zeros((len(arrows), 3))
    for row, arrow in enumerate(arrows):
        for k, axis in enumerate(AXES):
            if f"force_{axis}" in arrow:
                force[row, k] = arrow[f"force_{axis}"][state]
    length = np.linalg.norm(force, axis=1)
    shown = np.flatnonzero(length > 1e-9 * length.max(initial=0.0))
    if shown.size:
        extent = float(np.ptp(places, axis=0).max())
        longest = (ARROW if shown.size <= MAX_LONG_ARROWS else ARROW / 2) * extent
        vectors = longest * force[shown] / length.max()
        tails = places[[arrows[k]["node"] for k in shown]]
        inward = np.array([bool(arrows[k]["inward"][state]) for k in shown])
        _draw_arrows(ax, scene["dimension"], tails - inward[:, None] * vectors, vectors)
    for load in loads:
        if load["symbol"] == "twist" and load["moment"][state]:
            turn = "left" if load["moment"][state] > 0 else "right"
            style = {"ha": "center", "va": "center", "fontsize": 22, "color": COLOUR}
            at = places[load["node"], :2]
            ax.annotate(rf"$\circlearrow{turn}$", at, annotation_clip=False, **style)


def _draw_arrows(ax: Any, dimension: int, tails: np.ndarray, vectors: np.ndarray) -> None:
    if dimension == 3:
        style = {"color": COLOUR, "lw": 1.4, "arrow_length_ratio": 0.28}
        ax.quiver(*tails.T, *vectors.T, **style)
        return
    arrow_set = ax.quiver(
        *tails[:, :2].T,
        *vectors[:, :2].T,
        angles="xy",
        scale_units="xy",
        scale=1,
        color=COLOUR,
        width=0.004,
        headwidth=4.5,
        headlength=6,
        headaxislength=5.5,
        zorder=7,
        clip_on=False,
    )
    arrow_set.set_in_layout(False)  # the limits below include it
    ends = np.concatenate([tails, tails + vectors])[:, :2]
    low, high = ends.min(axis=0), ends.max(axis=0)
    (x0, x1), (y0, y1) = ax.get_xlim(), ax.get_ylim()
    ax.set_xlim(min(x0, low[0]), max(x1, high[0]))
    ax.set_ylim(min(y0, low[1]), max(y1, high[1]))
