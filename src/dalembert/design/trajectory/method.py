"""Base class of methods of trajectory optimisation."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.design.methods.search_options import check_stop
from dalembert.design.trajectory.physics import Physics
from dalembert.design.trajectory.transcription import Transcription
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.model.graph.model import Model
from dalembert.options import inherit_texts, options
from dalembert.results.analysis import Analysis
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory

STEPS = 20
"""Number of steps of a forward run per interval."""


@options
class TrajectoryMethod(Analysis[Model, Motion]):
    """Transcription of a motion to a nonlinear programme, solved by Ipopt.

    A new method implements ``transcription``.

    Parameters
    ----------
    intervals : number of intervals of equal length; controls are parabolas in each of them
    max_iterations, tolerance : of Ipopt
    """

    intervals: int = 40
    max_iterations: int = 500
    tolerance: float = 1e-8

    def __init_subclass__(cls) -> None:
        inherit_texts(cls)

    def __post_init__(self) -> None:
        check_stop(self.max_iterations, self.tolerance)
        if self.intervals < 2:
            raise AnalysisError(f"intervals is {self.intervals}; give two at least")

    def transcription(self, physics: Physics, duration: tuple[float, float]) -> Transcription:
        """The unknowns of the motion and the equations between them."""
        raise NotImplementedError

    def finer(self, steps: bool) -> TrajectoryMethod:
        """The method with twice as many intervals, or with more steps if these are too long."""
        return replace(self, intervals=2 * self.intervals)

    @property
    def expands(self) -> bool:
        """Whether the programme expands to scalar operations, as it contains no solvers."""
        return True

    def forward(self, duration: float) -> Dynamics:
        """The analysis of the forward run under the controls."""
        return Dynamics(duration, step=duration / (STEPS * self.intervals))

    def run(self, model: Model, parameters: Any = None) -> Motion:
        raise UnsupportedError("a plan is computed by da.optimize_trajectory, not by a run")

    def resample(self, motion: Motion, times: np.ndarray) -> Motion:
        """The plan between its knots, interpolated by cubics through positions and through speeds.

        Raises
        ------
        AnalysisError
            A time is outside the plan.
        """
        from scipy.interpolate import CubicHermiteSpline, interp1d

        s = motion.trajectory
        if np.any(times < s.t[0] - 1e-9) or np.any(times > s.t[-1] + 1e-9):
            raise AnalysisError(
                f"the plan goes from {s.t[0]:g} to {s.t[-1]:g} s; give times within it"
            )
        instants = np.clip(times, s.t[0], s.t[-1])
        e = motion.model.equations
        if e.manifold.flat:
            y = CubicHermiteSpline(s.t, s.y, s.v, axis=1)(instants)
        else:  # displacement from the nearest knot
            nearest = np.searchsorted((s.t[1:] + s.t[:-1]) / 2, instants)
            elapsed = instants - s.t[nearest]
            displacement = elapsed * s.v[:, nearest] + elapsed**2 / 2 * s.a[:, nearest]
            y = e.manifold.go(s.y[:, nearest], displacement)
        v = CubicHermiteSpline(s.t, s.v, s.a, axis=1)(instants)
        a, multiplier, work = (
            interp1d(s.t, part, axis=1)(instants) for part in (s.a, s.multiplier, s.work)
        )
        return replace(motion, trajectory=Trajectory(instants, y, v, a, multiplier, work))
