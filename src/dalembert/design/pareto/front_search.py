"""Gradient-based search of a Pareto front: one scalar problem per point."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from dalembert.design.ecosystem.functions import DesignFunctions
from dalembert.design.limit import Limit
from dalembert.design.methods.base import Optimizer, Stop
from dalembert.design.optimize.optimality import OPTIMAL, multipliers, solve_to_stationarity
from dalembert.design.optimize.program import FEASIBLE, Program
from dalembert.design.optimize.verified_optimum import violated_limits
from dalembert.design.pareto.pareto_result import ParetoResult, distinct, make_front, nondominated
from dalembert.design.quantity import CaseResponse, Quantity, split_terms
from dalembert.errors import AnalysisError
from dalembert.interrupts import searching

STEEP = 1e-3
"""Threshold of the slope over the range of a variable, relative to the range of an aim [-]."""
ROUGH = Stop(30, 1e-6)
"""Stopping criteria of additional starts; the search continues from the best of them."""
FLAT = 1e-6
"""Threshold below which a slope counts as zero, relative to the largest slope [-]."""


class Weighted(Quantity):
    """``Σ w_k q_k``.

    Parameters
    ----------
    parts : quantities
    weights : one for each part
    label : name
    """

    def __init__(
        self, parts: Sequence[Quantity], weights: Sequence[float] | np.ndarray, label: str
    ):
        self.parts, self.weights, self.label = list(parts), np.asarray(weights), label

    @property
    def terms(self) -> list[CaseResponse]:
        return [term for part in self.parts for term in part.terms]

    def varying(self, names: Sequence[str]) -> Weighted:
        return Weighted([part.varying(names) for part in self.parts], self.weights, self.label)

    def _split(self, values: np.ndarray) -> list[np.ndarray]:
        return split_terms(self.parts, values)

    def value(self, values: np.ndarray) -> float:
        split = zip(self.weights, self.parts, self._split(values), strict=True)
        return float(sum(w * part.value(v) for w, part, v in split))

    def slope(self, values: np.ndarray) -> np.ndarray:
        split = zip(self.weights, self.parts, self._split(values), strict=True)
        return np.concatenate([w * part.slope(v) for w, part, v in split])


class FrontSearch:
    """Scalar problems, one per point, each started from the previous point."""

    def __init__(
        self,
        functions: DesignFunctions,
        senses: Sequence[float],
        local: Optimizer,
        max_iterations: int,
        tolerance: float,
        starts: Sequence[np.ndarray] = (),
    ):
        """``starts`` are additional initial designs of each problem."""
        self.starts = list(starts)
        self.functions, self.senses, self.local = functions, np.array(senses), local
        self.stop = Stop(max_iterations, tolerance)
        self.aims = functions.problem.quantities[: functions.count]
        self.constraints = functions.problem.quantities[functions.count :]
        self.solutions: list[np.ndarray] = []
        self.failures: list[str] = []

    def solve(
        self, goal: Quantity, limits: Sequence[Limit], x: np.ndarray, *starts: np.ndarray
    ) -> np.ndarray | None:
        """Optimal design within further limits on aims, from several starts; None if all fail."""
        best = self._solve_from(goal, limits, x)
        attempts = [self._solve_roughly(goal, limits, start) for start in starts]
        candidates = [attempt for attempt in attempts if attempt is not None]
        if candidates:
            value, start = min(candidates, key=lambda candidate: candidate[0])
            if isinstance(best, str) or value < best[0]:
                further = self._solve_from(goal, limits, start)
                best = best if isinstance(further, str) else further
        if isinstance(best, str):
            self.failures.append(best)
            return None
        self.solutions.append(best[1])
        return best[1]

    def _program(self, goal: Quantity, limits: Sequence[Limit], x: np.ndarray) -> Program:
        quantities = [goal, *self.constraints, *(limit.response for limit in limits)]
        problem = self.functions.problem.with_quantities(quantities)
        return Program(problem, [*self.functions.limits, *limits], 1.0, x)

    def _solve_roughly(
        self, goal: Quantity, limits: Sequence[Limit], x: np.ndarray
    ) -> tuple[float, np.ndarray] | None:
        """Objective and design of a short search from a start; None if infeasible or failing."""
        try:
            program = self._program(goal, limits, x)
        except AnalysisError:  # the start fails
            return None
        x = program.unscale(self.local.solve(program, program.scaled(x), ROUGH).z)
        evaluation = program.problem.evaluate(x, gradient=False)
        if evaluation is None or program.violation(evaluation.values) > FEASIBLE:
            return None
        return float(evaluation.values[0]), x

    def _solve_from(
        self, goal: Quantity, limits: Sequence[Limit], x: np.ndarray
    ) -> tuple[float, np.ndarray] | str:
        """Optimal objective and design from a start, or the reason of failure."""
        program = self._program(goal, limits, x)
        outcome = solve_to_stationarity(program, self.local, self.stop, program.scaled(x))
        x = program.unscale(outcome.z)
        z = program.scaled(x)
        program.restore_scale()
        point, evaluation = program.point(z, record=False), program.problem.evaluate(x)
        if point is None or evaluation is None:
            return "the run fails at the final design"
        violation = program.violation(evaluation.values)
        stationarity = multipliers(program, z, point).stationarity
        if violation > FEASIBLE:
            return f"limits are violated: {violated_limits(program, evaluation.values)}"
        if stationarity > OPTIMAL:
            return (
                f"the relative residual of the gradient is {stationarity:.2g} ({outcome.message})"
            )
        return float(evaluation.values[0]), x

    def aim(self, row: int) -> Quantity:
        """One aim, to be minimised."""
        return Weighted([self.aims[row]], [self.senses[row]], self.aims[row].label)

    def values(self, x: np.ndarray) -> np.ndarray:
        """(aims,) values, all to be minimised."""
        return self.senses * self.functions.values(x)

    def front(self, method: str, points: int, report: Callable[[float], None]) -> ParetoResult:
        """Search the front; Ctrl-C ends with the points until then.

        Raises
        ------
        AnalysisError
            One of the aims has no optimum.
        """
        try:
            with searching():
                note = self._search(method, points, report)
            return self.result(method, note)
        except KeyboardInterrupt:
            if not self.solutions:
                raise
            count = len(self.solutions)
            done = f"{count} search{'' if count == 1 else 'es'}"
            front = self.result(method, f"interrupted after {done}")
            front.interrupted = True
            return front

    def _search(self, method: str, points: int, report: Callable[[float], None]) -> str:
        """Search the anchor points and the points between; returns a remark if there are none."""
        shares, anchors = _shares(len(self.aims), points), []
        total = len(self.aims) + len(shares)
        for row in range(len(self.aims)):
            x = self.solve(self.aim(row), [], self.functions.x0, *self.starts)
            if x is None:
                raise AnalysisError(
                    f"no optimum of {self.aims[row].label} alone: {self.failures[-1]}"
                )
            anchors.append(x)
            report((row + 1) / total)
        corners = np.array([self.values(x) for x in anchors])
        low, high = corners.min(axis=0), corners.max(axis=0)
        span = high - low
        if np.any(span <= 1e-9 * np.maximum(abs(high), 1e-12)):
            return "the aims do not contradict each other"
        anchors = [
            self.make_efficient(x, span) if self.is_weakly_optimal(row, x, span) else x
            for row, x in enumerate(anchors)
        ]
        corners = np.array([self.values(x) for x in anchors])
        low, span = corners.min(axis=0), np.ptp(corners, axis=0)
        if np.any(span <= 1e-9 * np.maximum(abs(corners).max(axis=0), 1e-12)):
            return "the aims do not contradict each other"
        previous = anchors[-1]
        for k, share in enumerate(shares):
            limits_of = self.normal if method == "normal-constraint" else self.epsilon
            nearest = min(self.solutions, key=lambda x: self.distance(x, share @ corners, span))
            starts = (
                [(previous, nearest, *self.starts)] if self.starts else [(previous,), (nearest,)]
            )
            for start_designs in starts:
                x = self.solve(self.aim(0), limits_of(share, corners, low, span), *start_designs)
                if x is not None:
                    previous = x if len(self.aims) == 2 else self.make_efficient(x, span)
                    break
            report((len(self.aims) + k + 1) / total)
        return ""

    def is_weakly_optimal(self, row: int, x: np.ndarray, span: np.ndarray) -> bool:
        """Whether an anchor is only weakly optimal: other aims improve at no cost of its own."""
        lower, upper = self.functions.bounds.T
        width = self.functions.problem.variables.width
        slopes = self.senses[:, None] * self.functions.jacobian(x) * width
        sizes = np.abs(slopes).max(axis=1, keepdims=True)
        if not np.all(sizes > STEEP * span[:, None]):  # an aim is stationary within the bounds
            return False
        slopes /= sizes
        other_slopes = np.delete(slopes, row, axis=0)
        improves = ((other_slopes > FLAT) & (x > lower)) | ((other_slopes < -FLAT) & (x < upper))
        return bool(np.any((np.abs(slopes[row]) < FLAT) & improves.any(axis=0)))

    def make_efficient(self, x: np.ndarray, span: np.ndarray) -> np.ndarray:
        """Efficient design that is no worse in any aim."""
        values = self.values(x)
        limits = [
            Limit(Weighted([aim], [sense / size], f"bound on {k}"), upper=float(value / size))
            for k, (aim, sense, size, value) in enumerate(
                zip(self.aims, self.senses, span, values, strict=True)
            )
        ]
        goal = Weighted(self.aims, self.senses / span, "all aims")
        improved = self.solve(goal, limits, x)
        if improved is None:
            return x
        self.solutions = [other for other in self.solutions if other is not x]
        return improved

    def distance(self, x: np.ndarray, point: np.ndarray, span: np.ndarray) -> float:
        return float(np.linalg.norm((self.values(x) - point) / span))

    def normal(
        self, share: np.ndarray, corners: np.ndarray, low: np.ndarray, span: np.ndarray
    ) -> list[Limit]:
        """``N_k·(f̄ − X) ≤ 0``, N_k from the first anchor to the others (Messac et al. 2003)."""
        unit = (corners - low) / span
        target, limits = share @ unit, []
        for k in range(1, len(unit)):
            normal = unit[0] - unit[k]
            weights = normal * self.senses / span
            offset = float(normal @ (low / span + target))
            limits.append(Limit(Weighted(self.aims, weights, f"normal {k}"), upper=offset))
        return limits

    def epsilon(
        self, share: np.ndarray, corners: np.ndarray, low: np.ndarray, span: np.ndarray
    ) -> list[Limit]:
        """``f_k ≤ ε_k`` for all aims except the first (Haimes 1971)."""
        limits, target = [], share @ corners
        for k in range(1, len(corners)):
            aim = Weighted([self.aims[k]], [self.senses[k] / span[k]], f"bound on {k}")
            limits.append(Limit(aim, upper=float(target[k] / span[k])))
        return limits

    def result(self, method: str, note: str) -> ParetoResult:
        values = np.array([self.values(x) for x in self.solutions])
        designs = np.array(self.solutions)
        single = distinct(values)
        remarks = f"; {len(self.failures)} searches failed" if self.failures else ""
        if len(single) < len(values):
            remarks += f"; {len(values) - len(single)} of {len(values)} designs were repeated"
        values, designs = values[single], designs[single]
        dominated = len(values) - len(nondominated(values))
        if dominated:
            remarks += f"; {dominated} of {len(values)} designs were dominated and left out"
            remarks += "" if self.starts else ": local optima only, use starts= for more"
        text = f"{method}{remarks}{'; ' + note if note else ''}"
        return make_front(self.functions, self.senses, values, designs, text, self.failures)


def _shares(aims: int, points: int) -> list[np.ndarray]:
    """Even convex combinations of the anchors, without the anchors (Das & Dennis 1998)."""
    total = points - 1
    return [
        np.array(counts) / total
        for counts in itertools.product(range(total + 1), repeat=aims)
        if sum(counts) == total and max(counts) < total
    ]
