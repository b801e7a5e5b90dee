"""The best design whose limits hold with a given reliability.

Optimisation and reliability in turn (SORA, Du and Chen 2004): every limit is kept at the worst
point of its random parameters at the index that is wanted, where the last design put it; at the
new design the worst points are looked for again, until nothing moves. Each round begins where the
last one ended, with its design and its worst points. All gradients are exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

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
from dalembert.design.optimize.optimum import Optimum
from dalembert.design.reliability.distribution import Distribution
from dalembert.design.reliability.nataf import Correlation
from dalembert.design.reliability.reliable_optimum import ReliableLimit, ReliableOptimum, Round
from dalembert.design.reliability.reliable_task import ReliableTask, one_sided
from dalembert.design.variables import varied_names
from dalembert.errors import AnalysisError
from dalembert.interrupts import interruptible, searching
from dalembert.results.result import Analysis
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.spelling import spelled

SETTLED = 1e-5
"""Change of a design, of its size, and of a limit, of its own, that ends the rounds."""


@spelled
@interruptible
def optimize_reliable(
    model: ParametricModel,
    minimize: Any = None,
    *,
    subject_to: Sequence[Limit],
    random: Mapping[str, Distribution],
    analysis: Analysis,
    beta: float = 3.0,
    maximize: Any = None,
    vary: Sequence[Any] | None = None,
    correlation: Correlation = None,
    start: Mapping[str, float] | None = None,
    method: str | Optimizer = "slsqp",
    gradient: Method = "auto",
    max_iterations: int = 100,
    tolerance: float = 1e-8,
    rounds: int = 20,
    history: str | Path | None = None,
    progress: bool | OnIteration = False,
) -> ReliableOptimum:
    """Best parameters for which every limit holds with a probability ``Φ(β)``, to first order.

    Parameters
    ----------
    model, analysis : what is run
    minimize, maximize : the objective at the design itself
    subject_to : limits on responses, each of which must hold with this reliability
    random : parameter → distribution; where the parameter varies, its mean is the design
    beta : reliability index of each limit
    vary, start, method, gradient, max_iterations, tolerance, progress : as of ``optimize``
    correlation : pair of names → linear correlation, or the whole matrix
    rounds : of optimisation and reliability at most
    history : file in which evaluations are kept; the same call goes on from it after an interrupt

    Raises
    ------
    AnalysisError
        No limits or nothing random, or a run fails at the start.

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
    how = OptimizerSettings(method, gradient, Stop(max_iterations, tolerance), progress)
    walk = _Rounds(task, how, sign, objective, vary, dict(start or {}), history)
    try:
        with searching():
            walk.walk(max(rounds, 1))
    except KeyboardInterrupt:
        if walk.best is None:
            raise
        walk.stopped = True
    return walk.ended()


@dataclass
class _Rounds:
    """Optimisation and reliability in turn, and what they came to."""

    task: ReliableTask
    how: OptimizerSettings
    sign: float
    objective: Any
    vary: Sequence[Any] | None
    start: dict[str, float]
    history: str | Path | None
    best: Optimum | None = None
    found: list[ReliableLimit] = field(default_factory=list)
    told: list[Round] = field(default_factory=list)
    settled: bool = False
    stopped: bool = False
    sizes: np.ndarray | None = None

    def __post_init__(self) -> None:
        task = self.task
        self.points, self.log = task.means, None
        self.varied = varied_names(task.model.parameters, self.vary)
        if self.history is not None:
            wanted = [self.objective, *(limit.response for limit in task.limits)]
            problem = design_problem(task.model, task.analysis, wanted, self.vary, self.start)
            about = {"random": repr(dict(task.random)), "correlation": repr(task.correlation)}
            self.log = EvaluationLog(self.history, fingerprint(problem) | about)
            task.states.problem.log = self.log.part("reliability")

    def walk(self, rounds: int) -> None:
        """From round to round, until nothing moves."""
        at = dict[str, float]()
        for number in range(rounds):
            best = self._optimum()
            self.best = best if self.best is None else _after(self.best, best)
            if best.interrupted:
                self.stopped = True
                return
            moved = max((_change(best.x[n], at.get(n)) for n in best.x), default=0.0)
            self.points, self.found = self.task.worst(best, self.points)
            at = self.start = dict(best.x)
            margin = min(one.margin for one in self.found)
            self.told.append(Round(number, best.fun, best.x, margin, best.runs))
            self.settled = moved <= SETTLED and margin >= -SETTLED
            if self.settled:
                break
        assert self.best is not None
        self.found = self.task.with_indices(self.best, self.points, self.found)

    def _optimum(self) -> Optimum:
        """The best design for the limits at their worst points of the last one."""
        task, limits = self.task, self.task.at(self.points, self.varied)
        wanted = [self.objective, *(limit.response for limit in limits)]
        problem = design_problem(task.model, task.analysis, wanted, self.vary, self.start)
        if self.log is not None:
            problem.log = task.log_of(self.log, self.points)
        program = self.how.program(problem, limits, self.sign, self.sizes)
        self.sizes = program.sizes
        return self.how.best(program)

    def ended(self) -> ReliableOptimum:
        """What there is by now."""
        best = self.best
        assert best is not None
        if self.stopped:
            best = replace(best, success=False, interrupted=True, message="interrupted")
        limits = self.found or self.task.unknown()
        runs = self.task.states.problem.runs + best.runs
        return ReliableOptimum(
            best, self.task.beta, limits, self.told, self.settled, runs, self.stopped
        )


def _after(before: Optimum, best: Optimum) -> Optimum:
    """An optimum that goes on from another one, told from the very start."""
    return replace(
        best,
        initial=before.initial,
        history=[*before.history, *best.history[1:]],
        runs=before.runs + best.runs,
        gradients=before.gradients + best.gradients,
        failed_runs=before.failed_runs + best.failed_runs,
        variables=_begun(before.variables, best.variables),
        limits=_begun(before.limits, best.limits),
    )


def _begun(before: list[Bounded], now: list[Bounded]) -> list[Bounded]:
    return [replace(one, start=first.start) for first, one in zip(before, now, strict=True)]


def _change(new: float, old: float | None) -> float:
    return np.inf if old is None else abs(new - old) / (abs(new) or 1.0)
