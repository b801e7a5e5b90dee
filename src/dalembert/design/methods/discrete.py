"""Branch and bound over whole numbers and sizes out of catalogues."""

from __future__ import annotations

import heapq
import itertools
from dataclasses import dataclass, field

import numpy as np

from dalembert.design.methods.base import Ended, Optimizer, Stop
from dalembert.design.methods.enumeration import Enumeration
from dalembert.design.methods.slsqp import Slsqp
from dalembert.design.optimize.program import FEASIBLE, Program
from dalembert.options import options, random_generator

PAIRS = 16
"""Pairs of designs between which convexity is tested."""
DIFFERENT = 1e-5
"""Relative difference of objectives beyond which two relaxed optima are distinct."""


@dataclass(order=True)
class _Node:
    """A range of sizes, and the objective that its relaxed problem can reach at best."""

    bound: float
    number: int
    z: np.ndarray = field(compare=False)
    lower: np.ndarray = field(compare=False)
    upper: np.ndarray = field(compare=False)


@options
class BranchAndBound(Optimizer):
    """Whole numbers and catalogues: relaxed problems in ranges of sizes that are halved.

    Where all variables are discrete and few enough, every design is compared instead
    (``Enumeration``). Otherwise the bound of a range is the best optimum of its relaxed problem
    from several starts. That bound is exact where the relaxed problems are convex (Land & Doig
    1960). Convexity is tested; the message says where the result is not proved to be global.

    Parameters
    ----------
    local : gradient method of the relaxed problems
    max_nodes : relaxed problems at most; also designs at most that are compared by their runs
    starts : starts of each relaxed problem, once the problem is known not to be convex
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

    local: Optimizer = Slsqp()
    max_nodes: int = 400
    starts: int = 3
    rng: int = 0

    def finishing(self) -> Optimizer:
        """The local method: sizes are held at the end, and searching them again would find one."""
        return self.local

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> Ended:
        every = Enumeration(max_runs=self.max_nodes)
        if every.covers(program):
            return every.solve(program, z, stop)
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
            return Ended(z, False, f"no sizes keep the limits ({search.nodes} relaxed problems)")
        program.fix_sizes(program.unscale(search.design))
        left = [n.bound for n in search.open if n.bound < search.best]
        message = f"branch and bound: {search.nodes} relaxed problems"
        if left:
            message += (
                f", stopped early: {len(left)} ranges of sizes are left unexplored; raise max_nodes"
            )
            if can_enumerate:
                message += ", or take method='enumeration'"
        if not search.is_convex:
            message += (
                "; the relaxed problems are not convex, so the best design is not proved to be "
                "the global optimum"
            )
        return Ended(search.design, not left, message, is_whole=not left)


class _Search:
    """The tree of ranges."""

    def __init__(self, method: BranchAndBound, program: Program, stop: Stop):
        self.method, self.program, self.stop = method, program, stop
        self.open: list[_Node] = []
        self.numbers = itertools.count(1)
        self.nodes, self.best = 0, np.inf
        self.design: np.ndarray | None = None
        self.generator = random_generator(method.rng)
        self.is_convex = self._is_convex()

    def _drawn(self) -> np.ndarray:
        """A design between the bounds, or near the start where they are open."""
        low, high = (np.clip(z, -1.0, 1.0) for z in (self.program.z_lower, self.program.z_upper))
        return np.asarray(self.generator.uniform(low, np.maximum(low, high)))

    def _is_convex(self) -> bool:
        """Whether objective and limits at the middle of random pairs are those of convex ones."""
        program = self.program
        for _ in range(PAIRS):
            one, other = self._drawn(), self._drawn()
            found = [program.value(z) for z in (one, other, (one + other) / 2)]
            if any(values is None for values in found):
                continue
            (f, c), (g, d), (middle, between) = (values for values in found if values is not None)
            if middle > (f + g) / 2 + DIFFERENT * (abs(f) + abs(g)):
                return False
            bend, size = between - (c + d) / 2, DIFFERENT * (abs(c) + abs(d))
            upper, lower = np.isfinite(program.c_upper), np.isfinite(program.c_lower)
            if np.any(bend[upper] > size[upper]) or np.any(bend[lower] < -size[lower]):
                return False
        return True

    def relaxed(self, z: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> Ended | None:
        """Best optimum of a range; None where limits cannot be kept in it."""
        program = self.program
        program.lower, program.upper = lower.copy(), upper.copy()
        self.nodes += 1
        first = self._local(z)
        sizes = list(program.variables.sizes)
        is_held = not np.any(program.is_free()[sizes])
        more = 0 if self.is_convex or is_held else self.method.starts - 1
        found = [first, *(self._local(self._drawn()) for _ in range(more))]
        ends = [(self.objective(one.z), k) for k, one in enumerate(found) if one is not None]
        return found[min(ends)[1]] if ends else None

    def _local(self, z: np.ndarray) -> Ended | None:
        """An optimum within the range; None where it breaks limits."""
        program = self.program
        z = np.clip(z, program.z_lower, program.z_upper)
        ended = self.method.local.solve(program, z, self.stop)
        found = program.problem.evaluate(program.unscale(ended.z), gradient=False)
        if found is None or program.violation(found.values) > FEASIBLE:
            return None
        return ended

    def objective(self, z: np.ndarray) -> float:
        found = self.program.value(z)
        return np.inf if found is None else found[0]

    def branch(self, node: _Node) -> None:
        """Solve a range; keep its optimum if it has sizes, else halve it at the worst one."""
        ended = self.relaxed(node.z, node.lower, node.upper)
        if ended is None:
            return
        x, bound = self.program.unscale(ended.z), self.objective(ended.z)
        if bound < node.bound - DIFFERENT * abs(node.bound):  # a part is better than the whole
            self.is_convex = False
        if bound >= self.best - 1e-9 * abs(self.best):
            return
        snapped = self.program.variables.snapped(x)
        gaps = abs(snapped - x) / self.program.width
        worst = int(np.argmax(gaps))
        if gaps[worst] <= 1e-7:
            self.keep(self.program.scaled(snapped))
            return
        self.round(snapped, ended.z)
        sizes = self.program.variables.sizes[worst]
        for low, high in ((-np.inf, x[worst]), (x[worst], np.inf)):
            within = sizes[(sizes >= low) & (sizes <= high)]
            within = within[(within >= node.lower[worst]) & (within <= node.upper[worst])]
            if within.size:
                lower, upper = node.lower.copy(), node.upper.copy()
                lower[worst], upper[worst] = within[0], within[-1]
                heapq.heappush(self.open, _Node(bound, next(self.numbers), ended.z, lower, upper))

    def round(self, snapped: np.ndarray, z: np.ndarray) -> None:
        """The nearest sizes with the other variables fitted: perhaps a design to beat."""
        lower, upper = self.program.lower.copy(), self.program.upper.copy()
        held_lower, held_upper = lower.copy(), upper.copy()
        for k in self.program.variables.sizes:
            held_lower[k] = held_upper[k] = np.clip(snapped[k], lower[k], upper[k])
        ended = self.relaxed(z, held_lower, held_upper)
        if ended is not None:
            self.keep(ended.z)
        self.program.lower, self.program.upper = lower, upper

    def keep(self, z: np.ndarray) -> None:
        """The best design with sizes so far."""
        value = self.objective(z)
        if value < self.best:
            self.best, self.design = value, z
