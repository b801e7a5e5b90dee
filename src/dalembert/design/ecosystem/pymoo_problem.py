"""Problem of pymoo, an optional package, and its evolutionary algorithms."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from dalembert.design.ecosystem.functions import DesignFunctions
from dalembert.design.limit import Limit
from dalembert.design.quantity import Objective
from dalembert.design.variables import Vary
from dalembert.errors import AnalysisError
from dalembert.interrupts import searching
from dalembert.packages import optional_package
from dalembert.results.analysis import Analysis
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_arguments

PENALTY = 1e12
"""Objective and violation of a design whose run fails."""


@check_arguments
def pymoo_problem(
    model: ParametricModel | None,
    minimize: Sequence[Objective],
    *,
    analysis: Analysis | None = None,
    subject_to: Sequence[Limit] = (),
    vary: Vary = None,
) -> Any:
    """``pymoo.core.problem.ElementwiseProblem`` that minimises all responses.

    Limits are scaled by their bounds: equations are ``H``, inequalities ``G``. Discrete variables
    are rounded to the nearest size. ``pip install dalembert[design]``.

    Parameters
    ----------
    model, analysis : model and analysis
    minimize : responses
    subject_to : limits
    vary : names, ``Integer``, ``Catalogue``; default all with bounds

    Raises
    ------
    UnsupportedError
        pymoo is not installed.

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
    return make_problem(functions)


def make_problem(functions: DesignFunctions, senses: Sequence[float] | None = None) -> Any:
    """Problem of design functions; senses are 1 to minimise and −1 to maximise."""
    problem = optional_package("pymoo.core.problem", "an evolutionary search")
    low, high = functions.bounds.T
    if not np.all(np.isfinite(functions.bounds)):
        name = functions.names[int(np.flatnonzero(~np.isfinite(low + high))[0])]
        raise AnalysisError(f"evolution needs two finite bounds of {name!r}; give them")
    inequalities, signs = _inequalities(functions.limits), np.ones(functions.count)
    if senses is not None:
        signs = np.asarray(senses, dtype=float)

    class Problem(problem.ElementwiseProblem):  # type: ignore[misc, name-defined]
        """Responses of a design for pymoo."""

        def __init__(self) -> None:
            equations = sum(limit.is_equation for limit in functions.limits)
            super().__init__(
                n_var=len(functions.names),
                n_obj=functions.count,
                n_ieq_constr=len(inequalities),
                n_eq_constr=equations,
                xl=low,
                xu=high,
            )

        def _evaluate(self, x: np.ndarray, out: dict, *args: Any, **kwargs: Any) -> None:
            x = functions.problem.variables.snapped(x)
            values, limited = functions.values(x), functions.limited(x)
            equalities = [
                (v - limit.lower) / max(abs(limit.lower), 1.0)
                for v, limit in zip(limited, functions.limits, strict=True)
                if limit.lower is not None and limit.is_equation
            ]
            values = np.where(np.isfinite(values), signs * values, PENALTY)
            outputs = {"F": values, "G": [side(limited) for side in inequalities], "H": equalities}
            for key, numbers in outputs.items():
                out[key] = np.nan_to_num(np.array(numbers), nan=PENALTY, posinf=PENALTY)

    return Problem()


def _inequalities(limits: Sequence[Limit]) -> list[Callable[[np.ndarray], float]]:
    """``g(values) ≤ 0`` for every bound of an inequality."""

    def side(k: int, bound: float, sign: float) -> Callable[[np.ndarray], float]:
        size = abs(bound) or 1.0
        return lambda v: sign * (v[k] - bound) / size if np.isfinite(v[k]) else PENALTY

    return [
        side(k, bound, sign)
        for k, limit in enumerate(limits)
        for bound, sign in ((limit.lower, -1.0), (limit.upper, 1.0))
        if bound is not None and not limit.is_equation
    ]


def evolve(
    functions: DesignFunctions,
    senses: Sequence[float],
    method: str,
    points: int,
    generations: int,
    rng: int,
    report: Callable[[float], None] = lambda fraction: None,
) -> tuple[np.ndarray, int]:
    """Final designs (k, n) of an evolution and its generations, fewer after Ctrl-C.

    Raises
    ------
    AnalysisError
        No design satisfies the limits.
    """
    problem = make_problem(functions, senses)
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.algorithms.moo.nsga3 import NSGA3
    from pymoo.util.ref_dirs import get_reference_directions

    algorithm: Any = NSGA2(pop_size=points)
    if method == "nsga3":
        has_two_aims = functions.count == 2
        options = (
            {"n_partitions": points - 1} if has_two_aims else {"n_points": points, "seed": rng}
        )
        kind = "das-dennis" if has_two_aims else "energy"
        directions = get_reference_directions(kind, functions.count, **options)
        algorithm = NSGA3(directions)
    algorithm.setup(problem, termination=("n_gen", generations), seed=rng, verbose=False)
    completed = 0
    try:
        with searching():
            while algorithm.has_next():
                algorithm.next()
                completed += 1
                report(completed / generations)
    except KeyboardInterrupt:
        if not completed:
            raise
    designs = algorithm.result().X
    if designs is None:
        raise AnalysisError(
            f"{method}: no design satisfies the limits after {completed} generations"
        )
    return np.atleast_2d(designs), completed
