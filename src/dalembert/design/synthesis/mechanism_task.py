"""Synthesis task of a driven mechanism, and its deviation from the target."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.analysis.kinematics.kinematics import Kinematics
from dalembert.design.synthesis.target import Target
from dalembert.errors import AnalysisError, DalembertError
from dalembert.model.graph.model import Model
from dalembert.results.motion import Motion
from dalembert.text.wording import unknown

SAMPLES = 144
"""Number of positions per revolution for the initial assignment of entries."""
MAX_DRAWS = 40
"""Upper limit of random mechanisms per mechanism with a rotating motor."""


@dataclass(frozen=True, eq=False)
class MechanismTask:
    """A synthesis task of a driven mechanism.

    Parameters
    ----------
    model : driven Model
    target : Target
    measures : ``"x"``, ``"y"``, ``"angle"``, ``"output"`` → measure, if the target contains it
    vary : names of the varied parameters
    bounds : (n, 2) bounds of these parameters
    speed : of the motor [rad/s]
    order : for free timing, whether the entries are passed in their order
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

    # revolutions ---------------------------------------------------------------------------
    def run_revolution(self, q: np.ndarray) -> Motion | None:
        """A revolution of the motor with these parameters; None if it fails."""
        try:
            run = Kinematics(self.period, outputs=SAMPLES + 1).run(
                self.model, dict(zip(self.vary, map(float, q), strict=True))
            )
        except DalembertError:
            return None
        return run if run.status.success else None

    def draw(self, rng: np.random.Generator) -> tuple[np.ndarray, Motion] | None:
        """A random mechanism within the bounds with a fully rotating motor."""
        for _ in range(MAX_DRAWS):
            q = rng.uniform(self.bounds[:, 0], self.bounds[:, 1])
            motion = self.run_revolution(q)
            if motion is not None:
                return q, motion
        return None

    @property
    def entry_times(self) -> np.ndarray:
        """Times of the entries relative to the first one."""
        angles = self.target.crank_angles
        assert angles is not None
        return (angles - angles[0]) / self.speed

    # distances -----------------------------------------------------------------------------
    def squared_error(self, rows: Any, origins: Any, sums: Callable[[Any], Any]) -> Any:
        """Sum of squared deviations of the measures ``x, y, angle, output`` at the entries."""
        target, total = self.target, 0.0
        if target.points is not None:
            total = sums(rows["x"] - target.points[:, 0]) + sums(rows["y"] - target.points[:, 1])
        if target.coupler_angles is not None:
            total += sums(rows["angle"] - origins["angle"] - target.coupler_angles)
        if target.outputs is not None:
            total += sums(rows["output"] - origins["output"] - target.outputs)
        return total

    def origins(self, rows: Mapping[str, np.ndarray]) -> dict[str, float]:
        """Optimal origins of angles and outputs."""
        targets = {"angle": self.target.coupler_angles, "output": self.target.outputs}
        return {
            name: float(np.mean(rows[name] - target)) if target is not None else 0.0
            for name, target in targets.items()
        }

    def distance(self, run: Motion) -> tuple[float, np.ndarray]:
        """Error of a run at the entries, and the deviations of points or outputs."""
        rows = {name: run.values(m) for name, m in self.measures.items()}
        for name in ("angle", "output"):
            if name in rows:
                rows[name] = np.unwrap(rows[name])
        origins = self.origins(rows)
        error = float(self.squared_error(rows, origins, lambda z: float(np.sum(np.square(z)))))
        if self.target.points is not None:
            vectors = np.array([rows["x"], rows["y"]]).T - self.target.points
            return error, np.linalg.norm(vectors, axis=1)
        assert self.target.outputs is not None
        return error, abs(rows["output"] - origins["output"] - self.target.outputs)


def mechanism_task(
    target: Target,
    model: Model,
    point: str,
    body: str,
    output: str,
    vary: Sequence[str] | None,
    bounds: Mapping[str, tuple[float, float]] | None,
    speed: float,
    order: bool,
) -> MechanismTask:
    """The task, after checking all names.

    Raises
    ------
    AnalysisError
        A parameter has no two bounds, or a measure that the target needs is missing.
    """
    measures: dict[str, str] = {}
    for needed, name, option, entries in (
        (target.points is not None, point, "point", {"x": f"{point}.x", "y": f"{point}.y"}),
        (target.coupler_angles is not None, body, "body", {"angle": f"{body}.angle"}),
        (target.outputs is not None, output, "output", {"output": output}),
    ):
        if needed and not name:
            raise AnalysisError(f"the target needs {option}=: name it, such as point='coupler.P'")
        measures |= entries if needed else {}
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
    limits = []
    for name in names:
        if name not in model.parameters:
            raise AnalysisError(unknown("parameter", name, model.parameters))
        pair = (bounds or {}).get(name, model.parameters[name].bounds)
        if not np.all(np.isfinite(pair)):
            raise AnalysisError(f"synthesis needs two finite bounds of {name!r}; give bounds=")
        limits.append(pair)
    if not names:
        raise AnalysisError("nothing to vary: give parameters bounds, or vary= and bounds=")
    return MechanismTask(
        model, target, measures, names, np.array(limits, dtype=float), speed, order
    )
