"""Nonlinear programme of a trajectory and its solution by Ipopt with exact derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.design.methods.search_options import OnIteration
from dalembert.design.trajectory.method import TrajectoryMethod
from dalembert.design.trajectory.transcription import Rows, Transcription
from dalembert.interrupts import searching
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.nonlinear_program import ipopt, return_status

SOLVED = 1e-6
"""Upper limit of the residual of a solved plan, in natural sizes."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Result of Ipopt.

    Attributes
    ----------
    x : scaled unknowns
    objective : value at ``x``
    iterations : number of iterations
    message : return status of Ipopt
    interrupted : by Ctrl-C; the unknowns are those of the last iteration
    """

    x: np.ndarray
    objective: float
    iterations: int
    message: str
    interrupted: bool = False


@dataclass(frozen=True, eq=False)
class Programme:
    """``min objective + penalty`` subject to rows of equations and limits."""

    transcription: Transcription
    objective: ca.MX
    rows: list[Rows]
    penalty: ca.MX | float = 0.0

    def solve(
        self, x0: np.ndarray, method: TrajectoryMethod, report: OnIteration | None = None
    ) -> Solution:
        """Solve the programme by Ipopt from an initial guess."""
        unknowns = self.transcription.unknowns
        value = ca.Function("objective", [unknowns], [self.objective])
        initial_value = float(value(x0))
        size = max(abs(initial_value), 1e-3) if np.isfinite(initial_value) else 1.0
        rows = ca.vertcat(*(ca.vec(row.value) for row in self.rows))
        callback = _IterationCallback(unknowns.numel(), rows.numel(), size, report, x0)
        problem = {"x": unknowns, "f": (self.objective + self.penalty) / size, "g": rows}
        solver = ipopt(
            "trajectory",
            problem,
            max(method.tolerance, 1e-14),
            method.max_iterations,
            {"mu_strategy": "adaptive"},
            expand=method.expands,
            iteration_callback=callback,
        )
        lower, upper = self.transcription.bounds()
        try:
            with searching():
                result = solver(
                    x0=x0, lbx=lower, ubx=upper, lbg=self._bounds(0), ubg=self._bounds(1)
                )
                x = np.array(result["x"]).ravel()
                message = return_status(solver)
        except KeyboardInterrupt:
            callback.stopped = True
        if callback.stopped:
            point = callback.x
            return Solution(point, float(value(point)), callback.count, "interrupted", True)
        return Solution(x, float(value(x)), callback.count, message)

    def _bounds(self, side: int) -> np.ndarray:
        pairs = [np.full(r.value.numel(), (r.lower, r.upper)[side]) for r in self.rows]
        return np.concatenate(pairs)

    def status(self, solution: Solution, duration: float) -> Status:
        """Status by the residuals, independent of the solver; the message names the largest one."""
        residuals = [self._residual(row, solution.x) for row in self.rows]
        largest = int(np.argmax(residuals))
        solved, message = bool(residuals[largest] <= SOLVED), f"Ipopt: {solution.message}"
        if solution.interrupted:
            message = f"interrupted after {solution.iterations} iterations"
            return Status(Outcome.INTERRUPTED, message, duration, residuals[largest])
        if solved and solution.message in ("solve succeeded", "solved to acceptable level"):
            return Status(Outcome.COMPLETED, message, duration, residuals[largest])
        if not solved:
            message += (
                f"; {self.rows[largest].label} left open by {residuals[largest]:.2g} of its size: "
                "give a better guess, more intervals, a longer duration or wider bounds"
            )
        return Status(Outcome.NOT_CONVERGED, message, duration, residuals[largest])

    def _residual(self, row: Rows, x: np.ndarray) -> float:
        function = ca.Function("value", [self.transcription.unknowns], [row.value])
        value = np.array(function(x)).ravel()
        excess = np.maximum(row.lower - value, value - row.upper)
        return float(np.max(np.nan_to_num(excess, nan=np.inf), initial=0.0))


class _IterationCallback(ca.Callback):
    """Stores the unknowns of the last iteration and reports progress."""

    def __init__(self, n: int, rows: int, size: float, report: OnIteration | None, x0: np.ndarray):
        ca.Callback.__init__(self)
        self.sizes = {"x": n, "f": 1, "g": rows, "lam_x": n, "lam_g": rows, "lam_p": 0}
        self.size, self.report, self.x, self.count = size, report, np.array(x0, dtype=float), -1
        self.stopped = False
        self.construct("watch", {})

    def get_n_in(self) -> int:
        return ca.nlpsol_n_out()

    def get_sparsity_in(self, i: int) -> ca.Sparsity:
        return ca.Sparsity.dense(self.sizes[ca.nlpsol_out(i)], 1)

    def get_n_out(self) -> int:
        return 1

    def eval(self, arguments: Sequence[ca.DM]) -> list[int]:
        outputs = dict(zip(ca.nlpsol_out(), arguments, strict=True))
        self.x = np.array(outputs["x"]).ravel()
        self.count += 1
        try:
            if self.report is not None and self.count:
                self.report(self.count, float(outputs["f"]) * self.size)
        except KeyboardInterrupt:  # CasADi does not propagate it
            self.stopped = True
        return [int(self.stopped)]
