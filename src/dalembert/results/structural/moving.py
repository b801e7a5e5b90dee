"""Animated structure in Matplotlib axes: through its states, or oscillating in one of them."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.collections import LineCollection, PolyCollection

from dalembert.errors import AnalysisError, FileError
from dalembert.text.wording import unknown

TURN = (-0.6, -1.15)
"""Rotation about z and tilt of spatial structures, as on pages [rad]."""
LINE, FACE, REST = "#0b63a5", "#9fc3e0", "#9aa5b1"
MARGIN = 0.08


class MovingStructure:
    """Animated structure; ``show(k)`` draws frame ``k``.

    Parameters
    ----------
    page : payload of the page of a structure
    frames : number of frames of one oscillation; at most the number of consecutive states
    state : name of the load case or mode that oscillates; the first by default

    Attributes
    ----------
    count : frames
    """

    def __init__(self, page: dict[str, Any], frames: int, state: str | None = None):
        self.drawing, names = page["drawing"], [str(name) for name in page["cases"]]
        if state is not None and state not in names:
            raise FileError(unknown("state", state, names))
        if not names:
            raise AnalysisError("there is no state to film")
        self.rest = np.asarray(self.drawing["rest"], dtype=float).reshape(-1, 3)
        displacements = [
            np.asarray(m, dtype=float).reshape(-1, 3) for m in page["vertex_displacements"]
        ]
        self.solid = page["dimension"] == 3
        if page["sequence"] and len(names) > 1 and state is None:
            index = np.linspace(0, len(names) - 1, min(frames, len(names))).round().astype(int)
            self.places = [self.rest + page["scales"][k] * displacements[k] for k in index]
            self.names = [names[k] for k in index]
        else:
            k = names.index(state) if state is not None else 0
            shares = np.sin(2 * np.pi * np.arange(frames) / frames)
            self.places = [
                self.rest + share * page["scales"][k] * displacements[k] for share in shares
            ]
            self.names = [names[k]] * frames
        self.count, self.title = len(self.places), page["title"]
        self.ax = self._axes()

    def show(self, k: int) -> list[Any]:
        """Draw frame ``k``."""
        projected = self._projected(self.places[k])
        self.lines.set_segments([projected[run] for run in self._runs("lines")])
        self.faces.set_verts([projected[run] for run in self._runs("faces")])
        self.ax.set_title(" · ".join(part for part in (self.title, self.names[k]) if part))
        return [self.lines, self.faces]

    def _axes(self) -> Any:
        ax = plt.subplots(layout="constrained")[1]
        rest = self._projected(self.rest)
        edges = [rest[run] for run in self._runs("lines")]
        outline = np.asarray(self.drawing["outline"], dtype=int).reshape(-1, 2)
        ax.add_collection(LineCollection([*edges, *rest[outline]], colors=REST, ls="--", lw=0.8))
        self.faces = PolyCollection([], fc=FACE, ec="#33536e", lw=0.4)
        self.lines = LineCollection([], colors=LINE, lw=2.2)
        ax.add_collection(self.faces)
        ax.add_collection(self.lines)
        points = np.concatenate([self._projected(places) for places in [self.rest, *self.places]])
        low, high = points.min(axis=0), points.max(axis=0)
        margin = MARGIN * max(float((high - low).max()), 1e-12)
        ax.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin))
        ax.set_aspect("equal")
        ax.set_axis_off()
        return ax

    def _runs(self, kind: str) -> list[np.ndarray]:
        """Vertices of each line or face."""
        return [
            run
            for shape in self.drawing[kind]
            for run in np.asarray(shape["vertices"], dtype=int).reshape(-1, int(shape["size"]))
        ]

    def _projected(self, places: np.ndarray) -> np.ndarray:
        """(vertices, 2) projected positions."""
        if not self.solid:
            return places[:, :2]
        (ca, cb), (sa, sb) = np.cos(TURN), np.sin(TURN)
        x, y = ca * places[:, 0] - sa * places[:, 1], sa * places[:, 0] + ca * places[:, 1]
        return np.column_stack([x, cb * y - sb * places[:, 2]])
