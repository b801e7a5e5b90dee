"""A design as a problem of pymoo, an extra."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from dalembert.design.ecosystem.functions import DesignFunctions
from dalembert.design.limit import Limit
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.interrupts import searching
from dalembert.results.result import Analysis
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.spelling import spelled

FAILED = 1e12
"""Objectives and violations of a design whose run fails."""


@spelled
def pymoo_problem(
    model: ParametricModel | None,
    minimize: Sequence[Any],
    *,
    analysis: Analysis | None = None,
    subject_to: Sequence[Limit] = (),
    vary: Sequence[Any] | None = None,
) -> Any:
    """A ``pymoo.core.problem.ElementwiseProblem`` of responses that are all to be small.

    Limits are measured in their bounds; equal ones are ``H``, others ``G``. Sizes of catalogues
    and whole numbers are the nearest ones. ``pip install dalembert[design]``.

    Parameters
    ----------
    model, analysis : what is run
    minimize : responses
    subject_to : limits
    vary : names, ``Integer``, ``Catalogue``; default all with bounds

    Raises
    ------
    UnsupportedError
        pymoo is not there.

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> rod = da.Structure("spring")
    >>> k = rod.parameter("k", 50.0, bounds=(1, 1e3))
    >>> end = rod.node("end", 0)
    >>> part = rod.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> rod.load(end, fx=100.0)
    >>> aims = [da.final("k"), da.final("end.ux")]
    >>> problem = da.pymoo_problem(rod.build(), aims, analysis=da.Statics())
    >>> problem.evaluate(np.array([[20.0]]), return_values_of=["F"])  # k, F/k
    array([[20.,  5.]])
    """
    functions = DesignFunctions(
        model, list(minimize), analysis=analysis, subject_to=subject_to, vary=vary
    )
    return problem_of(functions)


def problem_of(functions: DesignFunctions, senses: Sequence[float] | None = None) -> Any:
    """The same of functions that are there, −1 for those that are to be large."""
    try:
        from pymoo.core.problem import ElementwiseProblem
    except ImportError:
        raise UnsupportedError("pymoo is missing: pip install dalembert[design]") from None
    low, high = functions.bounds.T
    if not np.all(np.isfinite(functions.bounds)):
        name = functions.names[int(np.flatnonzero(~np.isfinite(low + high))[0])]
        raise AnalysisError(f"evolution needs two finite bounds of {name!r}; give them")
    sides, signs = _sides(functions.limits), np.ones(functions.count)
    if senses is not None:
        signs = np.asarray(senses, dtype=float)

    class Problem(ElementwiseProblem):
        """Responses of a design for pymoo."""

        def __init__(self) -> None:
            equations = sum(limit.is_equation for limit in functions.limits)
            super().__init__(
                n_var=len(functions.names),
                n_obj=functions.count,
                n_ieq_constr=len(sides),
                n_eq_constr=equations,
                xl=low,
                xu=high,
            )

        def _evaluate(self, x: np.ndarray, out: dict, *args: Any, **kwargs: Any) -> None:
            x = functions.problem.variables.snapped(x)
            values, limited = functions.values(x), functions.limited(x)
            equal = [
                (v - limit.lower) / max(abs(limit.lower), 1.0)
                for v, limit in zip(limited, functions.limits, strict=True)
                if limit.lower is not None and limit.is_equation
            ]
            values = np.where(np.isfinite(values), signs * values, FAILED)
            told = {"F": values, "G": [side(limited) for side in sides], "H": equal}
            for key, numbers in told.items():
                out[key] = np.nan_to_num(np.array(numbers), nan=FAILED, posinf=FAILED)

    return Problem()


def _sides(limits: Sequence[Limit]) -> list[Callable[[np.ndarray], float]]:
    """``g(limited) ≤ 0`` of every side of an inequality."""

    def side(k: int, bound: float, sign: float) -> Callable[[np.ndarray], float]:
        size = abs(bound) or 1.0
        return lambda v: sign * (v[k] - bound) / size if np.isfinite(v[k]) else FAILED

    return [
        side(k, bound, sign)
        for k, limit in enumerate(limits)
        for bound, sign in ((limit.lower, -1.0), (limit.upper, 1.0))
        if bound is not None and not limit.is_equation
    ]


def evolved(
    functions: DesignFunctions,
    senses: Sequence[float],
    method: str,
    points: int,
    generations: int,
    rng: int,
    report: Callable[[float], None] = lambda fraction: None,
) -> tuple[np.ndarray, int]:
    """(k, n) designs that an evolution ends with, and its generations; fewer by Ctrl-C.

    Raises
    ------
    AnalysisError
        No design keeps the limits.
    """
    problem = problem_of(functions, senses)
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.algorithms.moo.nsga3 import NSGA3
    from pymoo.util.ref_dirs import get_reference_directions

    algorithm: Any = NSGA2(pop_size=points)
    if method == "nsga3":
        even = functions.count == 2
        how = {"n_partitions": points - 1} if even else {"n_points": points, "seed": rng}
        kind = "das-dennis" if even else "energy"
        directions = get_reference_directions(kind, functions.count, **how)
        algorithm = NSGA3(directions)
    algorithm.setup(problem, termination=("n_gen", generations), seed=rng, verbose=False)
    made = 0
    try:
        with searching():
            while algorithm.has_next():
                algorithm.next()
                made += 1
                report(made / generations)
    except KeyboardInterrupt:
        if not made:
            raise
    found = algorithm.result().X
    if found is None:
        raise AnalysisError(f"{method}: no design keeps the limits after {made} generations")
    return np.atleast_2d(found), made
