"""Load paths past limit points, by arc length (Riks 1979, Crisfield 1981).

A point of the path is an equilibrium ``∂W/∂u (u, p) = λ P`` with ``U_p`` growing alike, on a plane
across the direction of the path; so the load may fall as well as grow.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Unpack

import numpy as np

from dalembert.analysis.keywords import ArcLengthKeywords
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.served import need_structure
from dalembert.analysis.structural.balance import full_steps
from dalembert.analysis.structural.numbers import require
from dalembert.analysis.structural.path_equations import Crossing, PathEquations
from dalembert.analysis.times import analysis_of
from dalembert.errors import AnalysisError, SingularityError
from dalembert.options import options
from dalembert.results.result import Analysis, Given
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.load_path import LoadPathResult, Plane
from dalembert.structures.model import StructuralModel
from dalembert.symbolic.equations.newton import solve
from dalembert.text.spelling import spelled

QUICK = 4
"""Iterations after which a step keeps its length."""
SHORTEST = 1e-6
"""Share of the first step below which a step is not halved any more."""
SHARPEST = 0.8
"""Cosine of the angle that the path may turn in a step."""
MARGIN = 1e-9
"""Part of a step at whose end the path is taken to be at its limit already."""


@options
class ArcLength(Analysis[StructuralModel, LoadPathResult]):
    """Equilibria of one load case along the path of its load.

    Parameters
    ----------
    case : load case
    first : share of the load of the first step
    longest : of a step, in first steps
    until : load factor at which the path ends, from either side
    stop : ``point → bool``, ends the path, e.g. ``lambda point: point["tip.uy"] < -1``
    max_points : number of points at most
    tolerance : of the residual relative to the largest force
    max_iterations : of Newton's method in a step

    Raises
    ------
    UnsupportedError
        A number that is not positive.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> toggle = da.Structure("toggle")
    >>> left, top = toggle.node("left", -1, 0), toggle.node("top", 0, 0.2)
    >>> bar = toggle.add(structures.Truss("bar", left, top, area=1e-4, modulus=1e7))
    >>> toggle.support(left)
    >>> toggle.support(top, ux=0)
    >>> toggle.load(top, fy=-5)
    >>> fallen = da.ArcLength(stop=lambda point: point["top.uy"] < -0.2)
    >>> path = fallen.run(toggle.build())
    >>> len(path.limits), bool(path["top.uy"][-1] < -0.2)  # past the limit point it fell through
    (1, True)
    """

    spoken = "load path"

    case: str = ""
    first: float = 0.1
    longest: float = 5.0
    until: float = 1.0
    stop: Callable[[LoadPathResult], bool] | None = None
    max_points: int = 200
    tolerance: float = 1e-10
    max_iterations: int = 15

    def __post_init__(self) -> None:
        require(self, ("first", "longest", "until", "tolerance"), ("max_points", "max_iterations"))

    def run(
        self, model: StructuralModel, parameters: Given = None, progress: Any = False
    ) -> LoadPathResult:
        """Follow the path from rest; keeps the points it found.

        Raises
        ------
        AnalysisError
            An unknown load case, or one that moves nothing; ``SingularityError`` where the
            structure is a mechanism before any load acts.
        """
        p = model.values(parameters)
        if self.case not in model.loads:
            known = ", ".join(repr(c) for c in model.loads)
            raise AnalysisError(f"no load case {self.case!r}; known: {known}")
        walk = Walk(self, PathEquations(model, p, self.case))
        try:
            with progress_reporter(progress, f"following the load of {model.name}") as report:
                status = walk.follow(report)
        except KeyboardInterrupt:
            if not walk.points:
                raise
            status = walk.status(Outcome.INTERRUPTED, "stopped at")
        return walk.result(status)

    def replay(self, result: LoadPathResult, p: np.ndarray) -> LoadPathResult:
        """The same planes crossed at other parameter values."""
        walk = Walk(self, PathEquations(result.model, p, self.case))
        free = walk.equations.free
        for k, plane in enumerate(result.planes):
            near = np.append(result.displacements[free, k], result.load_factors[k])
            walk.cross(plane, near)
        return walk.result(Status(Outcome.COMPLETED, "load path replayed", 0.0, walk.worst))

    def at_load(self, result: LoadPathResult, factor: float) -> LoadPathResult:
        """The first equilibrium at a load factor.

        Raises
        ------
        AnalysisError
            The path does not get there.
        """
        found = result.load_factors
        beyond = np.flatnonzero((found[:-1] - factor) * (found[1:] - factor) <= 0)
        if not beyond.size:
            raise AnalysisError(
                f"the path has load factors from {found.min():g} to {found.max():g}, not {factor:g}"
            )
        k, free = int(beyond[0]), result.model.assembly.free
        share = (factor - found[k]) / (found[k + 1] - found[k] or 1.0)
        u = (1 - share) * result.displacements[free, k] + share * result.displacements[free, k + 1]
        walk = Walk(self, PathEquations(result.model, result.parameters, self.case))
        walk.cross(walk.level(factor), np.append(u, factor))
        return walk.result(result.status)


class Walk:
    """Points found one after the other."""

    def __init__(self, analysis: ArcLength, equations: PathEquations):
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
        return self.status(Outcome.COMPLETED, f"{tools.max_points} points, up to")

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


@spelled
def solve_load_path(
    model: StructuralModel,
    *,
    parameters: Mapping[str, float] | None = None,
    **options: Unpack[ArcLengthKeywords],
) -> LoadPathResult:
    """Equilibria along the path of a load, past limit points.

    Parameters
    ----------
    model : StructuralModel
    parameters : new values of parameters, without rebuilding
    **options : fields of ``ArcLength``: case, first, longest, until, stop, max_points, tolerance,
        max_iterations

    Raises
    ------
    AnalysisError
        Wrong options; ``SingularityError`` where the structure is a mechanism.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> toggle = da.Structure("toggle")
    >>> left, top = toggle.node("left", -1, 0), toggle.node("top", 0, 0.1)
    >>> bar = toggle.add(structures.Truss("bar", left, top, area=1e-4, modulus=1e7))
    >>> toggle.support(left)
    >>> toggle.support(top, ux=0)
    >>> toggle.load(top, fy=-1.0)
    >>> path = da.solve_load_path(toggle.build())
    >>> limit = path.load_factors[path.limits[0]]
    >>> round(float(limit) * 27**0.5 / (1e3 * 0.1**3), 2)  # of E A h³/(√27 l³), if shallow
    0.99
    """
    made = analysis_of(ArcLength, "solve_load_path", model, parameters, **options)
    need_structure(model, "solve_load_path", "take solve_equilibrium load by load")
    return made.run(model, parameters)
