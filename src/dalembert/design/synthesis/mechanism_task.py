"""What is sought of a mechanism with a motor, and how far a turn of it is from that."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.analysis.kinematics.kinematics import Kinematics
from dalembert.design.synthesis.target import Target
from dalembert.errors import AnalysisError, DalembertError
from dalembert.model.model import Model
from dalembert.results.motion import Motion
from dalembert.text.wording import unknown

SAMPLES = 144
"""Positions of a turn among which entries are looked for at first."""
DRAWS = 40
"""Random mechanisms tried for each one that turns."""


@dataclass(frozen=True, eq=False)
class MechanismTask:
    """What is sought of a mechanism.

    Parameters
    ----------
    model : driven Model
    target : Target
    measures : ``"x"``, ``"y"``, ``"angle"``, ``"output"`` → measure, as far as the target has it
    vary : parameters
    bounds : of them, in their order
    speed : of the motor [rad/s]
    order : free timing passes the entries in their order
    """

    model: Model
    target: Target
    measures: Mapping[str, str]
    vary: tuple[str, ...]
    bounds: np.ndarray
    speed: float
    order: bool

    @property
    def period(self) -> float:
        return 2 * math.pi / abs(self.speed)

    @property
    def free_timing(self) -> bool:
        return self.target.crank_angles is None

    # one turn ------------------------------------------------------------------------------
    def turned(self, q: np.ndarray, times: Any = SAMPLES + 1) -> Motion | None:
        """A turn of the motor with these parameters; None where it cannot be made."""
        try:
            run = Kinematics(self.period, outputs=times).run(
                self.model, dict(zip(self.vary, map(float, q), strict=True))
            )
        except DalembertError:
            return None
        return run if run.status.success else None

    def drawn(self, rng: np.random.Generator) -> tuple[np.ndarray, Motion] | None:
        """A random mechanism within the bounds whose motor turns all the way."""
        for _ in range(DRAWS):
            q = rng.uniform(self.bounds[:, 0], self.bounds[:, 1])
            made = self.turned(q)
            if made is not None:
                return q, made
        return None

    @property
    def given(self) -> np.ndarray:
        """Times of the entries from the first on."""
        angles = self.target.crank_angles
        assert angles is not None
        return (angles - angles[0]) / self.speed

    # distances -----------------------------------------------------------------------------
    def off(self, rows: Any, turned: Any, sums: Callable[[Any], Any]) -> Any:
        """Sum of squares of measures in rows, ``x, y, angle, output``, at the entries."""
        target, total = self.target, 0.0
        if target.points is not None:
            total = sums(rows["x"] - target.points[:, 0]) + sums(rows["y"] - target.points[:, 1])
        if target.coupler_angles is not None:
            total += sums(rows["angle"] - turned["angle"] - target.coupler_angles)
        if target.outputs is not None:
            total += sums(rows["output"] - turned["output"] - target.outputs)
        return total

    def counted_from(self, rows: Mapping[str, np.ndarray]) -> dict[str, float]:
        """From where angles and outputs are counted, as it suits them best."""
        aims = {"angle": self.target.coupler_angles, "output": self.target.outputs}
        return {
            name: float(np.mean(rows[name] - aim)) if aim is not None else 0.0
            for name, aim in aims.items()
        }

    def distance(self, run: Motion) -> tuple[float, np.ndarray]:
        """Error of a run at the entries, and the distances of points or outputs."""
        rows = {name: run.values(m) for name, m in self.measures.items()}
        for name in ("angle", "output"):
            if name in rows:
                rows[name] = np.unwrap(rows[name])
        free = self.counted_from(rows)
        error = float(self.off(rows, free, lambda z: float(np.sum(np.square(z)))))
        if self.target.points is not None:
            two = np.array([rows["x"], rows["y"]]).T - self.target.points
            return error, np.linalg.norm(two, axis=1)
        assert self.target.outputs is not None
        return error, abs(rows["output"] - free["output"] - self.target.outputs)


def mechanism_task(
    target: Target,
    model: Model,
    point: str,
    body: str,
    output: str,
    vary: Any,
    bounds: Mapping[str, tuple[float, float]] | None,
    speed: float,
    order: bool,
) -> MechanismTask:
    """The task, its names checked.

    Raises
    ------
    AnalysisError
        A parameter without two bounds, or a measure that the target needs and that is not named.
    """
    measures: dict[str, str] = {}
    for needed, given, what, made in (
        (target.points is not None, point, "point", {"x": f"{point}.x", "y": f"{point}.y"}),
        (target.coupler_angles is not None, body, "body", {"angle": f"{body}.angle"}),
        (target.outputs is not None, output, "output", {"output": output}),
    ):
        if needed and not given:
            raise AnalysisError(f"the target needs {what}=: name it, such as point='coupler.P'")
        measures |= made if needed else {}
    for measure in measures.values():
        model.expression(measure)
    names = (
        tuple(vary)
        if vary is not None
        else tuple(
            n
            for n, p in model.parameters.items()
            if np.all(np.isfinite((bounds or {}).get(n, p.bounds)))
        )
    )
    ends = []
    for name in names:
        if name not in model.parameters:
            raise AnalysisError(unknown("parameter", name, model.parameters))
        pair = (bounds or {}).get(name, model.parameters[name].bounds)
        if not np.all(np.isfinite(pair)):
            raise AnalysisError(f"synthesis needs two finite bounds of {name!r}; give bounds=")
        ends.append(pair)
    if not names:
        raise AnalysisError("nothing to vary: give parameters bounds, or vary= and bounds=")
    return MechanismTask(model, target, measures, names, np.array(ends, dtype=float), speed, order)
