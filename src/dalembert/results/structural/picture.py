"""Matplotlib picture of a structure: coloured lines, faces and nodes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.fields import Field
from dalembert.results.structural.shapes import Shapes

PREFIXED = ("N", "Pa", "J", "m", "N m")
"""Units shown with prefixes: kN, MPa, mm."""
PLAIN, GHOST, OUTLINE = "#1f5f99", "0.72", "0.25"
FACE = "#c9d9e8"


@dataclass
class StructuralPicture:
    """Picture of a structure.

    Parameters
    ----------
    drawing : StructuralDrawing
    moved : (vertices, 3) displacements [m]
    scale : factor of the displacements
    field : Field for the colours, uniform if None
    undeformed : draw the undeformed structure behind
    mesh : draw the edges of faces
    """

    drawing: StructuralDrawing
    moved: np.ndarray
    scale: float
    field: Field | None = None
    undeformed: bool = True
    mesh: bool = True

    @property
    def solid(self) -> bool:
        """Whether the picture is three-dimensional."""
        return self.drawing.dimension == 3

    @property
    def places(self) -> np.ndarray:
        """(vertices, 3) drawn positions; 1D structures are shifted below the undeformed one."""
        places = self.drawing.rest + self.scale * self.moved
        if self.drawing.dimension == 1 and self.undeformed:
            rest = self.drawing.rest
            places[:, 1] -= float(np.ptp(rest[:, 1])) + 0.12 * self.drawing.extent
        return places

    def draw(self, ax: Any = None) -> Any:
        """Draw into axes, new ones if None; returns them."""
        import matplotlib.pyplot as plt

        if ax is None:
            projection = {"projection": "3d"} if self.solid else {}
            _, ax = plt.subplots(figsize=self._size(), layout="constrained", subplot_kw=projection)
            ax.set_axis_off()
        if self.undeformed:
            self._ghost(ax)
        self._structure(ax)
        self._frame(ax)
        return ax

    def _size(self) -> tuple[float, float]:
        """Size of a figure that fits the structure [inch]."""
        spread = np.ptp(self.drawing.rest, axis=0)
        if self.solid:
            return 7.2, 7.2 if spread[2] > 1.5 * spread[:2].max() else 5.0
        wide = 7.2
        return wide, float(np.clip(wide * (spread[1] / max(spread[0], 1e-12)) + 1.2, 2.6, 6.5))

    # parts ---------------------------------------------------------------------------------
    def _ghost(self, ax: Any) -> None:
        rest, style = self.drawing.rest, {"color": GHOST, "lw": 1.0, "zorder": 1}
        dashed = "-" if self.drawing.dimension == 1 else (0, (4, 3))
        for shape in self.drawing.lines:
            self._add_lines(ax, rest[shape.vertices], ls=dashed, **style)
        self._add_lines(ax, rest[self.drawing.outline()], ls="-", **style)

    def _structure(self, ax: Any) -> None:
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import Normalize

        places, field = self.places, self.field
        colours = None
        if field is not None:
            palette = "RdBu_r" if field.has_both_signs else "viridis"
            colours = ScalarMappable(Normalize(*field.range), palette)
        for shape in self.drawing.faces:
            self._faces(ax, shape, places, colours)
        for shape in self.drawing.lines:
            self._lines(ax, shape, places, colours)
        self._nodes(ax, places)
        if field is not None and colours is not None:
            self._bar(ax, colours, field)

    def _bar(self, ax: Any, colours: Any, field: Field) -> None:
        from matplotlib.ticker import EngFormatter, ScalarFormatter

        ticks: Any = ScalarFormatter()
        if field.unit in PREFIXED:
            ticks = EngFormatter(unit=field.unit)
        else:
            ticks.set_powerlimits((-3, 4))
        bar = ax.figure.colorbar(colours, ax=ax, format=ticks, shrink=0.85, pad=0.02)
        bar.set_label(field.name if field.unit in PREFIXED else field.label)
        bar.outline.set_visible(False)

    def _lines(self, ax: Any, shape: Shapes, places: np.ndarray, colours: Any) -> None:
        paths = places[shape.vertices]
        if colours is None or self.field is None:
            self._add_lines(ax, paths, color=PLAIN, lw=2.0, zorder=4)
            return
        if self.field.at_vertices:
            pieces = np.stack([paths[:, :-1], paths[:, 1:]], axis=2).reshape(-1, 2, 3)
            ends = self.field.values[shape.vertices]
            values = ((ends[:, :-1] + ends[:, 1:]) / 2).ravel()
        else:
            pieces, values = paths, self.field.values[shape.owners]
        finite = np.isfinite(values)
        self._add_lines(ax, pieces[~finite], color=GHOST, lw=1.6, zorder=3)
        # a darker core keeps pale colours visible
        self._add_lines(ax, pieces[finite], color=OUTLINE, lw=3.6, zorder=3.9)
        self._add_lines(
            ax, pieces[finite], colors=colours.to_rgba(values[finite]), lw=2.6, zorder=4
        )

    def _faces(self, ax: Any, shape: Shapes, places: np.ndarray, colours: Any) -> None:
        edges = {"edgecolors": (0.1, 0.1, 0.1, 0.35), "linewidths": 0.4 if self.mesh else 0.0}
        outlines = places[shape.vertices]
        if colours is None or self.field is None:
            self._add_faces(ax, outlines, FACE, **(edges | {"edgecolors": PLAIN}))
            return
        if not self.field.at_vertices:
            values = self.field.values[shape.owners]
            self._add_faces(ax, outlines, _rgba(colours, values), **edges)
        elif self.solid:
            values = np.nanmean(self.field.values[shape.vertices], axis=1)
            self._add_faces(ax, outlines, _rgba(colours, values), **edges)
        else:
            self._smooth(ax, shape, places, colours)
            if self.mesh:
                self._add_faces(ax, outlines, "none", **edges)

    def _smooth(self, ax: Any, shape: Shapes, places: np.ndarray, colours: Any) -> None:
        """Interpolate colours between the vertices and the centre of each face."""
        v = shape.vertices
        middles = len(places) + np.repeat(np.arange(len(v)), v.shape[1])
        triangles = np.column_stack([v.ravel(), np.roll(v, -1, axis=1).ravel(), middles])
        values = self.field.values  # type: ignore[union-attr]
        points = np.vstack([places, places[v].mean(axis=1)])
        ax.tripcolor(
            points[:, 0],
            points[:, 1],
            triangles,
            np.nan_to_num(np.concatenate([values, values[v].mean(axis=1)])),
            shading="gouraud",
            cmap=colours.cmap,
            norm=colours.norm,
            zorder=2,
        )

    def _nodes(self, ax: Any, places: np.ndarray) -> None:
        """Draw nodes of structures with few lines, and elements with one node."""
        none = np.zeros(0, dtype=int)
        at = np.concatenate([none, *(p.vertices.ravel() for p in self.drawing.points)])
        if self.drawing.lines and self.drawing.node_count <= 60:
            ends = [s.vertices[:, [0, -1]].ravel() for s in self.drawing.lines]
            ends = [e[e < self.drawing.node_count] for e in ends]
            at = np.unique(np.concatenate([at, *ends]))
        if at.size:
            axes = places[at].T if self.solid else places[at, :2].T
            ax.plot(*axes, "o", ms=3.6, mfc="white", mec=OUTLINE, mew=1.0, ls="", zorder=5)

    # primitives ----------------------------------------------------------------------------
    def _add_lines(self, ax: Any, paths: np.ndarray, **style: Any) -> None:
        if not len(paths):
            return
        if self.solid:
            from mpl_toolkits.mplot3d.art3d import Line3DCollection

            ax.add_collection3d(Line3DCollection(paths, **style))
            return
        from matplotlib.collections import LineCollection

        ax.add_collection(LineCollection(list(paths[..., :2]), capstyle="round", **style))

    def _add_faces(self, ax: Any, outlines: np.ndarray, colours: Any, **style: Any) -> None:
        if self.solid:
            from mpl_toolkits.mplot3d.art3d import Poly3DCollection

            ax.add_collection3d(Poly3DCollection(outlines, facecolors=colours, **style))
            return
        from matplotlib.collections import PolyCollection

        ax.add_collection(
            PolyCollection(list(outlines[..., :2]), facecolors=colours, zorder=2, **style)
        )

    def _frame(self, ax: Any) -> None:
        """Set the limits and equal scales of the axes."""
        point_sets = [self.places, self.drawing.rest] if self.undeformed else [self.places]
        corners = np.concatenate(point_sets)
        low, high = corners.min(axis=0), corners.max(axis=0)
        margin = 0.08 * float((high - low).max())
        if self.solid:
            for axis, a, b in zip("xyz", low, high, strict=True):
                getattr(ax, f"set_{axis}lim")(a - margin / 4, b + margin / 4)
            ax.set_box_aspect(high - low + margin / 2)
            return
        ax.set_xlim(low[0] - margin, high[0] + margin)
        ax.set_ylim(low[1] - margin, high[1] + margin)
        ax.set_aspect("equal", adjustable="box")


def _rgba(colours: Any, values: np.ndarray) -> np.ndarray:
    """Colours of values, grey for NaN."""
    rgba = colours.to_rgba(np.nan_to_num(values))
    rgba[~np.isfinite(values)] = (0.85, 0.85, 0.85, 1.0)
    return rgba
