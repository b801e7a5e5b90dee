"""The points of a front by gradients: scalar problems, one for each point."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence

import numpy as np

from dalembert.design.ecosystem.functions import DesignFunctions
from dalembert.design.limit import Limit
from dalembert.design.methods.base import Optimizer, Stop
from dalembert.design.optimize.optimality import OPTIMAL, multipliers
from dalembert.design.optimize.outcome import violated_limits
from dalembert.design.optimize.program import FEASIBLE, Program
from dalembert.design.optimize.settling import solve_to_stationarity
from dalembert.design.pareto.front import Front, best_of
from dalembert.design.quantity import Quantity
from dalembert.design.weighted import Weighted
from dalembert.errors import AnalysisError
from dalembert.interrupts import searching

STEEP = 1e-3
"""Slope over the range of a variable, of the range of an aim, from which on it counts."""
ROUGH = Stop(30, 1e-6)
"""For a start of many; the best of what they come to is searched from again."""
UNSEEN = 1e-6
"""Slope over the range of a variable, of the largest one, that is none."""


class FrontSearch:
    """Scalar problems, one for each point, each from the point before it."""

    def __init__(
        self,
        functions: DesignFunctions,
        senses: Sequence[float],
        local: Optimizer,
        max_iterations: int,
        tolerance: float,
        others: Sequence[np.ndarray] = (),
    ):
        """``others`` are designs from which each problem is searched too."""
        self.begins = list(others)
        self.functions, self.senses, self.local = functions, np.array(senses), local
        self.stop = Stop(max_iterations, tolerance)
        self.aims = functions.problem.quantities[: functions.count]
        self.others = functions.problem.quantities[functions.count :]
        self.found: list[np.ndarray] = []
        self.failed: list[str] = []

    def solved(
        self, goal: Quantity, limits: Sequence[Limit], x: np.ndarray, *others: np.ndarray
    ) -> np.ndarray | None:
        """The best design within further limits on aims, from some starts; None without one."""
        end = self._ended(goal, limits, x)
        nearby = [one for one in (self._rough(goal, limits, o) for o in others) if one is not None]
        if nearby:
            value, begin = min(nearby, key=lambda one: one[0])
            if isinstance(end, str) or value < end[0]:
                further = self._ended(goal, limits, begin)
                end = end if isinstance(further, str) else further
        if isinstance(end, str):
            self.failed.append(end)
            return None
        self.found.append(end[1])
        return end[1]

    def _program(self, goal: Quantity, limits: Sequence[Limit], x: np.ndarray) -> Program:
        quantities = [goal, *self.others, *(limit.response for limit in limits)]
        problem = self.functions.problem.with_quantities(quantities)
        return Program(problem, [*self.functions.limits, *limits], 1.0, x)

    def _rough(
        self, goal: Quantity, limits: Sequence[Limit], x: np.ndarray
    ) -> tuple[float, np.ndarray] | None:
        """Where a short search from one start of many comes to; None where limits are not kept."""
        try:
            program = self._program(goal, limits, x)
        except AnalysisError:  # it cannot be run there
            return None
        x = program.unscale(self.local.solve(program, program.scaled(x), ROUGH).z)
        found = program.problem.evaluate(x, gradient=False)
        if found is None or program.violation(found.values) > FEASIBLE:
            return None
        return float(found.values[0]), x

    def _ended(
        self, goal: Quantity, limits: Sequence[Limit], x: np.ndarray
    ) -> tuple[float, np.ndarray] | str:
        """The best goal and design that are found from a start; why there is none."""
        program = self._program(goal, limits, x)
        ended = solve_to_stationarity(program, self.local, self.stop, program.scaled(x))
        x = program.unscale(ended.z)
        z = program.scaled(x)
        program.measure_by_start()
        point, found = program.point(z, record=False), program.problem.evaluate(x)
        if point is None or found is None:
            return "ended at a design that fails"
        violation = program.violation(found.values)
        left = multipliers(program, z, point).stationarity
        if violation > FEASIBLE or left > OPTIMAL:
            why = f"the gradient is left with {left:.2g} of its size ({ended.message})"
            if violation > FEASIBLE:
                why = f"limits are not kept, {violated_limits(program, found.values)}"
            return why
        return float(found.values[0]), x

    def aim(self, row: int) -> Quantity:
        """One aim, to be small."""
        return Weighted([self.aims[row]], [self.senses[row]], self.aims[row].label)

    def values(self, x: np.ndarray) -> np.ndarray:
        """(aims,) all to be small."""
        return self.senses * self.functions.values(x)

    def front(self, method: str, points: int, report: Callable[[float], None]) -> Front:
        """The points of the front; those found until then where it is interrupted.

        Raises
        ------
        AnalysisError
            There is no best design in one of the aims.
        """
        try:
            with searching():
                note = self._along(method, points, report)
            return self.result(method, note)
        except KeyboardInterrupt:
            if not self.found:
                raise
            front = self.result(method, f"interrupted after {len(self.found)} searches")
            front.interrupted = True
            return front

    def _along(self, method: str, points: int, report: Callable[[float], None]) -> str:
        """Search the corners and the points between; a note where there is nothing between."""
        shares, anchors = _shares(len(self.aims), points), []
        whole = len(self.aims) + len(shares)
        for row in range(len(self.aims)):
            x = self.solved(self.aim(row), [], self.functions.x0, *self.begins)
            if x is None:
                raise AnalysisError(
                    f"no best design in {self.aims[row].label} alone: {self.failed[-1]}"
                )
            anchors.append(x)
            report((row + 1) / whole)
        corners = np.array([self.values(x) for x in anchors])
        low, high = corners.min(axis=0), corners.max(axis=0)
        span = high - low
        if np.any(span <= 1e-9 * np.maximum(abs(high), 1e-12)):
            return "the aims do not contradict each other"
        anchors = [
            self.efficient(x, span) if self.is_loose(row, x, span) else x
            for row, x in enumerate(anchors)
        ]
        corners = np.array([self.values(x) for x in anchors])
        low, span = corners.min(axis=0), np.ptp(corners, axis=0)
        if np.any(span <= 1e-9 * np.maximum(abs(corners).max(axis=0), 1e-12)):
            return "the aims do not contradict each other"
        last = anchors[-1]
        for k, share in enumerate(shares):
            make = self.normal if method == "normal-constraint" else self.epsilon
            nearest = min(self.found, key=lambda x: self.distance(x, share @ corners, span))
            starts = [(last, nearest, *self.begins)] if self.begins else [(last,), (nearest,)]
            for begins in starts:
                x = self.solved(self.aim(0), make(share, corners, low, span), *begins)
                if x is not None:
                    last = x if len(self.aims) == 2 else self.efficient(x, span)
                    break
            report((len(self.aims) + k + 1) / whole)
        return ""

    def is_loose(self, row: int, x: np.ndarray, span: np.ndarray) -> bool:
        """Whether a corner, at a bound as a rule, leaves variables that only other aims notice."""
        lower, upper = self.functions.bounds.T
        width = self.functions.problem.variables.width
        slopes = self.senses[:, None] * self.functions.jacobian(x) * width
        sizes = np.abs(slopes).max(axis=1, keepdims=True)
        if not np.all(sizes > STEEP * span[:, None]):  # an aim at rest within its bounds
            return False
        slopes /= sizes
        others = np.delete(slopes, row, axis=0)
        falls = ((others > UNSEEN) & (x > lower)) | ((others < -UNSEEN) & (x < upper))
        return bool(np.any((np.abs(slopes[row]) < UNSEEN) & falls.any(axis=0)))

    def efficient(self, x: np.ndarray, span: np.ndarray) -> np.ndarray:
        """A design that is no worse in any aim and cannot be bettered in one alone."""
        values = self.values(x)
        limits = [
            Limit(Weighted([aim], [sense / size], f"bound on {k}"), upper=float(value / size))
            for k, (aim, sense, size, value) in enumerate(
                zip(self.aims, self.senses, span, values, strict=True)
            )
        ]
        goal = Weighted(self.aims, self.senses / span, "all aims")
        better = self.solved(goal, limits, x)
        if better is None:
            return x
        self.found = [other for other in self.found if other is not x]
        return better

    def distance(self, x: np.ndarray, place: np.ndarray, span: np.ndarray) -> float:
        return float(np.linalg.norm((self.values(x) - place) / span))

    def normal(
        self, share: np.ndarray, corners: np.ndarray, low: np.ndarray, span: np.ndarray
    ) -> list[Limit]:
        """``N_k·(f̄ − X) ≤ 0``, N_k from the first corner to the others (Messac et al. 2003)."""
        unit = (corners - low) / span
        place, made = share @ unit, []
        for k in range(1, len(unit)):
            normal = unit[0] - unit[k]
            weights = normal * self.senses / span
            offset = float(normal @ (low / span + place))
            made.append(Limit(Weighted(self.aims, weights, f"normal {k}"), upper=offset))
        return made

    def epsilon(
        self, share: np.ndarray, corners: np.ndarray, low: np.ndarray, span: np.ndarray
    ) -> list[Limit]:
        """``f_k ≤ ε_k`` for all aims but the first (Haimes 1971)."""
        made, place = [], share @ corners
        for k in range(1, len(corners)):
            aim = Weighted([self.aims[k]], [self.senses[k] / span[k]], f"bound on {k}")
            made.append(Limit(aim, upper=float(place[k] / span[k])))
        return made

    def result(self, method: str, note: str) -> Front:
        values = np.array([self.values(x) for x in self.found])
        designs = np.array(self.found)
        lost = f"; {len(self.failed)} searches without result" if self.failed else ""
        beaten = len(values) - len(best_of(values))
        if beaten:
            lost += f"; {beaten} of {len(values)} designs were beaten by others and left out"
            lost += "" if self.begins else ": the best nearby only, starts= looks further"
        text = f"{method}{lost}{'; ' + note if note else ''}"
        return make_front(self.functions, self.senses, values, designs, text, self.failed)


def _shares(aims: int, points: int) -> list[np.ndarray]:
    """Even convex combinations of the corners, corners left out (Das & Dennis 1998)."""
    whole = points - 1
    return [
        np.array(counts) / whole
        for counts in itertools.product(range(whole + 1), repeat=aims)
        if sum(counts) == whole and max(counts) < whole
    ]


def make_front(
    functions: DesignFunctions,
    senses: Sequence[float] | np.ndarray,
    values: np.ndarray,
    designs: np.ndarray,
    message: str,
    failed: list[str],
) -> Front:
    """The designs that are not beaten, along the first aim."""
    keep = best_of(values)
    keep = keep[np.argsort(values[keep, 0])]
    problem, at = functions.problem, designs[keep]
    results = problem.results(at[0])
    made = [problem.variables.parameters(x) for x in at]
    case = problem.quantities[0].terms[0].case
    units = dict(zip(problem.variables.names, problem.variables.units, strict=True))
    return Front(
        functions.labels,
        [problem.unit(k, results) for k in range(functions.count)],
        list(made[0]),
        values[keep] * np.asarray(senses),
        np.array([list(one.values()) for one in made]),
        list(map(float, senses)),
        message,
        problem.runs,
        problem.gradients,
        failed,
        name=case.model.name,
        parameter_units=[units.get(n, case.model.parameters[n].unit) for n in made[0]],
        rerun=lambda k: problem.results(at[k]).get(case),
    )
