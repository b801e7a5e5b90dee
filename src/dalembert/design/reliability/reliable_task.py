"""Limits with a required reliability index, and their worst points.

The worst point of a limit state at an index ``β``, ``min G(u)`` on ``|u| = β``, is computed by the
iteration of Wu, Millwater and Cruse (1990), ``u = −β ∇G/|∇G|``, with steps along the sphere that
are halved until ``G`` decreases.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from hashlib import sha256

import numpy as np

from dalembert.design.case import Case
from dalembert.design.limit import Limit
from dalembert.design.optimize.evaluation_log import EvaluationLog, LogPart
from dalembert.design.optimize.optimization_result import OptimizationResult
from dalembert.design.reliability.distribution import Distribution
from dalembert.design.reliability.first_order import Search
from dalembert.design.reliability.limit_state import RunLimits, limit_states
from dalembert.design.reliability.nataf import Correlation, Nataf
from dalembert.design.reliability.reliable_optimization_result import ReliableLimit
from dalembert.design.reliability.shifted import case_at, centred_at
from dalembert.errors import AnalysisError
from dalembert.responses.base import Response
from dalembert.results.analysis import Analysis
from dalembert.symbolic.parametric_model import ParametricModel

MAX_HALVINGS = 30
"""Upper limit of halved steps of the search for a worst point."""


def one_sided(limits: Sequence[Limit]) -> list[Limit]:
    """Split limits into one-sided limits.

    Raises
    ------
    AnalysisError
        There are no limits, or a limit is on a formula of several responses.
    """
    sides = []
    for limit in Limit.all_of(limits):
        if not isinstance(limit.response, Response):
            raise AnalysisError(
                f"{limit.response!r:.60}: limits with a reliability are limits of a single response"
            )
        if limit.lower is not None:
            sides.append(replace(limit, upper=None))
        if limit.upper is not None:
            sides.append(replace(limit, lower=None))
    if not sides:
        raise AnalysisError("there is no limit to be reliable; give subject_to=[da.Limit(...)]")
    return sides


Points = list[np.ndarray]
"""Values of the random parameters for each limit, as standard normal variables."""


@dataclass
class ReliableTask:
    """One-sided limits with random parameters and a required reliability index."""

    model: ParametricModel
    analysis: Analysis
    limits: list[Limit]
    random: Mapping[str, Distribution]
    correlation: Correlation
    beta: float

    def __post_init__(self) -> None:
        self.base = Case(self.model, self.analysis)
        states = limit_states(self.model, self.limits, list(self.random), self.analysis)
        assert isinstance(states, RunLimits)
        self.states = states

    @property
    def means(self) -> Points:
        """Points of the first optimisation: the means."""
        return [np.zeros(len(self.random))] * len(self.limits)

    def log_of(self, log: EvaluationLog, points: Points) -> LogPart:
        """The part of the evaluation log for limits at these points."""
        digest = sha256(np.concatenate(points).tobytes()).hexdigest()[:16]
        return log.part(f"limits at {digest}")

    def at(self, points: Points, varied: list[str]) -> list[Limit]:
        """The limits at these points of the random parameters, relative to the design."""
        nataf, limits = Nataf(self.random, self.correlation), []
        means = np.array([distribution.moments[0] for distribution in self.random.values()])
        for limit, label, u in zip(self.limits, self.states.labels, points, strict=True):
            x = nataf.values(u) if np.any(u) else means
            case = case_at(self.base, self.random, x, varied)
            limits.append(replace(limit, response=case[replace(limit.response, name=label)]))
        return limits

    def searches(self, best: OptimizationResult) -> list[Search]:
        """Search of every limit, with the random parameters centred at a design."""
        nataf = Nataf(centred_at(self.random, best.x), self.correlation)
        self.states.other_values = np.array(
            [best.x.get(n, self.model.parameters[n].value) for n in self.states.others]
        )
        return [Search(self.states, nataf, row) for row in range(len(self.limits))]

    def worst(self, best: OptimizationResult, points: Points) -> tuple[Points, list[ReliableLimit]]:
        """The worst points at a design, and the values of the limits there."""
        worst_points, limits = [], []
        for search, limit, u in zip(self.searches(best), self.limits, points, strict=True):
            u_worst, g = worst_point(search, self.beta, u)
            bound = limit.lower if limit.lower is not None else limit.upper
            x = dict(zip(self.random, map(float, search.nataf.values(u_worst)), strict=True))
            label = self.states.labels[search.row]
            limits.append(ReliableLimit(label, g, g / (abs(bound or 0.0) or 1.0), x))
            worst_points.append(u_worst)
        return worst_points, limits

    def unknown(self) -> list[ReliableLimit]:
        """The limits without worst points, before the first round is complete."""
        nan, x = (
            float("nan"),
            {name: distribution.moments[0] for name, distribution in self.random.items()},
        )
        return [ReliableLimit(label, nan, nan, x) for label in self.states.labels]

    def with_indices(
        self, best: OptimizationResult, points: Points, limits: list[ReliableLimit]
    ) -> list[ReliableLimit]:
        """The limits with their reliability indices, by a search for each design point."""
        searches = self.searches(best)
        indices = [_index(s, u) for s, u in zip(searches, points, strict=True)]
        return [replace(limit, beta=b) for limit, b in zip(limits, indices, strict=True)]


def _index(search: Search, start: np.ndarray) -> float | None:
    """``β`` of a limit; None if its search does not converge."""
    try:
        scale = abs(search.finite_value(np.zeros(search.nataf.size))) or 1.0
        point = search.solve(start, scale)
    except AnalysisError:
        return None
    return point.beta if point.converged else None


def worst_point(search: Search, beta: float, start: np.ndarray) -> tuple[np.ndarray, float]:
    """The worst point at an index, and ``G`` there.

    Raises
    ------
    AnalysisError
        A run fails.
    """
    u = start if np.linalg.norm(start) else np.zeros(search.nataf.size)
    g = search.finite_value(u)
    for _ in range(search.max_iterations):
        slope = search.slope(u)[0]
        size = float(np.linalg.norm(slope))
        if not size > 0:  # independent of the random parameters
            return u, g
        target = -beta * slope / size
        if np.linalg.norm(target - u) <= search.tolerance**0.5 * beta:
            return target, search.finite_value(target)
        following, value = _backtrack(search, u, g, target, beta)
        if value >= g - search.tolerance * abs(g) and np.linalg.norm(u) > 0:
            return (following, value) if value < g else (u, g)
        u, g = following, value
    return u, g


def _backtrack(
    search: Search, u: np.ndarray, g: float, target: np.ndarray, beta: float
) -> tuple[np.ndarray, float]:
    """First of the halved steps along the sphere towards ``target`` that decreases ``G``."""
    if not np.linalg.norm(u):
        return target, search.finite_value(target)
    fraction = 1.0
    for _ in range(MAX_HALVINGS):
        chord_point = u + fraction * (target - u)
        size = float(np.linalg.norm(chord_point))
        if size > 1e-12:
            trial = beta * chord_point / size
            value = search.value(trial)
            if np.isfinite(value) and value < g:
                return trial, value
        fraction /= 2
    return u, g
