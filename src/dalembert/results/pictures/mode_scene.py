"""Scene of a mechanism in its modes: columns at rest, and their changes along each mode."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.model.graph.model import Model
from dalembert.results.dataset import labelled_variables
from dalembert.results.files.contents import Contents
from dalembert.results.labelled import LabelledRecording
from dalembert.results.modes import Modes
from dalembert.results.pictures.scene import motion_scene
from dalembert.results.recording import Trajectory
from dalembert.results.sources import Blocks, Column
from dalembert.results.variables import variables
from dalembert.symbolic.formulas.expression import Expression, stack
from dalembert.symbolic.once import once

POSES = ("position", "angle", "euler_parameters")
"""Variables that a scene without loads and reactions requires."""


def mode_scene(modes: Modes) -> dict[str, Any]:
    """Scene of the mechanism whose columns are ``Blocks`` of three numbers of each mode.

    In a mode with the displacement ``Re(δ exp(iφ))`` a column is ``c + Re(δ) c' cos φ −
    Im(δ) c' sin φ``, to first order; the blocks are ``c``, ``Re(δ) c'`` and ``Im(δ) c'``. The
    largest displacement of a coordinate is one in each mode.
    """
    recording = ModeRecording.of(modes)
    scene = motion_scene(recording, np.arange(3 * modes.numbers.size), loads=False)
    _tag_blocks(scene, modes.model)
    return scene


@once
def movement(model: Model) -> tuple[ca.SX, ca.SX]:
    """Symbols of the real and imaginary part of a displacement of the coordinates."""
    n = model.all_equations.coordinate_count
    return ca.SX.sym("movement_real", n), ca.SX.sym("movement_imag", n)


@dataclass(eq=False, repr=False)
class ModeRecording(LabelledRecording):
    """Columns of formulas at rest, followed by their changes along each mode.

    Attributes
    ----------
    movements : (n, K) complex displacements of the coordinates
    """

    movements: np.ndarray = None  # type: ignore[assignment]

    @classmethod
    def of(cls, modes: Modes) -> ModeRecording:
        """The recording of modes; each is one instant of three blocks."""
        rest, movements = modes.record.movements(modes.positions)
        model, count = modes.model, 3 * modes.numbers.size
        e, y = model.all_equations, np.tile(rest[:, None], count)
        still, none = np.zeros((e.speed_count, count)), np.zeros((0, count))
        time = np.full(count, modes.record.time)
        trajectory = Trajectory(time, y, still, still, none, np.zeros((2, count)))
        fixed = (modes.model, modes.analysis, modes.parameters, trajectory, modes.status)
        return cls(*fixed, movements=movements)

    def table(self, measures: Any) -> np.ndarray:
        model, s, count = self.model, self.trajectory, self.movements.shape[1]
        e, direction = model.all_equations, ca.SX.sym("direction", self.movements.shape[0])
        column = stack(model.at_ground(self.expression(m).sx) for m in measures)
        inputs = [e.t, e.y, e.v, e.a, e.transmitted, e.p, direction]
        outputs = [column, ca.densify(ca.jtimes(column, e.y, direction))]
        function = ca.Function("columns", inputs, outputs).map(2 * count)
        along = np.hstack([self.movements.real, self.movements.imag])
        state = (s.t[0], s.y[:, 0], s.v[:, 0], s.a[:, 0], np.zeros(e.transmitted.numel()))
        rest, changes = (part.full() for part in function(*state, self.parameters, along))
        return np.hstack([rest[:, :count], changes])

    def values(self, measure: str | Expression) -> np.ndarray:
        """Values of a measure at rest, at each of the instants."""
        values = super().values(measure)
        return np.concatenate([values[: self.movements.shape[1]]] * 3)

    @cached_property
    def contents(self) -> Contents:
        layout = [variable for variable in variables(self.model) if variable.name in POSES]
        return Contents.from_arrays(*labelled_variables(self, layout), {})


def _tag_blocks(value: Any, model: Model) -> None:
    """Replace columns with formulas by blocks with the formulas of their changes."""
    entries = value.items() if isinstance(value, dict) else enumerate(value)
    y, parts = model.all_equations.y, movement(model)
    for key, item in list(entries):
        if isinstance(item, Column):
            changes = (ca.jtimes(item.sx, y, part) for part in parts)
            value[key] = Blocks(item, ca.densify(ca.vertcat(item.sx, *changes)))
        elif isinstance(item, dict | list):
            _tag_blocks(item, model)
