"""Scenes of mechanisms with poses in space, for exported files."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from dalembert.io.exports.rigid.start import Start
from dalembert.io.exports.shapes.surfaces import (
    BAR,
    Surface,
    axes_along,
    drum,
    line_of,
    padded,
    surface_of,
)
from dalembert.model.graph.model import Model
from dalembert.results.dataset import labelled_variables
from dalembert.results.files.contents import Contents
from dalembert.results.labelled import LabelledRecording
from dalembert.results.pictures.mode_scene import POSES
from dalembert.results.pictures.scene import motion_scene
from dalembert.results.recording import Trajectory
from dalembert.results.status import Outcome, Status
from dalembert.results.variables import variables

THIN = 0.004
"""Radius of springs, dampers and actuators, relative to the size."""


@dataclass(eq=False, repr=False)
class Positions(LabelledRecording):
    """Recording of positions without speeds and forces."""

    @cached_property
    def contents(self) -> Contents:
        layout = [variable for variable in variables(self.model) if variable.name in POSES]
        return Contents.from_arrays(*labelled_variables(self, layout), {})


def start_recording(model: Model, parameters: Mapping[str, float] | None = None) -> Positions:
    """The assembled start as a recording of one instant."""
    start = Start(model, parameters)
    return positions(model, start.p, np.zeros(1), start.y[:, None])


def positions(model: Model, p: np.ndarray, time: np.ndarray, y: np.ndarray) -> Positions:
    """A recording of positions ``y`` (n, K)."""
    still = np.zeros((model.all_equations.speed_count, time.size))
    none, work = np.zeros((0, time.size)), np.zeros((2, time.size))
    trajectory = Trajectory(time, y, still, still, none, work)
    status = Status(Outcome.COMPLETED, "positions", 0.0, 0.0)
    return Positions(model, None, p, trajectory, status)  # type: ignore[abstract, arg-type]


@dataclass(frozen=True)
class MovingBody:
    """A body of a scene.

    Attributes
    ----------
    positions : (K, 3) of its frame [m]
    quaternions : (K, 4) Euler parameters, consecutive ones in the same hemisphere
    surfaces : in the frame of the body
    lines : (n, 3) points of lines in the frame of the body
    lengths : (K,) factors along the z axis of links, whose shapes have unit length; else None
    """

    name: str
    positions: np.ndarray
    quaternions: np.ndarray
    surfaces: list[Surface]
    lines: list[np.ndarray]
    lengths: np.ndarray | None = None

    def places(self, points: np.ndarray, k: int) -> np.ndarray:
        """(n, 3) inertial positions of points of the body at an instant."""
        rotation = Rotation.from_quat(self.quaternions[k], scalar_first=True)
        if self.lengths is not None:
            points = points * [1.0, 1.0, self.lengths[k]]
        return np.asarray(rotation.apply(points)) + self.positions[k]


@dataclass(frozen=True)
class MovingScene:
    """Bodies over time; the first is the ground."""

    time: np.ndarray
    bodies: list[MovingBody]


def moving_scene(recording: LabelledRecording, index: np.ndarray | None = None) -> MovingScene:
    """Bodies with their shapes at instants.

    Parameters
    ----------
    index : numbers of the instants, by default all
    """
    keep = np.arange(recording.time.size) if index is None else index
    scene = motion_scene(recording, keep, loads=False)
    size = scene_size(scene)
    entries = [{"name": "ground", "shapes": scene["ground"]["shapes"]}, *scene["bodies"]]
    bodies = [_moving_body(entry, keep.size, size) for entry in entries]
    by_name = {body.name: body for body in bodies}
    links = [_link(entry, by_name, size) for entry in scene["links"]]
    return MovingScene(recording.time[keep], bodies + links)


SOLID = {"strand": BAR, "rod": BAR}
"""Symbols of links that are bars → radius relative to the size; others are thin."""


def _link(entry: Mapping[str, Any], bodies: Mapping[str, MovingBody], size: float) -> MovingBody:
    """A link between points of two bodies, as a bar of variable length."""
    count = len(bodies["ground"].positions)
    ends = [
        np.array(
            [bodies[end["body"]].places(padded(end["point"])[None], k)[0] for k in range(count)]
        )
        for end in (entry["i"], entry["j"])
    ]
    along = ends[1] - ends[0]
    axes = np.array([axes_along(direction) for direction in along])
    quaternions = Rotation.from_matrix(axes).as_quat(scalar_first=True)
    radius = SOLID.get(entry["symbol"], THIN) * size
    bar = drum(np.zeros(3), np.array([0.0, 0.0, 1.0]), radius)
    lengths = np.linalg.norm(along, axis=1)
    return MovingBody(entry["name"], ends[0], _continuous(quaternions), [bar], [], lengths)


def _continuous(quaternions: np.ndarray) -> np.ndarray:
    """Euler parameters with consecutive ones in the same hemisphere."""
    signs = np.sign(np.sum(quaternions[1:] * quaternions[:-1], axis=1))
    factors = np.cumprod(np.where(signs < 0, -1.0, 1.0))
    return np.vstack([quaternions[:1], quaternions[1:] * factors[:, None]])


def scene_size(scene: Mapping[str, Any]) -> float:
    """Length of a mechanism, for shapes of relative size."""
    places = [[body["x"][0], body["y"][0]] for body in scene["bodies"]]
    spread = np.ptp(np.array(places or [[0.0, 0.0]], dtype=float), axis=0).max()
    reach = [
        float(np.linalg.norm(shape[key]))
        for body in scene["bodies"]
        for shape in body["shapes"]
        for key in ("from", "to", "center")
        if key in shape
    ]
    return max([spread, *reach]) or 1.0


def _moving_body(entry: Mapping[str, Any], count: int, size: float) -> MovingBody:
    places, quaternions = np.zeros((count, 3)), np.tile([1.0, 0.0, 0.0, 0.0], (count, 1))
    for k, axis in enumerate("xyz"):
        if axis in entry:
            places[:, k] = np.asarray(entry[axis], dtype=float)
    if "angle" in entry:
        half = np.asarray(entry["angle"], dtype=float) / 2
        quaternions[:, 0], quaternions[:, 3] = np.cos(half), np.sin(half)
    elif "e0" in entry:
        quaternions = np.array([entry[f"e{k}"] for k in range(4)], dtype=float).T
        quaternions = quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)
    shapes = entry["shapes"]
    surfaces = [s for shape in shapes if (s := surface_of(shape, size)) is not None]
    lines = [line for shape in shapes if (line := line_of(shape)) is not None]
    return MovingBody(entry["name"], places, _continuous(quaternions), surfaces, lines)
