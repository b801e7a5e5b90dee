"""Scene of a mechanism in its modes: columns at rest, and their oscillation in each mode."""

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
from dalembert.symbolic.formulas.oscillation import PARTS, oscillation, parts
from dalembert.symbolic.once import once

POSES = ("position", "angle", "euler_parameters")
"""Variables that a scene without loads and reactions requires."""


def mode_scene(modes: Modes) -> dict[str, Any]:
    """Scene of the mechanism whose columns are ``Blocks`` of six numbers of each mode.

    They are the value at rest and the five numbers of its oscillation to second order, see
    ``symbolic/formulas/oscillation.py``. The largest displacement of a coordinate is one in each
    mode.
    """
    return oscillating_scene(modes, modes.record.oscillations(modes.positions))


def oscillating_scene(result: Any, vectors: np.ndarray) -> dict[str, Any]:
    """Scene of the mechanism of a result in oscillations (6, n, K) of its coordinates."""
    recording = ModeRecording.of(result, vectors)
    scene = motion_scene(recording, np.arange(recording.time.size), loads=False)
    if len(vectors) > 1:
        _tag_blocks(scene, result.model)
    return scene


@once
def swing(model: Model) -> list[ca.SX]:
    """Symbols of an oscillation of the coordinates of the bodies."""
    return parts(model.all_equations.coordinate_count)


@dataclass(eq=False, repr=False)
class ModeRecording(LabelledRecording):
    """Columns of formulas at rest, followed by the numbers of their oscillation in each mode.

    Attributes
    ----------
    vectors : (6, n, K) coordinates at rest and their oscillation
    """

    vectors: np.ndarray = None  # type: ignore[assignment]

    @classmethod
    def of(cls, modes: Any, vectors: np.ndarray) -> ModeRecording:
        """The recording of oscillations; each is one instant of six blocks."""
        e, count = modes.model.all_equations, vectors.shape[0] * vectors.shape[2]
        y, still = np.tile(vectors[0], len(vectors)), np.zeros((e.speed_count, count))
        time, none = np.full(count, modes.record.time), np.zeros((0, count))
        trajectory = Trajectory(time, y, still, still, none, np.zeros((2, count)))
        fixed = (modes.model, modes.analysis, modes.parameters, trajectory, modes.status)
        return cls(*fixed, vectors=vectors)

    def table(self, measures: Any) -> np.ndarray:
        model, s, symbols = self.model, self.trajectory, swing(self.model)
        e, count = model.all_equations, self.vectors.shape[2]
        vectors = (
            self.vectors[1:] if len(self.vectors) > 1 else np.zeros((PARTS, e.y.numel(), count))
        )
        column = stack(model.at_ground(self.expression(m).sx) for m in measures)
        inputs = [e.t, e.y, e.v, e.a, e.transmitted, e.p, *symbols]
        function = ca.Function("columns", inputs, oscillation(column, e.y, symbols))
        still = [np.zeros(part.numel()) for part in (e.v, e.a, e.transmitted)]
        state = (s.t[:1], self.vectors[0], *still, self.parameters)
        blocks = function.map(count)(*state, *vectors)[: len(self.vectors)]
        return np.hstack([part.full() for part in blocks])

    def values(self, measure: str | Expression) -> np.ndarray:
        """Values of a measure at rest, at each of the instants."""
        values = super().values(measure)
        return np.concatenate([values[: self.vectors.shape[2]]] * len(self.vectors))

    @cached_property
    def contents(self) -> Contents:
        layout = [variable for variable in variables(self.model) if variable.name in POSES]
        return Contents.from_arrays(*labelled_variables(self, layout), {})


def _tag_blocks(value: Any, model: Model) -> None:
    """Replace columns with formulas by blocks with the formulas of their oscillation."""
    entries = value.items() if isinstance(value, dict) else enumerate(value)
    for key, item in list(entries):
        if isinstance(item, Column):
            formulas = oscillation(item.sx, model.all_equations.y, swing(model))
            value[key] = Blocks(item, ca.vertcat(*formulas))
        elif isinstance(item, dict | list):
            _tag_blocks(item, model)
