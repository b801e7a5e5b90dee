"""Reliability-based design optimisation.

Sequential optimisation and reliability assessment (SORA, Du and Chen 2004): every limit is
evaluated at the worst point of its random parameters at the required index, computed at the last
design; the worst points are recomputed at the new design, until both converge. Each round starts
from the design and the worst points of the last round. All gradients are exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from dalembert.design.limit import Bounded, Limit
from dalembert.design.methods.base import Optimizer, Stop
from dalembert.design.methods.search_options import OnIteration
from dalembert.design.optimize.evaluation_log import EvaluationLog
from dalembert.design.optimize.optimization import (
    OptimizerSettings,
    design_problem,
    fingerprint,
    signed_objective,
)
from dalembert.design.optimize.optimization_result import OptimizationResult
from dalembert.design.quantity import Objective
from dalembert.design.reliability.distribution import Distribution
from dalembert.design.reliability.nataf import Correlation
from dalembert.design.reliability.reliable_optimization_result import (
    ReliableLimit,
    ReliableOptimizationResult,
    Round,
)
from dalembert.design.reliability.reliable_task import ReliableTask, one_sided
from dalembert.design.variables import Vary, varied_names
from dalembert.errors import AnalysisError
from dalembert.interrupts import interruptible, searching
from dalembert.results.analysis import Analysis
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.arguments import check_arguments

CONVERGED = 1e-5
"""Threshold for convergence of the rounds: relative change of the design, margin of the limits."""


@check_arguments
@interruptible
def optimize_reliable(
    model: ParametricModel,
    minimize: Objective | None = None,
    *,
    subject_to: Sequence[Limit],
    random: Mapping[str, Distribution],
    analysis: Analysis,
    beta: float = 3.0,
    maximize: Objective | None = None,
    vary: Vary = None,
    correlation: Correlation = None,
    start: Mapping[str, float] | None = None,
    method: str | Optimizer = "slsqp",
    gradient: Method = "auto",
    max_iterations: int = 100,
    tolerance: float = 1e-8,
    rounds: int = 20,
    history: str | Path | None = None,
    progress: bool | OnIteration = False,
) -> ReliableOptimizationResult:
    """Optimal parameters for which every limit holds with probability ``Φ(β)``, to first order.

    Parameters
    ----------
    model, analysis : model and analysis of the runs
    minimize, maximize : the objective, evaluated at the design
    subject_to : limits on responses, each with the required reliability
    random : parameter → distribution; the mean of a design variable is its value at the design
    beta : required reliability index of each limit
    vary, start, method, gradient, max_iterations, tolerance, progress : as in ``optimize``
    correlation : pair of names → linear correlation, or the full matrix
    rounds : upper limit of rounds of optimisation and reliability assessment
    history : file that records evaluations; the same call resumes from it after an interrupt

    Raises
    ------
    AnalysisError
        There are no limits or no random parameters, or a run fails at the start.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> rod = da.Structure("rod")
    >>> load = rod.parameter("load", 1e5, "N")
    >>> area = rod.parameter("area", 1e-3, "m^2", bounds=(1e-4, 1e-2))
    >>> top, end = rod.node("top", 0), rod.node("end", 2)
    >>> part = rod.add(structures.Truss("rod", top, end, area=area, modulus=2e11, density=7850))
    >>> rod.support(top)
    >>> rod.load(end, fx=load)
    >>> strong = da.Limit(da.final("rod.stress"), upper=2e8)
    >>> random = {"load": da.Normal(1e5, 1e4)}
    >>> task = dict(subject_to=[strong], random=random, analysis=da.Statics(), beta=3)
    >>> best = da.optimize_reliable(rod.build(), da.final("mass"), **task)
    >>> round(best.x["area"] * 1e4, 6)  # (µ + 3 σ)/strength [cm²]
    6.5
    """
    if not (np.isfinite(beta) and beta > 0):
        raise AnalysisError(f"beta is {beta!r}; give an index above zero, such as 3")
    if not random:
        raise AnalysisError("nothing is random; give random={parameter: distribution}")
    sign, objective = signed_objective(minimize, maximize)
    task = ReliableTask(model, analysis, one_sided(subject_to), random, correlation, beta)
    search = OptimizerSettings(method, gradient, Stop(max_iterations, tolerance), progress)
    state = _Rounds(task, search, sign, objective, vary, dict(start or {}), history)
    try:
        with searching():
            state.iterate(max(rounds, 1))
    except KeyboardInterrupt:
        if state.best is None:
            raise
        state.stopped = True
    return state.result()


@dataclass
class _Rounds:
    """Alternating rounds of optimisation and reliability assessment, with their results."""

    task: ReliableTask
    search: OptimizerSettings
    sign: float
    objective: Objective
    vary: Vary
    start: dict[str, float]
    history: str | Path | None
    best: OptimizationResult | None = None
    limits: list[ReliableLimit] = field(default_factory=list)
    rounds: list[Round] = field(default_factory=list)
    converged: bool = False
    stopped: bool = False
    sizes: np.ndarray | None = None

    def __post_init__(self) -> None:
        task = self.task
        self.points, self.log = task.means, None
        self.varied = varied_names(task.model.parameters, self.vary)
        if self.history is not None:
            quantities = [self.objective, *(limit.response for limit in task.limits)]
            problem = design_problem(task.model, task.analysis, quantities, self.vary, self.start)
            problem_data = {
                "random": repr(dict(task.random)),
                "correlation": repr(task.correlation),
            }
            self.log = EvaluationLog(self.history, fingerprint(problem) | problem_data)
            task.states.problem.log = self.log.part("reliability")

    def iterate(self, rounds: int) -> None:
        """Alternate until the design and the worst points converge."""
        previous = dict[str, float]()
        for number in range(rounds):
            best = self._optimum()
            self.best = best if self.best is None else _continued(self.best, best)
            if best.interrupted:
                self.stopped = True
                return
            change = max((_change(best.x[n], previous.get(n)) for n in best.x), default=0.0)
            self.points, self.limits = self.task.worst(best, self.points)
            previous = self.start = dict(best.x)
            margin = min(limit.margin for limit in self.limits)
            self.rounds.append(Round(number, best.fun, best.x, margin, best.runs))
            self.converged = change <= CONVERGED and margin >= -CONVERGED
            if self.converged:
                break
        assert self.best is not None
        self.limits = self.task.with_indices(self.best, self.points, self.limits)

    def _optimum(self) -> OptimizationResult:
        """The optimum for limits at the worst points of the last design."""
        task, limits = self.task, self.task.at(self.points, self.varied)
        quantities = [self.objective, *(limit.response for limit in limits)]
        problem = design_problem(task.model, task.analysis, quantities, self.vary, self.start)
        if self.log is not None:
            problem.log = task.log_of(self.log, self.points)
        program = self.search.program(problem, limits, self.sign, self.sizes)
        self.sizes = program.sizes
        return self.search.best(program)

    def result(self) -> ReliableOptimizationResult:
        """The result of the completed rounds."""
        best = self.best
        assert best is not None
        if self.stopped:
            best = replace(best, success=False, interrupted=True, message="interrupted")
        limits = self.limits or self.task.unknown()
        runs = self.task.states.problem.runs + best.runs
        return ReliableOptimizationResult(
            best, self.task.beta, limits, self.rounds, self.converged, runs, self.stopped
        )


def _continued(before: OptimizationResult, best: OptimizationResult) -> OptimizationResult:
    """An optimum that continues another one, with the initial values and history of both."""
    return replace(
        best,
        initial=before.initial,
        history=[*before.history, *best.history[1:]],
        runs=before.runs + best.runs,
        gradients=before.gradients + best.gradients,
        failed_runs=before.failed_runs + best.failed_runs,
        variables=_with_initial_values(before.variables, best.variables),
        limits=_with_initial_values(before.limits, best.limits),
    )


def _with_initial_values(before: list[Bounded], after: list[Bounded]) -> list[Bounded]:
    return [
        replace(bound, start=initial.start) for initial, bound in zip(before, after, strict=True)
    ]


def _change(new: float, old: float | None) -> float:
    return np.inf if old is None else abs(new - old) / (abs(new) or 1.0)
