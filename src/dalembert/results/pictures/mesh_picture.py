"""Matplotlib picture of the scene of a structure: mesh, colours of a field, supports and loads."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.results.pictures.mesh_symbols import draw_loads, draw_supports
from dalembert.results.structural.states import Field

if TYPE_CHECKING:
    from matplotlib.cm import ScalarMappable

PREFIXED = ("N", "Pa", "J", "m", "N m")
"""Units shown with prefixes: kN, MPa, mm."""
PLAIN, GHOST, OUTLINE = "#1f5f99", "0.72", "0.25"
FACE = "#c9d9e8"
MANY_NODES = 60
"""Upper limit of nodes that are drawn."""
MARGIN = 0.08
"""Margin of the axes, relative to the structure."""


class MeshPicture:
    """Picture of a structure; ``show(k)`` moves it to frame ``k``.

    Parameters
    ----------
    scene : scene of a structure
    frames : number of a state and factor of its displacements, for each frame
    field : Field for the colours, uniform if None
    undeformed : draw the undeformed structure behind
    mesh : draw the edges of faces
    symbols : draw supports, and the loads of the first frame
    titles : title of each frame
    ax : axes, new ones if None
    """

    def __init__(
        self,
        scene: dict[str, Any],
        frames: list[tuple[int, float]],
        *,
        field: Field | None = None,
        undeformed: bool = True,
        mesh: bool = True,
        symbols: bool = True,
        titles: Sequence[str] = (),
        ax: Any = None,
    ):
        self.mesh, self.field, self.edges = scene["mesh"], field, mesh
        self.titles = titles
        self.solid = scene["dimension"] == 3
        self.rest = np.asarray(self.mesh["rest"], dtype=float).reshape(-1, 3)
        drop = self.mesh["drop"] if undeformed else 0.0
        self.places = [self.rest - [0.0, drop, 0.0] + f * self._moved(k) for k, f in frames]
        self.ax = ax if ax is not None else self._axes()
        self.parts: list[tuple[Any, np.ndarray]] = []
        if undeformed:
            self._ghost(scene["dimension"])
        self._structure()
        self._frame([self.rest, *self.places] if undeformed else self.places)
        self.show(0)
        if symbols:
            draw_supports(self.ax, scene, self.rest if undeformed else self.places[0])
            draw_loads(self.ax, scene, self.places[0], frames[0][0])

    def show(self, k: int) -> list[Any]:
        """Move every part to frame ``k``; returns the artists."""
        for part, vertices in self.parts:
            self._place(part, self.places[k][vertices])
        if self.titles:
            self.ax.set_title(self.titles[k])
        return [part for part, _ in self.parts]

    def _moved(self, state: int) -> np.ndarray:
        """(vertices, 3) displacements of a state."""
        return np.asarray(self.mesh["vertex_displacements"][state], dtype=float).reshape(-1, 3)

    def _cells(self, kind: str) -> list[tuple[np.ndarray, np.ndarray]]:
        """Vertices (m, k) and elements (m,) of each group of lines, faces or points."""
        return [
            (
                np.asarray(group["vertices"], dtype=int).reshape(-1, int(group["size"])),
                np.asarray(group["elements"], dtype=int),
            )
            for group in self.mesh[kind]
        ]

    # axes ----------------------------------------------------------------------------------
    def _axes(self) -> Any:
        import matplotlib.pyplot as plt

        projection = {"projection": "3d"} if self.solid else {}
        _, ax = plt.subplots(figsize=self._size(), layout="constrained", subplot_kw=projection)
        ax.set_axis_off()
        return ax

    def _size(self) -> tuple[float, float]:
        """Size of a figure that fits the structure [inch]."""
        spread = np.ptp(self.rest, axis=0)
        if self.solid:
            return 7.2, 7.2 if spread[2] > 1.5 * spread[:2].max() else 5.0
        wide = 7.2
        return wide, float(np.clip(wide * (spread[1] / max(spread[0], 1e-12)) + 1.2, 2.6, 6.5))

    def _frame(self, point_sets: list[np.ndarray]) -> None:
        """Set the limits and equal scales of the axes."""
        corners = np.concatenate(point_sets)
        low, high = corners.min(axis=0), corners.max(axis=0)
        margin = MARGIN * (float((high - low).max()) or 1.0)
        if self.solid:
            for axis, a, b in zip("xyz", low, high, strict=True):
                getattr(self.ax, f"set_{axis}lim")(a - margin / 4, b + margin / 4)
            self.ax.set_box_aspect(high - low + margin / 2)
            return
        self.ax.set_xlim(low[0] - margin, high[0] + margin)
        self.ax.set_ylim(low[1] - margin, high[1] + margin)
        self.ax.set_aspect("equal", adjustable="box")

    # parts ---------------------------------------------------------------------------------
    def _ghost(self, dimension: int) -> None:
        style = {"color": GHOST, "lw": 1.0, "zorder": 1}
        dashed = "-" if dimension == 1 else (0, (4, 3))
        for vertices, _ in self._cells("lines"):
            self._lines(self.rest[vertices], ls=dashed, **style)
        outline = np.asarray(self.mesh["outline"], dtype=int).reshape(-1, 2)
        if len(outline):
            self._lines(self.rest[outline], ls="-", **style)

    def _structure(self) -> None:
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import Normalize

        colours = None
        if self.field is not None:
            palette = "RdBu_r" if self.field.has_both_signs else "viridis"
            colours = ScalarMappable(Normalize(*self.field.range), palette)
        for vertices, elements in self._cells("faces"):
            self._add_faces(vertices, elements, colours)
        for vertices, elements in self._cells("lines"):
            self._add_lines(vertices, elements, colours)
        self._add_nodes()
        if self.field is not None:
            self._bar(colours, self.field)

    def _bar(self, colours: ScalarMappable | None, field: Field) -> None:
        from matplotlib.ticker import EngFormatter, ScalarFormatter

        ticks: Any = ScalarFormatter()
        if field.unit in PREFIXED:
            ticks = EngFormatter(unit=field.unit)
        else:
            ticks.set_powerlimits((-3, 4))
        bar = self.ax.figure.colorbar(colours, ax=self.ax, format=ticks, shrink=0.85, pad=0.02)
        bar.set_label(field.name if field.unit in PREFIXED else field.label)
        bar.outline.set_visible(False)

    def _add_lines(self, vertices: np.ndarray, elements: np.ndarray, colours: Any) -> None:
        if self.field is None:
            self._add(vertices, color=PLAIN, lw=2.0, zorder=4)
            return
        values = self.field.values
        if self.field.at_vertices:
            vertices = np.stack([vertices[:, :-1], vertices[:, 1:]], axis=2).reshape(-1, 2)
            values = values[vertices].mean(axis=1)
        else:
            values = values[elements]
        finite = np.isfinite(values)
        rgba = colours.to_rgba(values[finite])
        # a darker core keeps pale colours visible
        for mask, style in (
            (~finite, {"color": GHOST, "lw": 1.6, "zorder": 3}),
            (finite, {"color": OUTLINE, "lw": 3.6, "zorder": 3.9}),
            (finite, {"colors": rgba, "lw": 2.6, "zorder": 4}),
        ):
            if mask.any():
                self._add(vertices[mask], **style)

    def _add_faces(self, vertices: np.ndarray, elements: np.ndarray, colours: Any) -> None:
        edges = {"edgecolors": (0.1, 0.1, 0.1, 0.35), "linewidths": 0.4 if self.edges else 0.0}
        fill: Any = "none"
        if self.field is None:
            fill, edges = FACE, edges | {"edgecolors": PLAIN}
        elif not self.field.at_vertices:
            fill = _rgba(colours, self.field.values[elements])
        elif self.solid:
            fill = _rgba(colours, np.nanmean(self.field.values[vertices], axis=1))
        else:
            self._smooth(vertices, colours, self.field.values)
            if not self.edges:
                return
        self.parts.append((self._faces(self.places[0][vertices], fill, **edges), vertices))

    def _smooth(self, v: np.ndarray, colours: ScalarMappable, values: np.ndarray) -> None:
        """Interpolate colours between the vertices and the centre of each face."""
        places = self.places[0]
        middles = len(places) + np.repeat(np.arange(len(v)), v.shape[1])
        triangles = np.column_stack([v.ravel(), np.roll(v, -1, axis=1).ravel(), middles])
        points = np.vstack([places, places[v].mean(axis=1)])
        self.ax.tripcolor(
            points[:, 0],
            points[:, 1],
            triangles,
            np.nan_to_num(np.concatenate([values, values[v].mean(axis=1)])),
            shading="gouraud",
            cmap=colours.cmap,
            norm=colours.norm,
            zorder=2,
        )

    def _add_nodes(self) -> None:
        """Draw nodes of structures with few lines, and elements with one node."""
        count, lines = len(self.mesh["nodes"]), self._cells("lines")
        at = [np.zeros(0, dtype=int), *(v.ravel() for v, _ in self._cells("points"))]
        if count <= MANY_NODES:
            ends = [v[:, [0, -1]].ravel() for v, _ in lines]
            at += [e[e < count] for e in ends]
        vertices = np.unique(np.concatenate(at))
        if vertices.size:
            style = {"ms": 3.6, "mfc": "white", "mec": OUTLINE, "mew": 1.0, "zorder": 5}
            places = self.places[0][vertices, : 3 if self.solid else 2]
            self.parts.append((self.ax.plot(*places.T, "o", ls="", **style)[0], vertices))

    # artists -------------------------------------------------------------------------------
    def _add(self, vertices: np.ndarray, **style: Any) -> None:
        """Lines that move with their vertices (m, k)."""
        self.parts.append((self._lines(self.places[0][vertices], **style), vertices))

    def _lines(self, paths: np.ndarray, **style: Any) -> Any:
        if self.solid:
            from mpl_toolkits.mplot3d.art3d import Line3DCollection

            return self.ax.add_collection3d(Line3DCollection(paths, **style))
        from matplotlib.collections import LineCollection

        flat = [path[:, :2] for path in paths]
        return self.ax.add_collection(LineCollection(flat, capstyle="round", **style))

    def _faces(self, outlines: np.ndarray, colours: Any, **style: Any) -> Any:
        if self.solid:
            from mpl_toolkits.mplot3d.art3d import Poly3DCollection

            return self.ax.add_collection3d(Poly3DCollection(outlines, facecolors=colours, **style))
        from matplotlib.collections import PolyCollection

        flat = list(outlines[..., :2])
        return self.ax.add_collection(PolyCollection(flat, facecolors=colours, zorder=2, **style))

    def _place(self, part: Any, points: np.ndarray) -> None:
        """Move an artist to places (n, 3), or outlines (n, k, 3)."""
        shown = points if self.solid else points[..., :2]
        if hasattr(part, "set_segments"):
            part.set_segments(shown)
        elif hasattr(part, "set_verts"):
            part.set_verts(shown)
        else:
            (part.set_data_3d if self.solid else part.set_data)(*shown.T)


def _rgba(colours: ScalarMappable, values: np.ndarray) -> np.ndarray:
    """Colours of values, grey for NaN."""
    rgba = colours.to_rgba(np.nan_to_num(values))
    rgba[~np.isfinite(values)] = (0.85, 0.85, 0.85, 1.0)
    return rgba
