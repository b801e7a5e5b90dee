"""Pareto fronts of several aims."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.design.ecosystem.functions import DesignFunctions
from dalembert.design.limit import Limit
from dalembert.design.methods.base import Optimizer
from dalembert.design.methods.registry import make_optimizer
from dalembert.design.methods.search_options import additional_starts
from dalembert.design.pareto.front_search import FrontSearch
from dalembert.design.pareto.pareto_result import ParetoResult, make_front
from dalembert.design.quantity import Objective
from dalembert.design.variables import Vary
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.interrupts import interruptible
from dalembert.results.analysis import Analysis
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_arguments
from dalembert.text.wording import unknown

EVOLUTIONS = ("nsga2", "nsga3")
METHODS = ("normal-constraint", "epsilon-constraint", *EVOLUTIONS)


@check_arguments
@interruptible
def pareto(
    model: ParametricModel | None = None,
    minimize: Sequence[Objective] = (),
    *,
    maximize: Sequence[Objective] = (),
    subject_to: Sequence[Limit] = (),
    vary: Vary = None,
    analysis: Analysis | None = None,
    start: Mapping[str, float] | None = None,
    method: str = "normal-constraint",
    points: int = 15,
    local: str | Optimizer = "slsqp",
    starts: int = 1,
    gradient: Method = "auto",
    max_iterations: int = 100,
    tolerance: float = 1e-8,
    generations: int = 100,
    rng: int = 0,
    progress: Reported = False,
) -> ParetoResult:
    """Pareto front of several aims; Ctrl-C ends it with the points until then.

    Parameters
    ----------
    model, analysis : model and analysis; omitted if all responses belong to cases
    minimize, maximize : the aims, two or more in all
    subject_to, vary, start, gradient, max_iterations, tolerance : as in ``optimize``
    method : ``"normal-constraint"`` (evenly spread points by gradients, Messac et al. 2003),
        ``"epsilon-constraint"`` (bounds on all aims but the first, Haimes 1971), ``"nsga2"`` or
        ``"nsga3"`` of pymoo
    points : along each edge of the front; population of an evolution
    local : gradient method of each point
    starts : initial designs per point, the first from previous points; several find fronts that
        are disconnected or have several branches
    generations : of an evolution
    rng : seed of an evolution or of the starts
    progress : True for a bar, or a function of the fraction done

    Raises
    ------
    AnalysisError
        Fewer than two aims, or the starting design fails.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> rod = da.Structure("spring")
    >>> k = rod.parameter("k", 5.0, bounds=(1, 10))
    >>> end = rod.node("end", 0)
    >>> part = rod.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> rod.load(end, fx=20.0)
    >>> aims = [da.final("k"), da.final("end.ux")]
    >>> front = da.pareto(rod.build(), aims, analysis=da.Statics(), points=5)
    >>> (front.values[:, 0] * front.values[:, 1]).round(6)  # k · F/k, wherever on the front
    array([20., 20., 20., 20., 20.])
    """
    aims = [*minimize, *maximize]
    senses = [1.0] * len(minimize) + [-1.0] * len(maximize)
    if len(aims) < 2:
        raise AnalysisError("a front needs two aims or more: minimize=[...], maximize=[...]")
    if method not in METHODS:
        raise AnalysisError(unknown("method", method, METHODS))
    if points < 2:
        raise AnalysisError(f"points is {points}; give two or more")
    functions = DesignFunctions(
        model,
        aims,
        analysis=analysis,
        subject_to=subject_to,
        vary=vary,
        start=start,
        gradient=gradient,
    )
    if method in EVOLUTIONS:
        with progress_reporter(progress, method) as report:
            return _evolve(functions, senses, method, points, generations, rng, report)
    if functions.problem.variables.sizes:
        raise UnsupportedError(f"{method} takes no discrete variables; use method='nsga2'")
    variables = functions.problem.variables
    bounds = variables.lower, variables.upper
    start_designs = additional_starts(starts, variables.names, *bounds, rng)
    optimizer = make_optimizer(local, False)
    search = FrontSearch(functions, senses, optimizer, max_iterations, tolerance, start_designs)
    with progress_reporter(progress, "front") as report:
        return search.front(method, points, report)


def _evolve(
    functions: DesignFunctions,
    senses: Sequence[float],
    method: str,
    points: int,
    generations: int,
    rng: int,
    report: Callable[[float], None],
) -> ParetoResult:
    """NSGA-II (Deb et al. 2002) or NSGA-III (Deb & Jain 2014) of pymoo."""
    from dalembert.design.ecosystem.pymoo_problem import evolve

    designs, completed = evolve(functions, senses, method, points, generations, rng, report)
    snapped = np.array([functions.problem.variables.snapped(x) for x in designs])
    values = np.array([np.asarray(senses) * functions.values(x) for x in snapped])
    text = f"{method}: {completed} generations of {points}"
    text += "; interrupted" if completed < generations else ""
    front = make_front(functions, senses, values, snapped, text, [])
    front.interrupted = completed < generations
    return front
