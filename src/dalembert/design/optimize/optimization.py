"""Optimisation ``min f, g ≤ 0, bounds`` (8.41) with exact gradients and a choice of methods."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from dalembert.design.case import Case
from dalembert.design.limit import Limit
from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.methods.registry import make_optimizer
from dalembert.design.methods.search_options import OnIteration, iteration_callback
from dalembert.design.optimize.evaluation_log import EvaluationLog
from dalembert.design.optimize.optimality import solve_to_stationarity
from dalembert.design.optimize.optimization_result import OptimizationResult
from dalembert.design.optimize.problem import DesignProblem, common_parameters
from dalembert.design.optimize.program import Program
from dalembert.design.optimize.verified_optimum import verified_optimum
from dalembert.design.quantity import Objective, Quantity, with_case
from dalembert.design.variables import Vary, make_variables
from dalembert.errors import AnalysisError, ModelError
from dalembert.interrupts import interruptible, searching
from dalembert.results.analysis import Analysis
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_arguments
from dalembert.text.wording import counted, unknown


@check_arguments
def optimize(
    model: ParametricModel | None = None,
    minimize: Objective | None = None,
    *,
    maximize: Objective | None = None,
    subject_to: Sequence[Limit] = (),
    vary: Vary = None,
    analysis: Analysis | None = None,
    start: Mapping[str, float] | None = None,
    method: str | Optimizer = "slsqp",
    gradient: Method = "auto",
    max_iterations: int = 100,
    tolerance: float = 1e-8,
    history: str | Path | None = None,
    progress: bool | OnIteration = False,
) -> OptimizationResult:
    """Optimise parameters for responses of one analysis or several.

    Parameters
    ----------
    model, analysis : model and its analysis, such as ``Dynamics(...)``; omitted if all responses
        belong to cases, ``case[response]``
    minimize, maximize : the objective, one of the two: a response, ``combined(...)``,
        ``SumOfSquares(...)``
    subject_to : limits on other responses
    vary : names of parameters, ``Integer``, ``Catalogue``; default all with bounds
    start : initial values; default nominal
    method : ``"slsqp"``, ``"ipopt"``, … or an object such as ``Multistart(starts=50)``
    gradient : method of ``sensitivity``
    tolerance : on the relative change of the scaled objective
    history : file in which evaluations are logged; an interrupted search resumes from it
    progress : True to print each iteration, or a function of its number and objective
    max_iterations : upper limit of the iterations of the method

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
    sign, objective = signed_objective(minimize, maximize)
    responses = [objective, *(limit.response for limit in limits)]
    problem = design_problem(model, analysis, responses, vary, start)
    if history is not None:
        problem.log = EvaluationLog(history, fingerprint(problem)).part()
    settings = OptimizerSettings(method, gradient, Stop(max_iterations, tolerance), progress)
    return settings.best(settings.program(problem, limits, sign))


@dataclass(frozen=True)
class OptimizerSettings:
    """Method, gradient, stopping criteria and progress of ``optimize``."""

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
        """Scaled program of a problem whose first quantity is the objective."""
        problem.gradient = self.gradient
        self.optimizer(problem)
        start = problem.variables.start
        return Program(problem, limits, sign, start, iteration_callback(self.progress), sizes)

    def optimizer(self, problem: DesignProblem) -> Optimizer:
        """Optimiser for a problem."""
        return make_optimizer(self.method, bool(problem.variables.sizes))

    def best(self, program: Program) -> OptimizationResult:
        """Solve a program."""
        return solve(program, self.optimizer(program.problem), self.stop)


def signed_objective(
    minimize: Objective | None, maximize: Objective | None
) -> tuple[float, Objective]:
    """Sign (1 to minimise, −1 to maximise) and objective.

    Raises
    ------
    AnalysisError
        Both or none are set.
    """
    if minimize is not None and maximize is None:
        return 1.0, minimize
    if maximize is not None and minimize is None:
        return -1.0, maximize
    raise AnalysisError("give one objective: minimize=... or maximize=...")


def design_problem(
    model: ParametricModel | None,
    analysis: Analysis | None,
    responses: Sequence[Objective],
    vary: Vary,
    start: Mapping[str, float] | None = None,
) -> DesignProblem:
    """Design problem: quantities as functions of the variables.

    Raises
    ------
    AnalysisError
        An entry is no response, two have one label, or a response has no analysis.
    """
    if (model is None) != (analysis is None):
        raise AnalysisError("give model and analysis= together, or responses of cases alone")
    case = Case(model, analysis) if model is not None and analysis is not None else None
    quantities = [with_case(response, case) for response in responses]
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
    labelled: dict[str, Quantity] = {}
    for quantity in quantities:
        other = labelled.setdefault(quantity.label, quantity)
        if [(t.case, t.response) for t in other.terms] != [
            (t.case, t.response) for t in quantity.terms
        ]:
            raise AnalysisError(f"two responses are called {quantity.label!r}; name them")


def fingerprint(problem: DesignProblem) -> dict[str, Any]:
    """Identification of a problem for its history file."""
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
def solve(program: Program, method: Optimizer, stop: Stop) -> OptimizationResult:
    """Solve a program; Ctrl-C ends with the best design so far."""
    z, interrupted = program.scaled(program.origin), False
    try:
        with searching():
            outcome = solve_to_stationarity(program, method, stop, z)
    except KeyboardInterrupt:
        interrupted, iterations = True, len(program.history) - 1
        best = program.scaled(program.best[0])
        outcome = OptimizerResult(
            best, False, f"interrupted after {counted(iterations, 'iteration')}"
        )
    return verified_optimum(program, outcome, interrupted)
