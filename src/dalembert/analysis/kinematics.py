"""Kinematic simulation: positions, velocities and accelerations of a driven mechanism.

At each time ``Φ(y, t) = 0``, ``C v = −Φ_t`` and ``C v̇ = ξ`` are solved with one square Jacobian
(1.32–1.41). Each position starts from the Taylor prediction of the one before, and the steps are
short enough for Newton's corrections to stay small against the motion, so the branch is kept.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dalembert.analysis.kinematics_run import KinematicsRun
from dalembert.errors import AnalysisError
from dalembert.model.model import Model
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory


@dataclass(frozen=True)
class Kinematics:
    """Kinematic simulation as a strategy object.

    Parameters
    ----------
    duration : length of the run from t = 0 [s]; this or ``t_span``
    t_span : (start, end) of the run [s]
    step : time between positions, by default a thousandth of the run [s]
    outputs : number of equally spaced times, or the times [s]; default every step
    """

    duration: float | None = None
    step: float | None = None
    outputs: int | Sequence[float] | None = None
    t_span: tuple[float, float] | None = None

    @property
    def efforts(self) -> bool:
        """Whether multipliers are part of the result."""
        return False

    def run(
        self,
        model: Model,
        parameters: Mapping[str, float] | np.ndarray | None = None,
        progress: bool | Callable[[float], None] = False,
    ) -> Motion:
        """Move the mechanism; where it locks, keep what was found and say when.

        Raises
        ------
        AnalysisError
            The mechanism is not fully driven, or a wrong step, duration or outputs.
        AssemblyError
            It cannot be assembled at the start.
        """
        return KinematicsRun(self, model, parameters).execute(progress)

    def resample(self, motion: Motion, times: np.ndarray) -> Motion:
        """The motion at other times, each reached from the nearest one computed."""
        s = motion.trajectory
        nearest = np.abs(s.t[None, :] - times[:, None]).argmin(axis=1)
        ahead = times - s.t[nearest]
        near = s.y[:, nearest] + ahead * s.v[:, nearest] + ahead**2 / 2 * s.a[:, nearest]
        return self.solve_at(motion, times, near, motion.parameters)

    def replay(self, motion: Motion, p: np.ndarray) -> Motion:
        """The same instants at other parameter values, on the same branch."""
        return self.solve_at(motion, motion.time, motion.trajectory.y, p)

    def solve_at(
        self, motion: Motion, times: np.ndarray, near: np.ndarray, p: np.ndarray
    ) -> Motion:
        """Configurations at given times near given positions."""
        function = motion.record.kernel.configuration.function
        parts = function.map(times.size)(times, near, np.tile(p[:, None], times.size))
        y, v, a, multiplier = (part.full() for part in parts)
        if not self.efforts:
            multiplier = np.full_like(multiplier, np.nan)
        work = np.full((2, times.size), np.nan)
        if self.efforts and motion.time.size > 3:
            from scipy.interpolate import CubicSpline

            work = CubicSpline(motion.time, motion.trajectory.work, axis=1)(times)
        trajectory = Trajectory(times, y, v, a, multiplier, work)
        return replace(motion, parameters=p, trajectory=trajectory)


def solve_kinematics(
    model: Model,
    duration: float | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    progress: bool | Callable[[float], None] = False,
    **options: Any,
) -> Motion:
    """Positions, velocities and accelerations of a driven mechanism over time (Fig. 1.12).

    Parameters
    ----------
    model : fully driven Model; masses are not needed
    duration : [s]
    parameters : new values of parameters, without rebuilding
    progress : True for a bar, or a function of the fraction done
    **options : fields of ``Kinematics``: step, outputs, t_span

    Raises
    ------
    AnalysisError
        Not fully driven, a singular start, or wrong options; ``AssemblyError`` where the mechanism
        cannot be put together.
    """
    try:
        analysis = Kinematics(duration=duration, **options)
    except TypeError as error:
        raise AnalysisError(f"solve_kinematics: {error}") from None
    return analysis.run(model, parameters, progress)
