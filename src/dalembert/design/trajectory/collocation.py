"""Direct collocation as a strategy object."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.model.model import Model
from dalembert.options import options
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.results.result import Analysis


@options
class DirectCollocation(Analysis[Model, Motion]):
    """Hermite–Simpson collocation, solved by Ipopt.

    Parameters
    ----------
    intervals : of equal length, in each a cubic for states and a parabola for controls
    max_iterations, tolerance : of Ipopt

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("cart")
    >>> push = system.parameter("push", 0.0, "N", bounds=(-4, 4))
    >>> cart = system.add(planar.Particle("cart", mass=1.0))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, cart.center))
    >>> force = system.add(planar.Force("force", cart.center, (push, 0)))
    >>> fine = da.DirectCollocation(intervals=8)
    >>> best = da.optimize_trajectory(system.build(), da.final("time"), controls=["push"],
    ...     duration=(0.5, 3), end={"cart.x": 1, "cart.vx": 0}, method=fine)
    >>> round(best.duration, 3)  # 2 √(m x/F): full on, full back
    1.0
    """

    spoken = "direct collocation"

    intervals: int = 40
    max_iterations: int = 500
    tolerance: float = 1e-8

    def __post_init__(self) -> None:
        if self.intervals < 2:
            raise AnalysisError(f"intervals is {self.intervals}; give two at least")

    def run(self, model: Model, parameters: Any = None) -> Motion:
        raise UnsupportedError("a plan is made by da.optimize_trajectory, not by a run")

    def resample(self, motion: Motion, times: np.ndarray) -> Motion:
        """The plan between its knots: cubics through positions and through speeds.

        Raises
        ------
        AnalysisError
            A time outside the plan.
        """
        from scipy.interpolate import CubicHermiteSpline, interp1d

        s = motion.trajectory
        if np.any(times < s.t[0] - 1e-9) or np.any(times > s.t[-1] + 1e-9):
            raise AnalysisError(f"the plan goes from {s.t[0]:g} to {s.t[-1]:g} s; ask within")
        at = np.clip(times, s.t[0], s.t[-1])
        e = motion.model.equations
        if e.manifold.flat:
            y = CubicHermiteSpline(s.t, s.y, s.v, axis=1)(at)
        else:  # positions lead from the nearest knot
            near = np.searchsorted((s.t[1:] + s.t[:-1]) / 2, at)
            ahead = at - s.t[near]
            way = ahead * s.v[:, near] + ahead**2 / 2 * s.a[:, near]
            y = e.manifold.go(s.y[:, near], way)
        v = CubicHermiteSpline(s.t, s.v, s.a, axis=1)(at)
        a, multiplier, work = (
            interp1d(s.t, part, axis=1)(at) for part in (s.a, s.multiplier, s.work)
        )
        return replace(motion, trajectory=Trajectory(at, y, v, a, multiplier, work))
