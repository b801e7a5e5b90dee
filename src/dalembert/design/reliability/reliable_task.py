"""Limits that shall hold with a given index: at points of what is random, and their worst ones."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256

import numpy as np

from dalembert.design.case import Case
from dalembert.design.limit import Limit
from dalembert.design.optimize.evaluation_log import EvaluationLog, LogPart
from dalembert.design.optimize.optimum import Optimum
from dalembert.design.reliability.distribution import Distribution
from dalembert.design.reliability.first_order import Search
from dalembert.design.reliability.inverse_search import worst_point
from dalembert.design.reliability.limit_state import RunLimits, limit_states
from dalembert.design.reliability.moved import about, case_at
from dalembert.design.reliability.nataf import Correlation, Nataf
from dalembert.design.reliability.reliable_optimum import ReliableLimit
from dalembert.errors import AnalysisError
from dalembert.responses.base import Response
from dalembert.results.result import Analysis
from dalembert.symbolic.parametric_model import ParametricModel


def one_sided(limits: Sequence[Limit]) -> list[Limit]:
    """A limit for each side.

    Raises
    ------
    AnalysisError
        There is none, or one of a formula of several responses.
    """
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


Points = list[np.ndarray]
"""Of what is random, in standard normal variables, one for each limit."""


@dataclass
class ReliableTask:
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

    @property
    def means(self) -> Points:
        """Where the first design is looked for."""
        return [np.zeros(len(self.random))] * len(self.limits)

    def log_of(self, log: EvaluationLog, points: Points) -> LogPart:
        """The part of a history in which limits are kept at these points."""
        told = sha256(np.concatenate(points).tobytes()).hexdigest()[:16]
        return log.part(f"limits at {told}")

    def at(self, points: Points, varied: list[str]) -> list[Limit]:
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

    def worst(self, best: Optimum, points: Points) -> tuple[Points, list[ReliableLimit]]:
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

    def unknown(self) -> list[ReliableLimit]:
        """The limits where no worst point has been looked for."""
        nan, x = float("nan"), {name: one.moments[0] for name, one in self.random.items()}
        return [ReliableLimit(label, nan, nan, x) for label in self.states.labels]

    def with_indices(
        self, best: Optimum, points: Points, found: list[ReliableLimit]
    ) -> list[ReliableLimit]:
        """The limits with the index of each by a search of its own, where that finds one."""
        searches = self.searches(best)
        indices = [_index(s, u) for s, u in zip(searches, points, strict=True)]
        return [replace(one, beta=b) for one, b in zip(found, indices, strict=True)]


def _index(search: Search, start: np.ndarray) -> float | None:
    """``β`` of a limit; None where its design point is not found."""
    try:
        scale = abs(search.needed(np.zeros(search.nataf.size))) or 1.0
        point = search.solve(start, scale)
    except AnalysisError:
        return None
    return point.beta if point.converged else None
