"""Load paths past limit points, by arc length (Riks 1979, Crisfield 1981).

A point of the path is an equilibrium ``∂W/∂u (u, p) = λ P`` with ``U_p`` in proportion, on a plane
across the direction of the path, so that the load may decrease as well as increase.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Unpack

import numpy as np

from dalembert.analysis.equilibrium.path_equations import PathEquations
from dalembert.analysis.equilibrium.path_following import PathFollower
from dalembert.analysis.keywords import ArcLengthKeywords
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.requirements import need_positive
from dalembert.analysis.times import analysis_of
from dalembert.errors import AnalysisError
from dalembert.model.assembled.model import StructuralModel
from dalembert.options import options
from dalembert.results.analysis import Analysis, ParameterValues
from dalembert.results.status import Outcome, Status
from dalembert.results.structural.load_path import LoadPathResult
from dalembert.text.arguments import check_arguments


@options
class ArcLength(Analysis[StructuralModel, LoadPathResult]):
    """Equilibria of one load case along its load path.

    Parameters
    ----------
    case : load case
    first : load factor of the first step
    longest : upper limit of a step, in lengths of the first step
    until : load factor at which the path ends, from either side
    stop : ``point → bool``, ends the path, e.g. ``lambda point: point["tip.uy"] < -1``
    max_points : upper limit of the number of points
    tolerance : residual relative to the largest force
    max_iterations : of Newton's method per step

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
    >>> len(path.limits), bool(path["top.uy"][-1] < -0.2)  # snapped through past the limit point
    (1, True)
    """

    display_name = "load path"
    kinds = ("structure",)
    instead = "use solve_equilibrium load by load"

    case: str = ""
    first: float = 0.1
    longest: float = 5.0
    until: float = 1.0
    stop: Callable[[LoadPathResult], bool] | None = None
    max_points: int = 200
    tolerance: float = 1e-10
    max_iterations: int = 15

    def __post_init__(self) -> None:
        need_positive(
            self, ("first", "longest", "until", "tolerance"), ("max_points", "max_iterations")
        )

    def run(
        self, model: StructuralModel, parameters: ParameterValues = None, progress: Any = False
    ) -> LoadPathResult:
        """Follow the path from rest; a failed run keeps its points.

        Raises
        ------
        AnalysisError
            An unknown load case, or one without effect; ``SingularityError`` where the
            structure is a mechanism before any load acts.
        """
        self.for_model(model)
        p = model.values(parameters)
        if self.case not in model.loads:
            known = ", ".join(repr(c) for c in model.loads)
            raise AnalysisError(f"no load case {self.case!r}; known: {known}")
        path = PathFollower(self, PathEquations(model, p, self.case))
        try:
            with progress_reporter(progress, f"following the load of {model.name}") as report:
                status = path.follow(report)
        except KeyboardInterrupt:
            if not path.points:
                raise
            status = path.status(Outcome.INTERRUPTED, "stopped at")
        return path.result(status)

    def replay(self, result: LoadPathResult, p: np.ndarray) -> LoadPathResult:
        """The intersections of the path with the same planes at other parameter values."""
        path = PathFollower(self, PathEquations(result.model, p, self.case))
        free = path.equations.free
        for k, plane in enumerate(result.planes):
            guess = np.append(result.displacements[free, k], result.load_factors[k])
            path.cross(plane, guess)
        return path.result(Status(Outcome.COMPLETED, "load path replayed", 0.0, path.worst))

    def at_load(self, result: LoadPathResult, factor: float) -> LoadPathResult:
        """The first equilibrium at a load factor.

        Raises
        ------
        AnalysisError
            The path does not reach it.
        """
        factors = result.load_factors
        beyond = np.flatnonzero((factors[:-1] - factor) * (factors[1:] - factor) <= 0)
        if not beyond.size:
            raise AnalysisError(
                f"the path has load factors from {factors.min():g} to {factors.max():g}, "
                f"not {factor:g}"
            )
        k, free = int(beyond[0]), result.model.assembly.free
        share = (factor - factors[k]) / (factors[k + 1] - factors[k] or 1.0)
        u = (1 - share) * result.displacements[free, k] + share * result.displacements[free, k + 1]
        path = PathFollower(self, PathEquations(result.model, result.parameters, self.case))
        path.cross(path.level(factor), np.append(u, factor))
        return path.result(result.status)


@check_arguments
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
    analysis = analysis_of(ArcLength, "solve_load_path", model, parameters, **options)
    return analysis.run(model, parameters)
