"""The best design whose limits hold with a given reliability.

Optimisation and reliability in turn (SORA, Du and Chen 2004): every limit is kept at the worst
point of its random parameters at the index that is wanted, where the last design put it; at the
new design the worst points are looked for again, until nothing moves. All gradients are exact.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dalembert.design.case import Case
from dalembert.design.limit import Limit
from dalembert.design.methods.base import Optimizer
from dalembert.design.optimize.optimization import optimize
from dalembert.design.optimize.optimum import Optimum
from dalembert.design.reliability.distribution import Distribution
from dalembert.design.reliability.first_order import Search
from dalembert.design.reliability.inverse_search import worst_point
from dalembert.design.reliability.limit_state import RunLimits, limit_states
from dalembert.design.reliability.moved import about, case_at
from dalembert.design.reliability.nataf import Correlation, Nataf
from dalembert.design.reliability.reliable_optimum import ReliableLimit, ReliableOptimum, Round
from dalembert.design.telling import Told
from dalembert.design.variables import varied_names
from dalembert.errors import AnalysisError
from dalembert.responses.base import Response
from dalembert.results.result import Analysis
from dalembert.sensitivity.methods import Method
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text.spelling import spelled

SETTLED = 1e-5
"""Change of a design, of its size, and of a limit, of its own, that ends the rounds."""


@spelled
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
    progress: bool | Told = False,
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
    task = _Task(model, analysis, _one_sided(subject_to), random, correlation, beta)
    aim = {"minimize": minimize} if minimize is not None else {"maximize": maximize}
    varied, at = varied_names(model.parameters, vary), dict[str, float]()
    points, told = [np.zeros(len(random))] * len(task.limits), list[Round]()
    for number in range(max(rounds, 1)):
        best = optimize(
            model,
            **aim,
            subject_to=task.at(points, varied),
            vary=vary,
            analysis=analysis,
            start=start,
            method=method,
            gradient=gradient,
            max_iterations=max_iterations,
            tolerance=tolerance,
            progress=progress,
        )
        if best.interrupted:
            break
        moved = max((_change(best.x[n], at.get(n)) for n in best.x), default=0.0)
        points, found = task.worst(best, points)
        at = dict(best.x)
        margin = min(one.margin for one in found)
        told.append(Round(number, best.fun, best.x, margin, best.runs))
        if moved <= SETTLED and told[-1].margin >= -SETTLED:
            return task.ended(best, points, found, told)
    return task.ended(best, points, task.worst(best, points)[1], told, settled=False)


def _change(new: float, old: float | None) -> float:
    return np.inf if old is None else abs(new - old) / (abs(new) or 1.0)


def _one_sided(limits: Sequence[Limit]) -> list[Limit]:
    """A limit for each side."""
    made = []
    for limit in Limit.all_of(limits):
        if not isinstance(limit.response, Response):
            raise AnalysisError(
                f"{limit.response!r:.60}: limits with a reliability are those of one response"
            )
        if limit.lower is not None:
            made.append(replace(limit, upper=None))
        if limit.upper is not None:
            made.append(replace(limit, lower=None))
    if not made:
        raise AnalysisError("there is no limit to be reliable; give subject_to=[da.Limit(...)]")
    return made


@dataclass
class _Task:
    """Limits of one side each, with what is random."""

    model: ParametricModel
    analysis: Analysis
    limits: list[Limit]
    random: Mapping[str, Distribution]
    correlation: Correlation
    beta: float

    def __post_init__(self) -> None:
        self.base = Case(self.model, self.analysis)
        made = limit_states(self.model, self.limits, list(self.random), self.analysis)
        assert isinstance(made, RunLimits)
        self.states = made

    def at(self, points: list[np.ndarray], varied: list[str]) -> list[Limit]:
        """The limits at these points of the random parameters, about the design."""
        nataf, made = Nataf(self.random, self.correlation), []
        means = np.array([one.moments[0] for one in self.random.values()])
        for limit, label, u in zip(self.limits, self.states.labels, points, strict=True):
            x = nataf.values(u) if np.any(u) else means
            case = case_at(self.base, self.random, x, varied)
            made.append(replace(limit, response=case[replace(limit.response, name=label)]))
        return made

    def searches(self, best: Optimum) -> list[Search]:
        """Of every limit, with the random parameters about a design."""
        nataf = Nataf(about(self.random, best.x), self.correlation)
        self.states.rest = np.array(
            [best.x.get(n, self.model.parameters[n].value) for n in self.states.others]
        )
        return [Search(self.states, nataf, row) for row in range(len(self.limits))]

    def worst(
        self, best: Optimum, points: list[np.ndarray]
    ) -> tuple[list[np.ndarray], list[ReliableLimit]]:
        """The worst points at a design, and the limits there."""
        made, told = [], []
        for search, limit, u in zip(self.searches(best), self.limits, points, strict=True):
            there, g = worst_point(search, self.beta, u)
            bound = limit.lower if limit.lower is not None else limit.upper
            x = dict(zip(self.random, map(float, search.nataf.values(there)), strict=True))
            label = self.states.labels[search.row]
            told.append(ReliableLimit(label, g, g / (abs(bound or 0.0) or 1.0), x))
            made.append(there)
        return made, told

    def ended(
        self,
        best: Optimum,
        points: list[np.ndarray],
        found: list[ReliableLimit],
        rounds: list[Round],
        settled: bool = True,
    ) -> ReliableOptimum:
        """With the index of each limit by a search of its own, where that finds one."""
        searches = self.searches(best)
        indices = [_index(s, u) for s, u in zip(searches, points, strict=True)]
        limits = [replace(one, beta=b) for one, b in zip(found, indices, strict=True)]
        runs = self.states.calls + sum(one.runs for one in rounds)
        return ReliableOptimum(best, self.beta, limits, rounds, settled, runs)


def _index(search: Search, start: np.ndarray) -> float | None:
    """``β`` of a limit; None where its design point is not found."""
    try:
        scale = abs(search.needed(np.zeros(search.nataf.size))) or 1.0
        point = search.solve(start, scale)
    except AnalysisError:
        return None
    return point.beta if point.converged else None
