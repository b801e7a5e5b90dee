"""Symbols of supports and loads in pictures of structures."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.results.structural.drawing import StructuralDrawing

ARROW = 0.11
"""Length of the longest arrow, part of the extent."""
FEW = 6
"""Loaded nodes up to which arrows have that length; else half of it."""
MANY = 80
"""Nodes from which on loads that act nearly everywhere are not drawn one by one."""
SIDES = ((0, -1), (-1, 0), (1, 0), (0, 1))
"""Below, left, right, above."""
COLOUR, SUPPORT = "#c8381f", "0.3"


def held_directions(drawing: StructuralDrawing) -> dict[int, set[str]]:
    """Number of a node → its prescribed directions."""
    nodes = drawing.model.degrees.nodes
    found: dict[int, set[str]] = {}
    for name, direction in drawing.model.supports:
        number = nodes.number(name)
        if number is not None:
            found.setdefault(number, set()).add(direction)
    return found


def outward(drawing: StructuralDrawing, nodes: list[int]) -> dict[int, tuple[int, int]]:
    """Direction along an axis that leads away from the structure, for each of some nodes.

    Nodes in a corner go with the side that has more of them; down if in doubt.
    """
    low, high = drawing.nodes[:, :2].min(axis=0), drawing.nodes[:, :2].max(axis=0)
    places = (drawing.nodes[nodes, :2] - low) / np.maximum(high - low, 1e-12 * drawing.extent)
    away = np.round([places[:, 1], places[:, 0], 1 - places[:, 0], 1 - places[:, 1]], 6)
    nearest = away == away.min(axis=0)
    count = np.where(nearest, nearest.sum(axis=1, keepdims=True), -1)
    return {n: SIDES[k] for n, k in zip(nodes, np.argmax(count, axis=0), strict=True)}


def support_symbols(drawing: StructuralDrawing) -> dict[tuple, list[int]]:
    """(direction of the symbol, on rollers, against turning) → numbers of the nodes."""
    held = held_directions(drawing)
    ways = outward(drawing, list(held)) if held else {}
    groups: dict[tuple, list[int]] = {}
    for node, directions in held.items():
        groups.setdefault(_marker(drawing, ways[node], directions), []).append(node)
    return groups


def draw_supports(ax: Any, drawing: StructuralDrawing, places: np.ndarray) -> None:
    """A triangle where a node is held, on rollers where it slides, a bar where it cannot turn."""
    groups = support_symbols(drawing)
    count = sum(map(len, groups.values()))
    for (way, roller, turns), nodes in groups.items():
        at, style = places[nodes], {"mec": SUPPORT, "ls": "", "mew": 1.0, "zorder": 6}
        if drawing.dimension == 3:
            ax.plot(*at.T, "^", ms=7, mfc=SUPPORT, **(style | {"mec": "white"}))
            continue
        path, size = _symbol(np.array(way), roller, turns), 18.0 if count <= 12 else 10.0
        ax.plot(at[:, 0], at[:, 1], marker=path, mfc="white", ms=size, clip_on=False, **style)


def _marker(drawing: StructuralDrawing, way: tuple[int, int], held: set[str]) -> tuple:
    """(direction of the symbol, on rollers, against turning)."""
    moves = [d for d in ("ux", "uy")[: drawing.dimension] if d not in held]
    if moves == ["ux"]:
        way = (0, way[1] or -1)
    elif moves == ["uy"]:
        way = (way[0] or -1, 0)
    turns = {"rx", "ry", "rz"} if drawing.dimension == 3 else {"rz"}
    return (0, -1) if drawing.dimension == 1 else way, len(moves) == 1, turns <= held


def _symbol(way: np.ndarray, roller: bool, turns: bool) -> Any:
    """Path with its tip at the node, that lies along ``way``."""
    from matplotlib.path import Path

    side = np.array([-way[1], way[0]])

    def line(*points: tuple[float, float]) -> Path:
        return Path([along * way + across * side for along, across in points])

    base = 0.95
    if turns:
        parts = [line((0, -0.75), (0, 0.75))]
        hatch = np.linspace(-0.75, 0.5, 6)
        parts += [line((0.0, h + 0.25), (0.4, h)) for h in hatch]
        return Path.make_compound_path(*parts)
    corner = [(0.0, 0.0), (base, -0.55), (base, 0.55), (0.0, 0.0)]
    triangle = Path(
        [a * way + b * side for a, b in corner],
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
    """Numbers (k,) of the loaded nodes, their forces (k, 3), and whether these press (k,).

    Of loads that act nearly everywhere, such as weight, none are told.
    """
    numbers = drawing.model.degrees.table[:, : drawing.dimension]
    force = np.zeros((len(numbers), 3))
    force[:, : drawing.dimension] = np.where(numbers >= 0, loads[numbers], 0.0)
    size = np.linalg.norm(force, axis=1)
    nodes = np.flatnonzero(size > 1e-9 * size.max(initial=0.0))
    if nodes.size > MANY and nodes.size > len(numbers) / 3:
        nodes = nodes[:0]
    force = force[nodes]
    inward = np.einsum("ij,ij->i", force, drawing.nodes.mean(axis=0) - drawing.nodes[nodes])
    unit = force / np.linalg.norm(force, axis=1, keepdims=True)
    _, alike = np.unique(np.round(unit, 6), axis=0, return_inverse=True)
    together = np.bincount(alike.ravel(), inward)[alike.ravel()]  # parallel ones look the same
    return nodes, force, together > 1e-9 * drawing.extent * size.max(initial=0.0)


def draw_loads(ax: Any, drawing: StructuralDrawing, places: np.ndarray, loads: np.ndarray) -> None:
    """Arrows of forces, towards the node where they press, away from it where they pull."""
    nodes, force, pressing = arrows(drawing, loads)
    if nodes.size:
        longest = (ARROW if nodes.size <= FEW else ARROW / 2) * drawing.extent
        ways = longest * force / np.linalg.norm(force, axis=1).max()
        tails = places[nodes].copy()
        tails[pressing] -= ways[pressing]
        _draw_arrows(ax, drawing.dimension, tails, ways)
    if drawing.dimension != 3:
        _draw_moments(ax, drawing, places, loads)


def _draw_arrows(ax: Any, dimension: int, tails: np.ndarray, ways: np.ndarray) -> None:
    if dimension == 3:
        style = {"color": COLOUR, "lw": 1.4, "arrow_length_ratio": 0.28}
        ax.quiver(*tails.T, *ways.T, **style)
        return
    made = ax.quiver(
        *tails[:, :2].T,
        *ways[:, :2].T,
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
    made.set_in_layout(False)  # the limits below make room for it
    ends = np.concatenate([tails, tails + ways])[:, :2]
    low, high = ends.min(axis=0), ends.max(axis=0)
    (x0, x1), (y0, y1) = ax.get_xlim(), ax.get_ylim()
    ax.set_xlim(min(x0, low[0]), max(x1, high[0]))
    ax.set_ylim(min(y0, low[1]), max(y1, high[1]))


def moments(drawing: StructuralDrawing, loads: np.ndarray) -> dict[int, float]:
    """Number of a node of the plane → the moment on it."""
    if drawing.dimension != 2:
        return {}
    numbers = drawing.model.degrees.table[:, 2]
    moment = np.where(numbers >= 0, loads[numbers], 0.0)
    nodes = np.flatnonzero(np.abs(moment) > 1e-9 * np.abs(moment).max(initial=0.0))
    return {int(n): float(moment[n]) for n in nodes} if nodes.size <= MANY else {}


def _draw_moments(
    ax: Any, drawing: StructuralDrawing, places: np.ndarray, loads: np.ndarray
) -> None:
    for node, moment in moments(drawing, loads).items():
        turn = r"$\circlearrowleft$" if moment > 0 else r"$\circlearrowright$"
        ax.annotate(
            turn,
            places[node, :2],
            ha="center",
            va="center",
            fontsize=22,
            color=COLOUR,
            annotation_clip=False,
        )
