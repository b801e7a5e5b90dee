"""Sizes out of catalogues and whole numbers, held or branched on."""

from __future__ import annotations

import heapq
import itertools
from dataclasses import dataclass, field

import numpy as np

from dalembert.design.methods.base import Ended, Optimizer, Stop
from dalembert.design.methods.slsqp import Slsqp
from dalembert.design.optimize.program import FEASIBLE, Program
from dalembert.options import options


def fix_sizes(program: Program, x: np.ndarray) -> None:
    """Hold each discrete variable at its size nearest to ``x``."""
    at = program.variables.snapped(x)
    for k in program.variables.sizes:
        program.lower[k] = program.upper[k] = at[k]


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
    """Whole numbers and catalogues: gradient solutions with sizes relaxed, in ranges that halve.

    Exact where the relaxed problems are convex; a good heuristic elsewhere (Land & Doig 1960).

    Parameters
    ----------
    local : gradient method of the relaxed problems
    max_nodes : relaxed problems at most

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

    def solve(self, program: Program, z: np.ndarray, stop: Stop) -> Ended:
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
        fix_sizes(program, program.unscale(search.design))
        left = [n.bound for n in search.open if n.bound < search.best]
        message = f"branch and bound: {search.nodes} relaxed problems"
        if left:
            message += f", {len(left)} ranges of sizes are left unexplored; raise max_nodes"
            if set(range(program.n)) <= set(program.variables.sizes):
                message += ", or take method='enumeration'"
        return Ended(search.design, not left, message, is_whole=not left)


class _Search:
    """The tree of ranges."""

    def __init__(self, method: BranchAndBound, program: Program, stop: Stop):
        self.method, self.program, self.stop = method, program, stop
        self.open: list[_Node] = []
        self.numbers = itertools.count(1)
        self.nodes, self.best = 0, np.inf
        self.design: np.ndarray | None = None

    def relaxed(self, z: np.ndarray, lower: np.ndarray, upper: np.ndarray) -> Ended | None:
        """Optimum of a range; None where limits cannot be kept in it."""
        program = self.program
        program.lower, program.upper = lower.copy(), upper.copy()
        self.nodes += 1
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
