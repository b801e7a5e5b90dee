"""Several aims: designs of which none is better in all of them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from dalembert.analysis.progress import Reported, progress_reporter
from dalembert.design.ecosystem.functions import DesignFunctions
from dalembert.design.front import Front, best_of
from dalembert.design.limit import Limit
from dalembert.design.methods.base import Optimizer, Stop
from dalembert.design.methods.registry import make_optimizer
from dalembert.design.optimality import OPTIMAL, multipliers
from dalembert.design.program import FEASIBLE, Program
from dalembert.design.quantity import Quantity
from dalembert.design.settling import settled
from dalembert.design.weighted import Weighted
from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.results.result import Analysis
from dalembert.sensitivity.methods import Method
from dalembert.spelling import spelled
from dalembert.symbolic.parametric_model import ParametricModel
from dalembert.text import unknown

EVOLUTIONS = ("nsga2", "nsga3")
METHODS = ("normal-constraint", "epsilon-constraint", *EVOLUTIONS)


@spelled
def pareto(
    model: ParametricModel | None = None,
    minimize: Sequence[Any] = (),
    *,
    maximize: Sequence[Any] = (),
    subject_to: Sequence[Limit] = (),
    vary: Sequence[Any] | None = None,
    analysis: Analysis | None = None,
    start: Mapping[str, float] | None = None,
    method: str = "normal-constraint",
    points: int = 15,
    local: str | Optimizer = "slsqp",
    gradient: Method = "auto",
    max_iterations: int = 100,
    tolerance: float = 1e-8,
    generations: int = 100,
    rng: int = 0,
    progress: Reported = False,
) -> Front:
    """The front of several aims; Ctrl-C ends it with the points found until then.

    Parameters
    ----------
    model, analysis : what is run; not needed where all responses are those of cases
    minimize, maximize : the aims, two or more in all
    subject_to, vary, start, gradient, max_iterations, tolerance : as in ``optimize``
    method : ``"normal-constraint"`` (evenly spread points by gradients, Messac et al. 2003),
        ``"epsilon-constraint"`` (bounds on all aims but the first, Haimes 1971), ``"nsga2"`` or
        ``"nsga3"`` of pymoo
    points : along each side of the front; population of an evolution
    local : gradient method of each point
    generations, rng : of an evolution
    progress : True for a bar, or a function of the fraction done

    Raises
    ------
    AnalysisError
        Fewer than two aims, or the starting design fails.
    """
    aims = [*minimize, *maximize]
    senses = [1.0] * len(minimize) + [-1.0] * len(maximize)
    if len(aims) < 2:
        raise AnalysisError("a front needs two aims or more: minimize=[...], maximize=[...]")
    if method not in METHODS:
        raise AnalysisError(unknown("method", method, METHODS))
    if points < 2:
        raise AnalysisError(f"points is {points}; give two or more")
    functions = DesignFunctions(
        model,
        aims,
        analysis=analysis,
        subject_to=subject_to,
        vary=vary,
        start=start,
        gradient=gradient,
    )
    if method in EVOLUTIONS:
        with progress_reporter(progress, method) as report:
            return _evolved(functions, senses, method, points, generations, rng, report)
    if functions.problem.variables.sizes:
        raise UnsupportedError(f"{method} knows no sizes of catalogues; use method='nsga2'")
    search = _Search(functions, senses, make_optimizer(local, False), max_iterations, tolerance)
    with progress_reporter(progress, "front") as report:
        return search.front(method, points, report)


class _Search:
    """Scalar problems, one for each point, each from the point before it."""

    def __init__(
        self,
        functions: DesignFunctions,
        senses: Sequence[float],
        local: Optimizer,
        max_iterations: int,
        tolerance: float,
    ):
        self.functions, self.senses, self.local = functions, np.array(senses), local
        self.stop = Stop(max_iterations, tolerance)
        self.aims = functions.problem.quantities[: functions.count]
        self.others = functions.problem.quantities[functions.count :]
        self.found: list[np.ndarray] = []
        self.failed: list[str] = []

    def solved(self, goal: Quantity, limits: Sequence[Limit], x: np.ndarray) -> np.ndarray | None:
        """The best design within further limits on aims; None where there is none."""
        quantities = [goal, *self.others, *(limit.response for limit in limits)]
        problem = self.functions.problem.judged_by(quantities)
        program = Program(problem, [*self.functions.limits, *limits], 1.0, x)
        ended = settled(program, self.local, self.stop, program.scaled(x))
        x = program.unscale(ended.z)
        z = program.scaled(x)
        program.measure_by_start()
        point, found = program.point(z, record=False), problem.evaluate(x)
        if point is None or found is None:
            self.failed.append("ended at a design that fails")
            return None
        violation = program.violation(found.values)
        left = multipliers(program, z, point).stationarity
        if violation > FEASIBLE or left > OPTIMAL:
            self.failed.append(f"{ended.message} (violation {violation:.2g}, residual {left:.2g})")
            return None
        self.found.append(x)
        return x

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
            return self.result(method, self._along(method, points, report))
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
            x = self.solved(self.aim(row), [], self.functions.x0)
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
        last = anchors[-1]
        for k, share in enumerate(shares):
            make = self.normal if method == "normal-constraint" else self.epsilon
            nearest = min(self.found, key=lambda x: self.distance(x, share @ corners, span))
            for begin in (last, nearest):
                x = self.solved(self.aim(0), make(share, corners, low, span), begin)
                if x is not None:
                    last = x if len(self.aims) == 2 else self.efficient(x, span)
                    break
            report((len(self.aims) + k + 1) / whole)
        return ""

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


def _evolved(
    functions: DesignFunctions,
    senses: Sequence[float],
    method: str,
    points: int,
    generations: int,
    rng: int,
    report: Callable[[float], None],
) -> Front:
    """NSGA-II (Deb et al. 2002) or NSGA-III (Deb & Jain 2014) of pymoo."""
    from dalembert.design.ecosystem.pymoo_problem import evolved

    designs, made = evolved(functions, senses, method, points, generations, rng, report)
    kept = np.array([functions.problem.variables.snapped(x) for x in designs])
    values = np.array([np.asarray(senses) * functions.values(x) for x in kept])
    text = f"{method}: {made} generations of {points}"
    text += "; interrupted" if made < generations else ""
    front = make_front(functions, senses, values, kept, text, [])
    front.interrupted = made < generations
    return front


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
