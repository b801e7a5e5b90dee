"""Animation of a motion with Matplotlib, for notebooks."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation

from dalembert.results.labelled import LabelledRecording
from dalembert.results.scene import motion_scene

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d31")


class Drawing:
    """The mechanism in a pair of axes; ``show(k)`` moves it to instant ``k``."""

    def __init__(self, motion: LabelledRecording, ax: Any, keep: np.ndarray):
        self.ax, self.scene = ax, motion_scene(motion, keep)
        self.parts: list[tuple[Any, str, np.ndarray]] = []
        for shape in self.scene["ground"]["shapes"]:
            self._add("ground", shape, "0.6")
        for k, body in enumerate(self.scene["bodies"]):
            for shape in body["shapes"]:
                self._add(body["name"], shape, COLOURS[k % len(COLOURS)])
        self.poses = {
            b["name"]: np.array([b["x"], b["y"], b["angle"]]).T for b in self.scene["bodies"]
        }
        self.links = [
            (ax.plot([], [], color="0.35", lw=1, ls="--")[0], link) for link in self.scene["links"]
        ]
        self._limits()

    def _add(self, body: str, shape: dict, colour: str) -> None:
        points = outline(shape)
        closed = shape["kind"] in ("polygon", "disc", "block", "curve")
        width = 4 if shape["kind"] == "bar" else 1.5
        marker = "o" if shape["kind"] in ("bar", "particle") else None
        if closed:
            points = np.vstack([points, points[:1]])
        (line,) = self.ax.plot([], [], color=colour, lw=width, marker=marker, ms=5)
        line.set_solid_capstyle("round")
        self.parts.append((line, body, points))

    def _limits(self) -> None:
        corners = []
        for _, body, points in self.parts:
            frames = self.poses.get(body, np.zeros((1, 3)))
            for pose in frames[:: max(1, len(frames) // 60)]:
                corners.append(placed(points, pose))
        every = np.vstack(corners)
        low, high = every.min(axis=0), every.max(axis=0)
        margin = 0.08 * (max(*(high - low)) or 1.0)
        self.ax.set(
            xlim=(low[0] - margin, high[0] + margin),
            ylim=(low[1] - margin, high[1] + margin),
            aspect="equal",
            xlabel="x [m]",
            ylabel="y [m]",
        )

    def show(self, k: int) -> list:
        """Move every part to instant ``k``; returns the artists."""
        still = np.zeros(3)
        pose = {name: frames[k] for name, frames in self.poses.items()} | {"ground": still}
        for line, body, points in self.parts:
            line.set_data(*placed(points, pose[body]).T)
        for line, link in self.links:
            ends = [placed(np.array([link[e]["point"]]), pose[link[e]["body"]])[0] for e in "ij"]
            line.set_data(*np.array(ends).T)
        return [part[0] for part in self.parts] + [line for line, _ in self.links]


def outline(shape: dict) -> np.ndarray:
    """Points of a shape in its body's frame."""
    kind = shape["kind"]
    if kind in ("bar", "line"):
        return np.array([shape["from"], shape["to"]])
    if kind in ("polygon", "curve"):
        return np.array(shape["points"])
    center = np.array(shape["center"])
    if kind == "disc":
        angle = np.linspace(0, 2 * np.pi, 49)
        rim = center + shape["radius"] * np.column_stack([np.cos(angle), np.sin(angle)])
        return np.vstack([center, rim])
    if kind == "block":
        c, s = np.cos(shape["angle"]), np.sin(shape["angle"])
        half = np.array([shape["width"], shape["height"]]) / 2
        corners = half * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
        return center + corners @ np.array([[c, s], [-s, c]])
    return center.reshape(1, 2)


def placed(points: np.ndarray, pose: np.ndarray) -> np.ndarray:
    """Body points in inertial axes."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return points @ np.array([[c, s], [-s, c]]) + pose[:2]


class Film(FuncAnimation):
    """Animation that notebooks show by themselves, with a player."""

    def _repr_html_(self) -> str:
        return self.to_jshtml()


def animate(
    motion: LabelledRecording, *, fps: int = 30, speed: float = 1.0, ax: Any = None
) -> Film:
    """Matplotlib animation in real time (times ``speed``); ``save`` writes it as a film."""
    span = motion.time[-1] - motion.time[0]
    frames = int(np.clip(fps * span / speed, 2, 600))
    wanted = np.linspace(motion.time[0], motion.time[-1], frames)
    keep = np.clip(np.searchsorted(motion.time, wanted), 0, motion.time.size - 1)
    if ax is None:
        _, ax = plt.subplots(layout="constrained")
    drawing = Drawing(motion, ax, keep)
    ax.set_title(motion.model.name)
    film = Film(
        ax.figure,
        drawing.show,
        frames=frames,
        interval=1000 / fps,
        blit=True,
        cache_frame_data=False,
    )
    plt.close(ax.figure)  # notebooks would show the still picture as well
    return film
