"""Grids of mechanisms: shapes of bodies with velocities, joints with reactions."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.io.exports.shapes.scene import MovingBody, moving_scene
from dalembert.io.exports.shapes.swing import swings
from dalembert.io.exports.vtk.grid import Grid, State, some
from dalembert.results.labelled import LabelledRecording
from dalembert.results.modes import Modes
from dalembert.symbolic.formulas.expression import Expression

FRAMES = 200
"""Upper limit of instants by default."""


def mechanism_states(source: Any, frames: int | None) -> Iterator[State]:
    """Bodies and joints at instants; modes one after the other, each over a unit of time."""
    if isinstance(source, Modes):
        for number, (_, recording) in enumerate(swings(source)):
            for k, grid in enumerate(_bodies(recording, np.arange(recording.time.size - 1))):
                yield State(number + float(recording.time[k]), {"bodies": grid})
        return
    if not isinstance(source, LabelledRecording):
        raise UnsupportedError(f"VTK has no {type(source).__name__} of a mechanism")
    index = np.array(list(some(source.time.size, frames or FRAMES)))
    velocities, joints = _velocities(source), _Joints(source)
    for k, grid in zip(index, _bodies(source, index, velocities), strict=True):
        parts = {"bodies": grid}
        if joints.names:
            parts["joints"] = joints.grid(int(k))
        yield State(float(source.time[k]), parts)


Velocities = dict[str, tuple[np.ndarray, np.ndarray]]
"""Name of a body → (K, 3) velocity of its origin and angular velocity."""


def _velocities(motion: LabelledRecording) -> Velocities:
    bodies, formulas = motion.model.bodies, []
    for body in bodies:
        place = body.locate(ca.SX.zeros(3))
        formulas += [Expression(body.velocity_at(place)), Expression(body.turning)]
    columns = motion.columns(formulas) if formulas else []
    pairs = zip(columns[::2], columns[1::2], strict=True)
    return {body.name: pair for body, pair in zip(bodies, pairs, strict=True)}


def _bodies(
    recording: LabelledRecording, index: np.ndarray, velocities: Velocities | None = None
) -> Iterator[Grid]:
    """Surfaces and lines of all bodies at instants."""
    scene = moving_scene(recording, index)
    points, owners, cells, cell_owners = _topology(scene.bodies)
    for row, k in enumerate(index):
        places = np.zeros((len(points), 3))
        speeds = np.full((len(points), 3), np.nan)
        for number, body in enumerate(scene.bodies):
            own = owners == number
            places[own] = body.places(points[own], row)
            if body.name == "ground":
                speeds[own] = 0.0
            elif velocities is not None and body.name in velocities:
                velocity, spin = (column[k] for column in velocities[body.name])
                arms = places[own] - body.positions[row]
                speeds[own] = velocity + np.cross(spin, arms)
        data = {} if velocities is None else {"velocity": speeds}
        yield Grid(places, cells, data, {"body": cell_owners})


def _topology(
    bodies: list[MovingBody],
) -> tuple[np.ndarray, np.ndarray, list[tuple[str, np.ndarray]], list[np.ndarray]]:
    """Points in the frames of their bodies, their owners, cells and the owners of these.

    A body without a shape is a vertex.
    """
    points, triangles, lines = [np.zeros((0, 3))], [], []
    owners: list[int] = []
    of_triangles, of_lines, start = [], [], 0
    vertices: list[int] = []
    of_vertices: list[int] = []
    for number, body in enumerate(bodies):
        for surface in body.surfaces:
            triangles.append(surface.triangles + start)
            of_triangles += [number] * len(surface.triangles)
            points.append(surface.vertices)
            start += len(surface.vertices)
        for line in body.lines:
            k = np.arange(len(line) - 1) + start
            lines.append(np.column_stack([k, k + 1]))
            of_lines += [number] * len(k)
            points.append(line)
            start += len(line)
        if not body.surfaces and not body.lines and number:
            vertices.append(start)
            of_vertices.append(number)
            points.append(np.zeros((1, 3)))
            start += 1
        owners += [number] * (start - len(owners))
    tables = [
        np.concatenate([np.zeros((0, width), dtype=int), *part])
        for part, width in ((triangles, 3), (lines, 2))
    ]
    tables.append(np.array(vertices, dtype=int)[:, None])
    owner_tables = [np.array(part, dtype=int) for part in (of_triangles, of_lines, of_vertices)]
    cells = list(zip(("triangle", "line", "vertex"), tables, strict=True))
    return np.concatenate(points), np.array(owners, dtype=int), cells, owner_tables


class _Joints:
    """Places of the joints of a motion with their reactions."""

    def __init__(self, motion: LabelledRecording):
        data = motion.contents
        known: dict[str, Any] = {
            constraint.name: constraint for constraint in motion.model.constraints
        }
        self.names = [name for name in data.labels("joint") if name in known]
        self.force, self.moment = (
            [_vector(data.at(f"reaction_{kind}", joint=name), kind) for name in self.names]
            for kind in ("force", "moment")
        )
        formulas = [Expression(known[name].place()) for name in self.names]
        columns = motion.columns(formulas) if formulas else []
        self.places = [_vector(column, "force") for column in columns]

    def grid(self, k: int) -> Grid:
        """The joints at an instant."""
        points = np.array([column[k] for column in self.places])
        vertices = np.arange(len(points))[:, None]
        data = {
            "reaction_force": np.array([column[k] for column in self.force]),
            "reaction_moment": np.array([column[k] for column in self.moment]),
            "joint": np.arange(len(points)),
        }
        return Grid(points, [("vertex", vertices)], data)


def _vector(values: np.ndarray, kind: str) -> np.ndarray:
    """(K, 3) a vector of the plane or space; a planar moment is about z."""
    table = values.reshape(len(values), -1)
    if table.shape[1] == 1 and kind == "moment":
        return np.column_stack([np.zeros((len(table), 2)), table])
    return np.pad(table, ((0, 0), (0, 3 - table.shape[1])))
