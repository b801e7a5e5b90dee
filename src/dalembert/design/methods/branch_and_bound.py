"""Branch and bound over integers and catalogue sizes."""

from __future__ import annotations

import heapq
import itertools
from dataclasses import dataclass, field

import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.methods.enumeration import Enumeration
from dalembert.design.methods.slsqp import SLSQP
from dalembert.design.optimize.program import FEASIBLE, Program
from dalembert.options import options, random_generator

PAIRS = 16
"""Random pairs of designs for the convexity test."""
DIFFERENT = 1e-5
"""Threshold of the relative difference of distinct relaxed optima [-]."""


@dataclass(order=True)
class _Node:
    """Node of the tree: a range of sizes and the lower bound of its objective."""

    bound: float
    number: int
    z: np.ndarray = field(compare=False)
    lower: np.ndarray = field(compare=False)
    upper: np.ndarray = field(compare=False)


@options
class BranchAndBound(Optimizer):
    """Branch and bound over integers and catalogues with continuous relaxations.

    If all variables are discrete and the designs few enough, all are compared instead
    (``Enumeration``). Otherwise the bound of a range is the best optimum of its relaxed problem
    from several starts. That bound is exact if the relaxed problems are convex (Land & Doig 1960).
    Convexity is tested; the message reports if the result is not proved to be global.

    Parameters
    ----------
    local : gradient method of the relaxed problems
    max_nodes : upper limit of the relaxed problems, and of designs enumerated by runs
    starts : of each relaxed problem if the problem is not convex
    rng : seed of the starts

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> model = da.Structure("springs side by side")
    >>> count = model.parameter("count", 5, bounds=(1, 20))
    >>> end = model.node("end", 0)
    >>> part = model.add(structures.GroundSpring("spring", end, stiffness_x=30.0 * count))
    >>> model.load(end, fx=100.0)
    >>> stiff = da.Limit(da.final("end.ux"), upper=1.0)
    >>> task = dict(minimize=da.final("count"), subject_to=[stiff], analysis=da.Statics())
    >>> search = dict(vary=[da.Integer("count")], method=da.BranchAndBound())
    >>> best = da.optimize(model.build(), **task, **search)
    >>> round(best.x["count"])  # 100/30 is not enough for three
    4
    """

    local: Optimizer = SLSQP()
    max_nodes: int = 400
    starts: int = 3
    rng: int = 0

    def finishing(self) -> Optimizer:
        """Local method, as the sizes are fixed at the end."""
        return self.local

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> OptimizerResult:
        enumeration = Enumeration(max_runs=self.max_nodes)
        if enumeration.covers(program):
            return enumeration.solve(program, z, stop)
        can_enumerate = Enumeration().covers(program)
        search = _Search(self, program, stop)
        lower, upper = program.lower.copy(), program.upper.copy()
        search.branch(_Node(-np.inf, 0, z, lower, upper))
        while search.open and search.nodes < self.max_nodes:
            node = heapq.heappop(search.open)
            if node.bound < search.best:
                search.branch(node)
        program.lower, program.upper = lower, upper
        if search.design is None:
            return OptimizerResult(
                z, False, f"no sizes satisfy the limits ({search.nodes} relaxed problems)"
            )
        program.fix_sizes(program.unscale(search.design))
        open_bounds = [n.bound for n in search.open if n.bound < search.best]
        message = f"branch and bound: {search.nodes} relaxed problems"
        if open_bounds:
            message += f", stopped early: {len(open_bounds)} ranges are unexplored; raise max_nodes"
            if can_enumerate:
                message += ", or use method='enumeration'"
        if not search.is_convex:
            message += (
                "; the relaxed problems are not convex, so the best design is not proved to be "
                "the global optimum"
            )
        return OptimizerResult(search.design, not open_bounds, message, is_complete=not open_bounds)


class _Search:
    """Tree of ranges of sizes."""

    def __init__(self, method: BranchAndBound, program: Program, stop: Stop):
        self.method, self.program, self.stop = method, program, stop
        self.open: list[_Node] = []
        self.numbers = itertools.count(1)
        self.nodes, self.best = 0, np.inf
        self.design: np.ndarray | None = None
        self.generator = random_generator(method.rng)
        self.is_convex = self._is_convex()

    def _random_design(self) -> np.ndarray:
        """Random design between the bounds, or near the start if they are infinite."""
        low, high = (np.clip(z, -1.0, 1.0) for z in (self.program.z_lower, self.program.z_upper))
        return np.asarray(self.generator.uniform(low, np.maximum(low, high)))

    def _is_convex(self) -> bool:
        """Whether objective and limits are convex at the midpoints of random pairs."""
        program = self.program
        for _ in range(PAIRS):
            first, second = self._random_design(), self._random_design()
            values = [program.value(z) for z in (first, second, (first + second) / 2)]
            if any(value is None for value in values):
                continue
            (f, c), (g, d), (middle, middle_limits) = (
                value for value in values if value is not None
            )
            if middle > (f + g) / 2 + DIFFERENT * (abs(f) + abs(g)):
                return False
            curvature, size = middle_limits - (c + d) / 2, DIFFERENT * (abs(c) + abs(d))
            upper, lower = np.isfinite(program.c_upper), np.isfinite(program.c_lower)
            if np.any(curvature[upper] > size[upper]) or np.any(curvature[lower] < -size[lower]):
                return False
        return True

    def relaxed(
        self, z: np.ndarray, lower: np.ndarray, upper: np.ndarray
    ) -> OptimizerResult | None:
        """Best optimum of the relaxed problem of a range; None if it is infeasible."""
        program = self.program
        program.lower, program.upper = lower.copy(), upper.copy()
        self.nodes += 1
        first = self._local(z)
        sizes = list(program.variables.sizes)
        is_fixed = not np.any(program.is_free()[sizes])
        extra_starts = 0 if self.is_convex or is_fixed else self.method.starts - 1
        results = [first, *(self._local(self._random_design()) for _ in range(extra_starts))]
        objectives = [
            (self.objective(result.z), k) for k, result in enumerate(results) if result is not None
        ]
        return results[min(objectives)[1]] if objectives else None

    def _local(self, z: np.ndarray) -> OptimizerResult | None:
        """Local optimum within the range; None if it violates limits."""
        program = self.program
        z = np.clip(z, program.z_lower, program.z_upper)
        result = self.method.local.solve(program, z, self.stop)
        evaluation = program.problem.evaluate(program.unscale(result.z), gradient=False)
        if evaluation is None or program.violation(evaluation.values) > FEASIBLE:
            return None
        return result

    def objective(self, z: np.ndarray) -> float:
        values = self.program.value(z)
        return np.inf if values is None else values[0]

    def branch(self, node: _Node) -> None:
        """Solve a range; keep its optimum if it is discrete, else split at the largest gap."""
        relaxed = self.relaxed(node.z, node.lower, node.upper)
        if relaxed is None:
            return
        x, bound = self.program.unscale(relaxed.z), self.objective(relaxed.z)
        # a subrange whose bound is lower than that of its range disproves convexity
        if bound < node.bound - DIFFERENT * abs(node.bound):
            self.is_convex = False
        if bound >= self.best - 1e-9 * abs(self.best):
            return
        snapped = self.program.variables.snapped(x)
        gaps = abs(snapped - x) / self.program.width
        worst = int(np.argmax(gaps))
        if gaps[worst] <= 1e-7:
            self.keep(self.program.scaled(snapped))
            return
        self.round(snapped, relaxed.z)
        sizes = self.program.variables.sizes[worst]
        for low, high in ((-np.inf, x[worst]), (x[worst], np.inf)):
            within = sizes[(sizes >= low) & (sizes <= high)]
            within = within[(within >= node.lower[worst]) & (within <= node.upper[worst])]
            if within.size:
                lower, upper = node.lower.copy(), node.upper.copy()
                lower[worst], upper[worst] = within[0], within[-1]
                heapq.heappush(self.open, _Node(bound, next(self.numbers), relaxed.z, lower, upper))

    def round(self, snapped: np.ndarray, z: np.ndarray) -> None:
        """Round to the nearest sizes and optimise the other variables, for an upper bound."""
        lower, upper = self.program.lower.copy(), self.program.upper.copy()
        fixed_lower, fixed_upper = lower.copy(), upper.copy()
        for k in self.program.variables.sizes:
            fixed_lower[k] = fixed_upper[k] = np.clip(snapped[k], lower[k], upper[k])
        result = self.relaxed(z, fixed_lower, fixed_upper)
        if result is not None:
            self.keep(result.z)
        self.program.lower, self.program.upper = lower, upper

    def keep(self, z: np.ndarray) -> None:
        """Update the best discrete design."""
        value = self.objective(z)
        if value < self.best:
            self.best, self.design = value, z
