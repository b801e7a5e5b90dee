"""The programme of a trajectory solved by Ipopt, with exact first and second derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.design.methods.search_options import OnIteration
from dalembert.design.trajectory.method import TrajectoryMethod
from dalembert.design.trajectory.transcription import Rows, Transcription
from dalembert.interrupts import searching
from dalembert.results.status import Outcome, Status

SOLVED = 1e-6
"""Largest residual of a plan, in natural sizes."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Where Ipopt ended.

    Attributes
    ----------
    x : unknowns as the solver sees them
    objective : there
    iterations, told : how many, and what it says
    interrupted : by Ctrl-C; the unknowns are those of the last iteration
    """

    x: np.ndarray
    objective: float
    iterations: int
    told: str
    interrupted: bool = False


@dataclass(frozen=True, eq=False)
class Programme:
    """``min objective + penalty`` subject to rows of equations and limits."""

    transcription: Transcription
    objective: ca.MX
    rows: list[Rows]
    penalty: ca.MX | float = 0.0

    def solved(
        self, x0: np.ndarray, method: TrajectoryMethod, told: OnIteration | None = None
    ) -> Solution:
        """The unknowns that Ipopt leads to."""
        unknowns = self.transcription.unknowns
        value = ca.Function("objective", [unknowns], [self.objective])
        first = float(value(x0))
        size = max(abs(first), 1e-3) if np.isfinite(first) else 1.0
        rows = ca.vertcat(*(ca.vec(row.value) for row in self.rows))
        watch = _Watch(unknowns.numel(), rows.numel(), size, told, x0)
        settings: dict[str, Any] = {
            "iteration_callback": watch,
            "ipopt.max_iter": method.max_iterations,
            "ipopt.tol": max(method.tolerance, 1e-14),
            "ipopt.print_level": 0,
            "ipopt.sb": "yes",
            "ipopt.mu_strategy": "adaptive",
            "print_time": False,
            "error_on_fail": False,
            "show_eval_warnings": False,
            "expand": method.expands,
        }
        problem = {"x": unknowns, "f": (self.objective + self.penalty) / size, "g": rows}
        solver = ca.nlpsol("trajectory", "ipopt", problem, settings)
        lower, upper = self.transcription.bounds()
        try:
            with searching():
                found = solver(x0=x0, lbx=lower, ubx=upper, lbg=self._ends(0), ubg=self._ends(1))
                x, ended = np.array(found["x"]).ravel(), str(solver.stats()["return_status"])
        except KeyboardInterrupt:
            watch.stopped = True
        if watch.stopped:
            return Solution(watch.x, float(value(watch.x)), watch.count, "interrupted", True)
        message = ended.replace("_", " ").lower()
        return Solution(x, float(value(x)), watch.count, message)

    def _ends(self, side: int) -> np.ndarray:
        pairs = [np.full(r.value.numel(), (r.lower, r.upper)[side]) for r in self.rows]
        return np.concatenate(pairs)

    def status(self, solution: Solution, duration: float) -> Status:
        """Judged by the residuals, whatever the solver says; the worst of them has a name."""
        open_by = [self._open(row, solution.x) for row in self.rows]
        worst = int(np.argmax(open_by))
        kept, message = bool(open_by[worst] <= SOLVED), f"Ipopt: {solution.told}"
        if solution.interrupted:
            message = f"interrupted after {solution.iterations} iterations"
            return Status(Outcome.INTERRUPTED, message, duration, open_by[worst])
        if kept and solution.told in ("solve succeeded", "solved to acceptable level"):
            return Status(Outcome.COMPLETED, message, duration, open_by[worst])
        if not kept:
            message += (
                f"; {self.rows[worst].label} left open by {open_by[worst]:.2g} of its size: give a "
                "better guess, more intervals, a longer duration or wider bounds"
            )
        return Status(Outcome.NOT_CONVERGED, message, duration, open_by[worst])

    def _open(self, row: Rows, x: np.ndarray) -> float:
        function = ca.Function("value", [self.transcription.unknowns], [row.value])
        value = np.array(function(x)).ravel()
        over = np.maximum(row.lower - value, value - row.upper)
        return float(np.max(np.nan_to_num(over, nan=np.inf), initial=0.0))


class _Watch(ca.Callback):
    """Keeps the unknowns of the last iteration, and tells how far the search is."""

    def __init__(self, n: int, rows: int, size: float, told: OnIteration | None, x0: np.ndarray):
        ca.Callback.__init__(self)
        self.sizes = {"x": n, "f": 1, "g": rows, "lam_x": n, "lam_g": rows, "lam_p": 0}
        self.size, self.told, self.x, self.count = size, told, np.array(x0, dtype=float), -1
        self.stopped = False
        self.construct("watch", {})

    def get_n_in(self) -> int:
        return ca.nlpsol_n_out()

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self.sizes[ca.nlpsol_out(i)], 1)

    def get_n_out(self) -> int:
        return 1

    def eval(self, given: Sequence[Any]) -> list[int]:
        found = dict(zip(ca.nlpsol_out(), given, strict=True))
        self.x = np.array(found["x"]).ravel()
        self.count += 1
        try:
            if self.told is not None and self.count:
                self.told(self.count, float(found["f"]) * self.size)
        except KeyboardInterrupt:  # CasADi would lose it
            self.stopped = True
        return [int(self.stopped)]
