"""The programme of a trajectory solved by Ipopt, with exact first and second derivatives."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.design.trajectory.collocation import DirectCollocation
from dalembert.design.trajectory.transcription import Rows, Transcription
from dalembert.results.status import Outcome, Status

SOLVED = 1e-6
"""Largest residual of a plan, in natural sizes."""


def solved(
    transcription: Transcription,
    objective: ca.MX,
    rows: list[Rows],
    x0: np.ndarray,
    method: DirectCollocation,
) -> tuple[np.ndarray, int, str]:
    """The unknowns that Ipopt ends with, its iterations and what it says."""
    unknowns = transcription.unknowns
    first = float(ca.Function("first", [unknowns], [objective])(x0))
    size = max(abs(first), 1e-3) if np.isfinite(first) else 1.0
    value = ca.vertcat(*(ca.vec(row.value) for row in rows))
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
    problem = {"x": unknowns, "f": objective / size, "g": value}
    solver = ca.nlpsol("trajectory", "ipopt", problem, settings)
    lower, upper = transcription.bounds()
    found = solver(x0=x0, lbx=lower, ubx=upper, lbg=_ends(rows, 0), ubg=_ends(rows, 1))
    told = solver.stats()
    message = str(told["return_status"]).replace("_", " ").lower()
    return np.array(found["x"]).ravel(), int(told["iter_count"]), message


def _ends(rows: list[Rows], side: int) -> np.ndarray:
    return np.concatenate([np.full(r.value.numel(), (r.lower, r.upper)[side]) for r in rows])


def judged(
    transcription: Transcription, rows: list[Rows], x: np.ndarray, told: str, duration: float
) -> Status:
    """Judged by the residuals, whatever the solver says; the worst of them has a name."""
    sums = [_broken(row, transcription.unknowns, x) for row in rows]
    worst = int(np.argmax(sums))
    kept = bool(sums[worst] <= SOLVED)
    if kept and told in ("solve succeeded", "solved to acceptable level"):
        return Status(Outcome.COMPLETED, f"Ipopt: {told}", duration, sums[worst])
    message = f"Ipopt: {told}"
    if not kept:
        message += (
            f"; {rows[worst].label} left open by {sums[worst]:.2g} of its size: give a better "
            "guess, more intervals, a longer duration or wider bounds"
        )
    return Status(Outcome.NOT_CONVERGED, message, duration, sums[worst])


def _broken(row: Rows, unknowns: ca.MX, x: np.ndarray) -> float:
    value = np.array(ca.Function("value", [unknowns], [row.value])(x)).ravel()
    over = np.maximum(row.lower - value, value - row.upper)
    return float(np.max(np.nan_to_num(over, nan=np.inf), initial=0.0))
