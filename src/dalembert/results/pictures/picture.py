"""Matplotlib picture of a planar or spatial mechanism."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import matplotlib.pyplot as plt
import numpy as np

from dalembert.elements.point import AXES
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.outlines import outline
from dalembert.results.pictures.scene import is_spatial, motion_scene
from dalembert.symbolic.rotation import EULER_PARAMETERS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d31")
FORCE = "#c00000"
LONGEST = 0.25
"""Length of the largest contact force, relative to the height of the picture."""
LINE_WIDTHS = {"bar": 4.0, "capsule": 4.0, "line": 1.5}
"""Line widths; outlines are thin."""


class ScenePicture:
    """Picture of a scene; ``show(k)`` moves the mechanism to instant ``k``.

    Parameters
    ----------
    scene : scene of a page
    spatial : whether the scene is spatial
    count : number of instants
    title : title of the axes
    ax : axes, in three dimensions for a mechanism in space; new ones if None
    """

    def __init__(self, scene: dict[str, Any], spatial: bool, count: int, title: str, ax: Any):
        self.scene, self.spatial = scene, spatial
        self.dimension = 3 if self.spatial else 2
        self.ax = ax if ax is not None else self._axes()
        self.poses = {body["name"]: pose_of(body) for body in self.scene["bodies"]}
        positions = np.zeros((count, self.dimension))
        self.poses["ground"] = np.stack([np.eye(self.dimension)] * count), positions
        self.parts: list[tuple[Any, str, np.ndarray]] = []
        for shape in self.scene["ground"]["shapes"]:
            self._add("ground", shape, "0.6")
        names = [body["name"] for body in self.scene["bodies"]]
        for body in self.scene["bodies"]:
            owner = body.get("of", body["name"])
            for shape in body["shapes"]:
                self._add(body["name"], shape, COLOURS[names.index(owner) % len(COLOURS)])
                if owner != body["name"]:
                    self.parts[-1][0].set_marker("")
        fixed = [joint for joint in self.scene["joints"] if "at_x" not in joint]
        for joint in fixed if self.spatial else ():
            line = self._line(color="0.25", marker="o", ms=4, mfc="white")
            self.parts.append((line, joint["body"], np.array([joint["point"]])))
        self.links = [
            (self._line(color="0.35", lw=1, ls="--"), link) for link in self.scene["links"]
        ]
        self._limits()
        self.forces = self._contact_forces()
        self.ax.set_title(title)

    def _axes(self) -> Any:
        projection = {"projection": "3d"} if self.spatial else {}
        return plt.subplots(layout="constrained", subplot_kw=projection)[1]

    def _line(self, **style: Any) -> Any:
        (line,) = self.ax.plot(*[[]] * self.dimension, **style)
        line.set_solid_capstyle("round")
        return line

    def _add(self, body: str, shape: dict, colour: str) -> None:
        width = LINE_WIDTHS.get(shape["kind"], 1.5 if not self.spatial else 1.0)
        marker = "o" if shape["kind"] in ("bar", "particle") else None
        line = self._line(color=colour, lw=width, marker=marker, ms=5)
        self.parts.append((line, body, outline(shape)))

    def _limits(self) -> None:
        blocks = []
        for _, body, points in self.parts:
            rotations, positions = self.poses[body]
            for k in range(0, len(positions), max(1, len(positions) // 60)):
                blocks.append(points @ rotations[k].T + positions[k])
        for _, link in self.links:
            for end in (link["i"], link["j"]):
                rotations, positions = self.poses[end["body"]]
                blocks.append(rotations @ np.array(end["point"]) + positions)
        table = np.vstack(blocks) if blocks else np.zeros((1, self.dimension))
        low, high = np.nanmin(table, axis=0), np.nanmax(table, axis=0)
        size = max(high - low) or 1.0
        min_height = 0.1 * size * self.spatial
        low, high = low - 0.08 * size, np.maximum(high, low + min_height) + 0.08 * size
        for name, *ends in zip(AXES, low, high, strict=False):
            self.ax.set(**{f"{name}lim": ends, f"{name}label": f"{name} [m]"})
        self.ax.set_aspect("equal")
        if self.spatial:
            self.ax.view_init(elev=22, azim=-58, vertical_axis=self._vertical())

    def _contact_forces(self) -> list[tuple[Any, np.ndarray]]:
        """Lines of contact forces with their ends (K, 2, d), to a common scale."""
        axes = AXES[: self.dimension]
        contacts = [joint for joint in self.scene["joints"] if joint["symbol"] == "contact"]
        contacts = [joint for joint in contacts if "force_x" in joint]
        if not contacts:
            return []
        places, forces = (
            np.array(
                [[joint[f"{kind}_{axis}"] for axis in axes] for joint in contacts], dtype=float
            )
            for kind in ("at", "force")
        )
        low, high = self.ax.get_ylim()
        largest = np.nanmax(np.linalg.norm(forces, axis=1), initial=0.0) or 1.0
        tips = places + LONGEST * (high - low) / largest * forces
        ends = np.stack([places, tips], axis=1).transpose(0, 3, 1, 2)
        style: dict[str, Any] = {"color": FORCE, "lw": 1.5, "marker": ".", "markevery": [0]}
        return [(self._line(**style), points) for points in ends]

    def _vertical(self) -> str:
        """Axis of gravity."""
        gravity = self.scene["gravity"]
        return AXES[int(np.argmax(np.abs(gravity)))] if gravity and any(gravity) else "z"

    def show(self, k: int) -> list:
        """Move every part to instant ``k``; returns the artists."""
        for line, body, points in self.parts:
            self._set(line, self._transformed(body, points, k))
        for line, link in self.links:
            ends = [
                self._transformed(link[e]["body"], np.array([link[e]["point"]]), k) for e in "ij"
            ]
            self._set(line, np.vstack(ends))
        for line, points in self.forces:
            self._set(line, points[k])
        lines = [part[0] for part in self.parts] + [line for line, _ in self.links]
        return lines + [line for line, _ in self.forces]

    def _transformed(self, body: str, points: np.ndarray, k: int) -> np.ndarray:
        rotations, positions = self.poses[body]
        return points @ rotations[k].T + positions[k]

    def _set(self, line: Any, points: np.ndarray) -> None:
        set_data = line.set_data_3d if self.spatial else line.set_data
        set_data(*points.T)


class Picture(ScenePicture):
    """Picture of a motion at some of its instants.

    Parameters
    ----------
    motion : motion that is drawn
    keep : its instants
    ax : axes, in three dimensions for a mechanism in space; new ones if None
    """

    def __init__(self, motion: LabelledRecording, keep: np.ndarray, ax: Axes | None = None):
        scene = motion_scene(motion, keep, loads=False)
        super().__init__(scene, is_spatial(motion.model), len(keep), motion.model.name, ax)


def pose_of(body: dict[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """(K, d, d) rotations and (K, d) positions of a body of a scene."""
    if "angle" in body:
        c, s = np.cos(body["angle"]), np.sin(body["angle"])
        rotations = np.moveaxis(np.array([[c, -s], [s, c]]), 2, 0)
        return rotations, np.column_stack([body["x"], body["y"]])
    parameters = np.column_stack([body[name] for name in EULER_PARAMETERS])
    rotations = np.full((len(parameters), 3, 3), np.nan)
    finite = np.isfinite(parameters).all(axis=1)
    if finite.any():
        from scipy.spatial.transform import Rotation

        rotations[finite] = Rotation.from_quat(parameters[finite], scalar_first=True).as_matrix()
    return rotations, np.column_stack([body[name] for name in AXES])
