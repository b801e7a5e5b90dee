"""Walking along the path of a load, from equilibrium to equilibrium by steps of its own choice."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dalembert.analysis.structural.balance import full_steps
from dalembert.analysis.structural.path_equations import Crossing, PathEquations
from dalembert.errors import AnalysisError, SingularityError
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.load_path import LoadPathResult, Plane
from dalembert.symbolic.equations.newton import solve

QUICK = 4
"""Iterations after which a step keeps its length."""
SHORTEST = 1e-6
"""Share of the first step below which a step is not halved any more."""
SHARPEST = 0.8
"""Cosine of the angle that the path may turn in a step."""
MARGIN = 1e-9
"""Part of a step at whose end the path is taken to be at its limit already."""


class Walk:
    """Points found one after the other.

    Parameters
    ----------
    analysis : strategy object with the fields of ``ArcLength``
    equations : of the path
    """

    def __init__(self, analysis: Any, equations: PathEquations):
        self.analysis, self.equations = analysis, equations
        self.points: list[np.ndarray] = []
        self.planes: list[Plane] = []
        self.limits: list[int] = []
        self.worst, self.iterations, self.effort = 0.0, 0, 0

    def follow(self, report: Callable[[float], None]) -> Status:
        """Points until the end of the path."""
        tools, equations = self.analysis, self.equations
        direction = equations.start()
        length = first = tools.first / direction[-1]
        self._keep(np.zeros(direction.size), self.level(0.0))
        while len(self.points) < tools.max_points:
            found = self._step(direction, length)
            if found is None or found[1] @ equations.metric(direction) < SHARPEST:
                length /= 2
                if length < SHORTEST * first:
                    return self.status(Outcome.NOT_CONVERGED, "no equilibrium found beyond")
                continue
            point, after, plane = found
            if direction[-1] * after[-1] < 0:
                self._keep_limit(direction, length)
            if (point[-1] - tools.until) * (self.points[-1][-1] - tools.until) <= 0:
                self.cross(self.level(tools.until), self.points[-1])
                return self.status(Outcome.COMPLETED, "load path to")
            self._keep(point, plane)
            report(len(self.points) / tools.max_points)
            if tools.stop is not None and tools.stop(self._last()):
                return self.status(Outcome.COMPLETED, "load path stopped at")
            direction = after
            growth = np.clip(np.sqrt(QUICK / max(self.effort, 1)), 0.5, 2.0)
            length = min(length * growth, tools.longest * first)
        short = f"max_points={tools.max_points} came before load factor {tools.until:g}; up to"
        return self.status(Outcome.COMPLETED, short)

    def _step(self, direction: np.ndarray, length: float):
        """Point, direction and plane at some length along the path; None where Newton fails."""
        origin = self.points[-1] + length * direction
        plane = Plane(origin, direction, self.equations.scale)
        point = self._newton(plane, origin)
        if point is None:
            return None
        try:
            return point, self.equations.direction(point, plane), plane
        except SingularityError:
            return None

    def _keep_limit(self, direction: np.ndarray, length: float) -> None:
        """The point within a step where the load factor is largest or smallest."""
        from scipy.optimize import brentq

        def rise(part: float) -> float:
            found = self._step(direction, part)
            if found is None:
                raise SingularityError("the path is lost near a limit point; take shorter steps")
            return float(found[1][-1])

        place = brentq(rise, MARGIN * length, length, xtol=1e-14 * length, rtol=1e-14)
        point, _, plane = self._step(direction, place) or (None, None, None)
        if point is not None and plane is not None:
            self.limits.append(len(self.points))
            self._keep(point, plane)

    def level(self, factor: float) -> Plane:
        """The plane of one load factor."""
        unit = np.eye(1, self.equations.size + 1, self.equations.size).ravel()
        return Plane(factor * unit, unit, self.equations.scale)

    def cross(self, plane: Plane, near: np.ndarray) -> None:
        """Keep the point where the path crosses a plane.

        Raises
        ------
        AnalysisError
            Newton's method does not find it.
        """
        point = self._newton(plane, near)
        if point is None:
            raise AnalysisError(
                f"no equilibrium found near load factor {near[-1]:.6g}; take shorter steps"
            )
        self._keep(point, plane)

    def _newton(self, plane: Plane, near: np.ndarray) -> np.ndarray | None:
        crossing = Crossing(self.equations, plane)
        solution = solve(crossing, near, full_steps(self.analysis))
        self.iterations += solution.iterations + 1
        if not solution.accepted:
            return None
        self.worst, self.effort = max(self.worst, solution.residual), solution.iterations + 1
        point = solution.x
        try:  # one more step from there: the gradient wants round-off
            return point + crossing.step(point, crossing.residual(point))
        except SingularityError:
            return None

    def _keep(self, point: np.ndarray, plane: Plane) -> None:
        self.points.append(point)
        self.planes.append(plane)

    def status(self, outcome: Outcome, text: str) -> Status:
        factor = float(self.points[-1][-1])
        return Status(outcome, f"{text} load factor {factor:.6g}", factor, self.worst)

    def _last(self) -> LoadPathResult:
        """The point found last, on its own."""
        alone = Walk(self.analysis, self.equations)
        alone._keep(self.points[-1], self.planes[-1])
        return alone.result(Status(Outcome.COMPLETED, "under way", 0.0, self.worst))

    def result(self, status: Status) -> LoadPathResult:
        """All points as one result."""
        e, count = self.equations, len(self.points)
        factors = np.array([point[-1] for point in self.points])
        u = np.stack([e.displaced(point) for point in self.points], axis=1)
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
