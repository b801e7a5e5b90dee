"""Path following by arc length, with control of the step length."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dalembert.analysis.equilibrium.path_equations import Crossing, PathEquations
from dalembert.analysis.equilibrium.static_equations import full_steps
from dalembert.errors import AnalysisError, SingularityError
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.load_path import LoadPathResult, Plane
from dalembert.symbolic.equations.newton import solve

QUICK = 4
"""Number of iterations for which the step length does not change."""
SHORTEST = 1e-6
"""Lower limit of a step, as a share of the first step."""
SHARPEST = 0.8
"""Lower limit of the cosine of the angle between directions of successive points."""
MARGIN = 1e-9
"""Start of the search for a limit point, as a share of the step."""


class PathFollower:
    """Points of the path, computed one after the other.

    Parameters
    ----------
    analysis : strategy object with the fields of ``ArcLength``
    equations : PathEquations
    """

    def __init__(self, analysis: Any, equations: PathEquations):
        self.analysis, self.equations = analysis, equations
        self.points: list[np.ndarray] = []
        self.planes: list[Plane] = []
        self.limits: list[int] = []
        self.worst, self.iterations, self.effort = 0.0, 0, 0

    def follow(self, report: Callable[[float], None]) -> Status:
        """Points until the end of the path."""
        settings, equations = self.analysis, self.equations
        direction = equations.start()
        length = first = settings.first / direction[-1]
        self._append(np.zeros(direction.size), self.level(0.0))
        while len(self.points) < settings.max_points:
            step = self._step(direction, length)
            if step is None or step[1] @ equations.metric(direction) < SHARPEST:
                length /= 2
                if length < SHORTEST * first:
                    return self.status(Outcome.NOT_CONVERGED, "no equilibrium found beyond")
                continue
            point, direction_ahead, plane = step
            if direction[-1] * direction_ahead[-1] < 0:
                self._append_limit(direction, length)
            if (point[-1] - settings.until) * (self.points[-1][-1] - settings.until) <= 0:
                self.cross(self.level(settings.until), self.points[-1])
                return self.status(Outcome.COMPLETED, "load path to")
            self._append(point, plane)
            report(len(self.points) / settings.max_points)
            if settings.stop is not None and settings.stop(self._last()):
                return self.status(Outcome.COMPLETED, "load path stopped at")
            direction = direction_ahead
            growth = np.clip(np.sqrt(QUICK / max(self.effort, 1)), 0.5, 2.0)
            length = min(length * growth, settings.longest * first)
        short = (
            f"max_points={settings.max_points} came before load factor {settings.until:g}; up to"
        )
        return self.status(Outcome.COMPLETED, short)

    def _step(self, direction: np.ndarray, length: float):
        """Point, direction and plane at a length along the path; None where Newton fails."""
        origin = self.points[-1] + length * direction
        plane = Plane(origin, direction, self.equations.scale)
        point = self._newton(plane, origin)
        if point is None:
            return None
        try:
            return point, self.equations.direction(point, plane), plane
        except SingularityError:
            return None

    def _append_limit(self, direction: np.ndarray, length: float) -> None:
        """Append the limit point within a step."""
        from scipy.optimize import brentq

        def rise(part: float) -> float:
            step = self._step(direction, part)
            if step is None:
                raise SingularityError("the path is lost near a limit point; take shorter steps")
            return float(step[1][-1])

        length_at_limit = brentq(rise, MARGIN * length, length, xtol=1e-14 * length, rtol=1e-14)
        point, _, plane = self._step(direction, length_at_limit) or (None, None, None)
        if point is not None and plane is not None:
            self.limits.append(len(self.points))
            self._append(point, plane)

    def level(self, factor: float) -> Plane:
        """The plane of one load factor."""
        unit = np.eye(1, self.equations.size + 1, self.equations.size).ravel()
        return Plane(factor * unit, unit, self.equations.scale)

    def cross(self, plane: Plane, guess: np.ndarray) -> None:
        """Append the point where the path crosses a plane.

        Raises
        ------
        AnalysisError
            Newton's method does not converge.
        """
        point = self._newton(plane, guess)
        if point is None:
            raise AnalysisError(
                f"no equilibrium found near load factor {guess[-1]:.6g}; take shorter steps"
            )
        self._append(point, plane)

    def _newton(self, plane: Plane, guess: np.ndarray) -> np.ndarray | None:
        crossing = Crossing(self.equations, plane)
        solution = solve(crossing, guess, full_steps(self.analysis))
        self.iterations += solution.iterations + 1
        if not solution.accepted:
            return None
        self.worst, self.effort = max(self.worst, solution.residual), solution.iterations + 1
        point = solution.x
        try:  # one more step: gradients need a residual at round-off
            return point + crossing.step(point, crossing.residual(point))
        except SingularityError:
            return None

    def _append(self, point: np.ndarray, plane: Plane) -> None:
        self.points.append(point)
        self.planes.append(plane)

    def status(self, outcome: Outcome, text: str) -> Status:
        factor = float(self.points[-1][-1])
        return Status(outcome, f"{text} load factor {factor:.6g}", factor, self.worst)

    def _last(self) -> LoadPathResult:
        """The last point as a result."""
        path = PathFollower(self.analysis, self.equations)
        path._append(self.points[-1], self.planes[-1])
        return path.result(Status(Outcome.COMPLETED, "under way", 0.0, self.worst))

    def result(self, status: Status) -> LoadPathResult:
        """All points as one result."""
        e, count = self.equations, len(self.points)
        factors = np.array([point[-1] for point in self.points])
        u = np.stack([e.displacements_at(point) for point in self.points], axis=1)
        forces = np.stack([e.forces(point) for point in self.points], axis=1)
        return LoadPathResult(
            e.model,
            self.analysis,
            e.p,
            [self.analysis.case] * count,
            u,
            forces,
            status,
            {"points": count, "iterations": self.iterations},
            [None] * count,
            load_factors=factors,
            planes=list(self.planes),
            negative=np.array([e.negative(point) for point in self.points]),
            limits=np.array([k for k in self.limits if k < count], dtype=int),
        )
