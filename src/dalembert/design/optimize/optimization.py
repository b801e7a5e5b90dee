"""Optimisation: ``min f, g ≤ 0, bounds`` (8.41) with exact gradients, by the method of choice."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.design.case import Case
from dalembert.design.limit import Limit
from dalembert.design.methods.base import Ended, Optimizer, Stop
from dalembert.design.methods.registry import make_optimizer
from dalembert.design.optimize.evaluation_log import EvaluationLog
from dalembert.design.optimize.optimum import Optimum
from dalembert.design.optimize.outcome import judged
from dalembert.design.optimize.problem import DesignProblem, common_parameters
from dalembert.design.optimize.program import Program
from dalembert.design.optimize.settling import settled
from dalembert.design.quantity import Quantity, with_case
from dalembert.design.telling import OnIteration, iteration_callback
from dalembert.design.variables import make_variables
from dalembert.errors import AnalysisError, ModelError
from dalembert.interrupts import interruptible, searching
from dalembert.results.result import Analysis
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.spelling import spelled
from dalembert.text.wording import unknown


@spelled
def optimize(
    model: ParametricModel | None = None,
    minimize: Any = None,
    *,
    maximize: Any = None,
    subject_to: Sequence[Limit] = (),
    vary: Sequence[Any] | None = None,
    analysis: Analysis | None = None,
    start: Mapping[str, float] | None = None,
    method: str | Optimizer = "slsqp",
    gradient: Method = "auto",
    max_iterations: int = 100,
    tolerance: float = 1e-8,
    history: str | Path | None = None,
    progress: bool | OnIteration = False,
) -> Optimum:
    """Best parameters for responses of one analysis or several.

    Parameters
    ----------
    model, analysis : what is run, as ``Dynamics(...)``; not needed where all responses are those
        of cases, ``case[response]``
    minimize, maximize : the objective, one of them: a response, ``combined(...)``,
        ``SumOfSquares(...)``
    subject_to : limits on other responses
    vary : names of parameters, ``Integer``, ``Catalogue``; default all with bounds
    start : initial values; default the nominal ones
    method : ``"slsqp"``, ``"ipopt"``, … or an object such as ``Multistart(starts=50)``
    gradient : method of ``sensitivity``
    tolerance : on the relative change of the scaled objective
    history : file in which evaluations are kept; a search that was interrupted goes on from it
    progress : True prints each iteration, or a function of its number and objective
    max_iterations : of the method

    Raises
    ------
    AnalysisError
        The run fails at the starting design, or a name is unknown.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -9.81))
    >>> angle = system.parameter("angle", 0.4, "rad", bounds=(0.1, 1.5))
    >>> speed = 10 * da.cos(angle), 10 * da.sin(angle)
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=speed))
    >>> analysis = da.Dynamics(3.0, step=0.05, events={"lands": da.Event("stone.y", direction=-1)})
    >>> width = da.at_event("lands", "stone.x")
    >>> best = da.optimize(system.build(), maximize=width, analysis=analysis)
    >>> best.success, round(math.degrees(best.x["angle"]), 3), round(best.fun * 9.81, 3)  # v²/g
    (True, 45.0, 100.0)
    """
    limits = Limit.all_of(subject_to)
    sign, objective = aimed(minimize, maximize)
    wanted = [objective, *(limit.response for limit in limits)]
    problem = design_problem(model, analysis, wanted, vary, start)
    if history is not None:
        problem.log = EvaluationLog(history, fingerprint(problem)).part()
    how = Searched(method, gradient, Stop(max_iterations, tolerance), progress)
    return how.best(how.program(problem, limits, sign))


@dataclass(frozen=True)
class Searched:
    """How a design is searched for; as of ``optimize``."""

    method: str | Optimizer
    gradient: Method
    stop: Stop
    progress: bool | OnIteration

    def program(
        self,
        problem: DesignProblem,
        limits: list[Limit],
        sign: float,
        sizes: np.ndarray | None = None,
    ) -> Program:
        """The problem, whose first quantity is the objective, in scaled numbers."""
        problem.gradient = self.gradient
        self.optimizer(problem)
        start = problem.variables.start
        return Program(problem, limits, sign, start, iteration_callback(self.progress), sizes)

    def optimizer(self, problem: DesignProblem) -> Optimizer:
        """Its method."""
        return make_optimizer(self.method, bool(problem.variables.sizes))

    def best(self, program: Program) -> Optimum:
        """The optimum of a program."""
        return solve(program, self.optimizer(program.problem), self.stop)


def aimed(minimize: Any, maximize: Any) -> tuple[float, Any]:
    """1 or −1, and the objective.

    Raises
    ------
    AnalysisError
        Both or none.
    """
    if (minimize is None) == (maximize is None):
        raise AnalysisError("give one objective: minimize=... or maximize=...")
    return (1.0, minimize) if minimize is not None else (-1.0, maximize)


def design_problem(
    model: ParametricModel | None,
    analysis: Analysis | None,
    wanted: Sequence[Any],
    vary: Sequence[Any] | None,
    start: Mapping[str, float] | None = None,
) -> DesignProblem:
    """Quantities as functions of what varies.

    Raises
    ------
    AnalysisError
        Something that is no response, two with one label, or no analysis for a response.
    """
    if (model is None) != (analysis is None):
        raise AnalysisError("give model and analysis= together, or responses of cases alone")
    case = Case(model, analysis) if model is not None and analysis is not None else None
    quantities = [with_case(one, case) for one in wanted]
    _refuse_labels(quantities)
    owners = [t.case for q in quantities for t in q.terms]
    parameters = common_parameters([*([case] if case is not None else []), *owners])
    for name in start or {}:
        if name not in parameters:
            raise ModelError(unknown("parameter", name, parameters))
    variables = make_variables(parameters, vary, dict(start or {}))
    varied = variables.parameter_names
    return DesignProblem([quantity.varying(varied) for quantity in quantities], variables)


def _refuse_labels(quantities: Sequence[Quantity]) -> None:
    known: dict[str, Quantity] = {}
    for quantity in quantities:
        other = known.setdefault(quantity.label, quantity)
        if [(t.case, t.response) for t in other.terms] != [
            (t.case, t.response) for t in quantity.terms
        ]:
            raise AnalysisError(f"two responses are called {quantity.label!r}; name them")


def fingerprint(problem: DesignProblem) -> dict[str, Any]:
    """What tells one problem from another, for its history file."""
    return {
        "models": [case.model.name for case in problem.cases],
        "analyses": [repr(case.analysis)[:500] for case in problem.cases],
        "responses": [f"{r.label}: {r.measure}"[:200] for _, r in problem.terms],
        "vary": problem.variables.names,
        "parameters": [
            {n: v for n, v in zip(case.model.parameters, map(float, case.model.nominal))}  # noqa: B905, C416
            for case in problem.cases
        ],
    }


@interruptible
def solve(program: Program, method: Optimizer, stop: Stop) -> Optimum:
    """The optimum of a program; the best design so far where it is interrupted."""
    z, interrupted = program.scaled(program.origin), False
    try:
        with searching():
            ended = settled(program, method, stop, z)
    except KeyboardInterrupt:
        interrupted, number = True, len(program.history) - 1
        best = program.scaled(program.best[0])
        ended = Ended(best, False, f"interrupted after {number} iteration(s)")
    return judged(program, ended, interrupted)
