"""The programme of a trajectory solved by Ipopt, with exact first and second derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.design.trajectory.collocation import DirectCollocation
from dalembert.design.trajectory.transcription import Rows, Transcription
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
    """

    x: np.ndarray
    objective: float
    iterations: int
    told: str


@dataclass(frozen=True, eq=False)
class Programme:
    """``min objective`` subject to rows of equations and limits."""

    transcription: Transcription
    objective: ca.MX
    rows: list[Rows]

    def solved(self, x0: np.ndarray, method: DirectCollocation) -> Solution:
        """The unknowns that Ipopt leads to."""
        unknowns = self.transcription.unknowns
        value = ca.Function("objective", [unknowns], [self.objective])
        first = float(value(x0))
        size = max(abs(first), 1e-3) if np.isfinite(first) else 1.0
        settings: dict[str, Any] = {
            "ipopt.max_iter": method.max_iterations,
            "ipopt.tol": method.tolerance,
            "ipopt.print_level": 0,
            "ipopt.sb": "yes",
            "ipopt.mu_strategy": "adaptive",
            "print_time": False,
            "error_on_fail": False,
            "show_eval_warnings": False,
            "expand": True,
        }
        rows = ca.vertcat(*(ca.vec(row.value) for row in self.rows))
        problem = {"x": unknowns, "f": self.objective / size, "g": rows}
        solver = ca.nlpsol("trajectory", "ipopt", problem, settings)
        lower, upper = self.transcription.bounds()
        found = solver(x0=x0, lbx=lower, ubx=upper, lbg=self._ends(0), ubg=self._ends(1))
        told = solver.stats()
        message = str(told["return_status"]).replace("_", " ").lower()
        x = np.array(found["x"]).ravel()
        return Solution(x, float(value(x)), int(told["iter_count"]), message)

    def _ends(self, side: int) -> np.ndarray:
        pairs = [np.full(r.value.numel(), (r.lower, r.upper)[side]) for r in self.rows]
        return np.concatenate(pairs)

    def status(self, solution: Solution, duration: float) -> Status:
        """Judged by the residuals, whatever the solver says; the worst of them has a name."""
        open_by = [self._open(row, solution.x) for row in self.rows]
        worst = int(np.argmax(open_by))
        kept, message = bool(open_by[worst] <= SOLVED), f"Ipopt: {solution.told}"
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
