"""Symbols of supports and loads in pictures of structures."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.results.structural.drawing import StructuralDrawing

ARROW = 0.11
"""Length of the longest arrow, relative to the extent."""
MAX_LONG_ARROWS = 6
"""Upper limit of loaded nodes for arrows of this length; else arrows have half of it."""
MAX_ARROWS = 80
"""Threshold of nodes above which distributed loads are not drawn."""
SIDES = ((0, -1), (-1, 0), (1, 0), (0, 1))
"""Directions below, left, right, above."""
COLOUR, SUPPORT = "#c8381f", "0.3"


def prescribed_directions(drawing: StructuralDrawing) -> dict[int, set[str]]:
    """Number of a node → its prescribed directions."""
    nodes = drawing.model.degrees.nodes
    prescribed: dict[int, set[str]] = {}
    for name, direction in drawing.model.supports:
        number = nodes.number(name)
        if number is not None:
            prescribed.setdefault(number, set()).add(direction)
    return prescribed


def outward(drawing: StructuralDrawing, nodes: list[int]) -> dict[int, tuple[int, int]]:
    """Outward axis direction of each of some nodes.

    Nodes in a corner belong to the side with more nodes; down in case of a tie.
    """
    low, high = drawing.nodes[:, :2].min(axis=0), drawing.nodes[:, :2].max(axis=0)
    places = (drawing.nodes[nodes, :2] - low) / np.maximum(high - low, 1e-12 * drawing.extent)
    away = np.round([places[:, 1], places[:, 0], 1 - places[:, 0], 1 - places[:, 1]], 6)
    nearest = away == away.min(axis=0)
    count = np.where(nearest, nearest.sum(axis=1, keepdims=True), -1)
    return {n: SIDES[k] for n, k in zip(nodes, np.argmax(count, axis=0), strict=True)}


def support_symbols(drawing: StructuralDrawing) -> dict[tuple, list[int]]:
    """(direction of the symbol, roller, fixed rotation) → numbers of the nodes."""
    prescribed = prescribed_directions(drawing)
    directions_out = outward(drawing, list(prescribed)) if prescribed else {}
    groups: dict[tuple, list[int]] = {}
    for node, directions in prescribed.items():
        groups.setdefault(_marker(drawing, directions_out[node], directions), []).append(node)
    return groups


def draw_supports(ax: Any, drawing: StructuralDrawing, places: np.ndarray) -> None:
    """Draw supports: triangles (pinned), triangles with a bar (roller), hatched bars (clamped)."""
    groups = support_symbols(drawing)
    count = sum(map(len, groups.values()))
    for (direction, roller, rotation_fixed), nodes in groups.items():
        at, style = places[nodes], {"mec": SUPPORT, "ls": "", "mew": 1.0, "zorder": 6}
        if drawing.dimension == 3:
            ax.plot(*at.T, "^", ms=7, mfc=SUPPORT, **(style | {"mec": "white"}))
            continue
        path, size = (
            _symbol(np.array(direction), roller, rotation_fixed),
            18.0 if count <= 12 else 10.0,
        )
        ax.plot(at[:, 0], at[:, 1], marker=path, mfc="white", ms=size, clip_on=False, **style)


def _marker(drawing: StructuralDrawing, direction: tuple[int, int], prescribed: set[str]) -> tuple:
    """(direction of the symbol, roller, fixed rotation)."""
    moves = [d for d in ("ux", "uy")[: drawing.dimension] if d not in prescribed]
    if moves == ["ux"]:
        direction = (0, direction[1] or -1)
    elif moves == ["uy"]:
        direction = (direction[0] or -1, 0)
    rotations = {"rx", "ry", "rz"} if drawing.dimension == 3 else {"rz"}
    return (
        (0, -1) if drawing.dimension == 1 else direction,
        len(moves) == 1,
        rotations <= prescribed,
    )


def _symbol(axis: np.ndarray, roller: bool, rotation_fixed: bool) -> Any:
    """Matplotlib path of a support along ``axis``, with its tip at the node."""
    from matplotlib.path import Path

    side = np.array([-axis[1], axis[0]])

    def line(*points: tuple[float, float]) -> Path:
        return Path([along * axis + across * side for along, across in points])

    base = 0.95
    if rotation_fixed:
        parts = [line((0, -0.75), (0, 0.75))]
        hatch = np.linspace(-0.75, 0.5, 6)
        parts += [line((0.0, h + 0.25), (0.4, h)) for h in hatch]
        return Path.make_compound_path(*parts)
    corner = [(0.0, 0.0), (base, -0.55), (base, 0.55), (0.0, 0.0)]
    triangle = Path(
        [a * axis + b * side for a, b in corner],
        [Path.MOVETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY],
    )
    parts = [triangle]
    if roller:
        parts.append(line((base + 0.3, -0.7), (base + 0.3, 0.7)))
    else:
        parts.append(line((base, -0.8), (base, 0.8)))
    return Path.make_compound_path(*parts)


def arrows(
    drawing: StructuralDrawing, loads: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Numbers (k,) of the loaded nodes, their forces (k, 3), and whether they push (k,).

    Loads on nearly all nodes, such as weight, are left out.
    """
    numbers = drawing.model.degrees.table[:, : drawing.dimension]
    force = np.zeros((len(numbers), 3))
    force[:, : drawing.dimension] = np.where(numbers >= 0, loads[numbers], 0.0)
    size = np.linalg.norm(force, axis=1)
    nodes = np.flatnonzero(size > 1e-9 * size.max(initial=0.0))
    if nodes.size > MAX_ARROWS and nodes.size > len(numbers) / 3:
        nodes = nodes[:0]
    force = force[nodes]
    inward = np.einsum("ij,ij->i", force, drawing.nodes.mean(axis=0) - drawing.nodes[nodes])
    unit = force / np.linalg.norm(force, axis=1, keepdims=True)
    _, group = np.unique(np.round(unit, 6), axis=0, return_inverse=True)
    group_sums = np.bincount(group.ravel(), inward)[
        group.ravel()
    ]  # parallel arrows point the same way
    return nodes, force, group_sums > 1e-9 * drawing.extent * size.max(initial=0.0)


def draw_loads(ax: Any, drawing: StructuralDrawing, places: np.ndarray, loads: np.ndarray) -> None:
    """Draw arrows of forces, towards the node if they push, away from it if they pull."""
    nodes, force, pressing = arrows(drawing, loads)
    if nodes.size:
        longest = (ARROW if nodes.size <= MAX_LONG_ARROWS else ARROW / 2) * drawing.extent
        vectors = longest * force / np.linalg.norm(force, axis=1).max()
        tails = places[nodes].copy()
        tails[pressing] -= vectors[pressing]
        _draw_arrows(ax, drawing.dimension, tails, vectors)
    if drawing.dimension != 3:
        _draw_moments(ax, drawing, places, loads)


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


def moments(drawing: StructuralDrawing, loads: np.ndarray) -> dict[int, float]:
    """Number of a node → applied moment, of planar structures."""
    if drawing.dimension != 2:
        return {}
    numbers = drawing.model.degrees.table[:, 2]
    moment = np.where(numbers >= 0, loads[numbers], 0.0)
    nodes = np.flatnonzero(np.abs(moment) > 1e-9 * np.abs(moment).max(initial=0.0))
    return {int(n): float(moment[n]) for n in nodes} if nodes.size <= MAX_ARROWS else {}


def _draw_moments(
    ax: Any, drawing: StructuralDrawing, places: np.ndarray, loads: np.ndarray
) -> None:
    for node, moment in moments(drawing, loads).items():
        symbol = r"$\circlearrowleft$" if moment > 0 else r"$\circlearrowright$"
        ax.annotate(
            symbol,
            places[node, :2],
            ha="center",
            va="center",
            fontsize=22,
            color=COLOUR,
            annotation_clip=False,
        )
