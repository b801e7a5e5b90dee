"""First-order optimality conditions, Lagrange multipliers, and searches repeated until they hold.

``∇f = Jᵀλ_l − Jᵀλ_u + μ_l − μ_u`` with λ, μ ≥ 0 at active sides only (Karush–Kuhn–Tucker), by
non-negative least squares (Lawson & Hanson 1974). The residual verifies an optimum independently of
the status that the optimiser reports.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.optimize.program import FEASIBLE, Point, Program

ACTIVE = 1e-5
"""Scaled distance below which a limit or bound is active [-]."""
OPTIMAL = 1e-3
"""Upper limit of the relative stationarity residual of an optimum [-]."""
ROUNDS = 4
"""Upper limit of the restarts of a search."""
RESCALE = 1e-2
"""Threshold of the scaled objective below which the search is rescaled and restarted [-]."""


@dataclass
class Multipliers:
    """Multipliers of one design, scaled.

    Attributes
    ----------
    residual : (n,) gradient of the Lagrangian
    stationarity : its largest entry, relative to the gradient
    lower, upper : (m,) of the limits
    bound_lower, bound_upper : (n,) of the bounds
    """

    residual: np.ndarray
    stationarity: float
    lower: np.ndarray
    upper: np.ndarray
    bound_lower: np.ndarray
    bound_upper: np.ndarray


def multipliers(program: Program, z: np.ndarray, point: Point) -> Multipliers:
    """Non-negative multipliers of the active set that minimise the Lagrangian gradient."""
    from scipy.optimize import nnls

    tables = np.zeros((2, program.m)), np.zeros((2, program.n))
    columns, targets = [], []
    for side, sign in ((0, 1.0), (1, -1.0)):
        bound = (program.c_lower, program.c_upper)[side]
        for k in np.flatnonzero(abs(point.c - bound) <= ACTIVE):
            columns.append(sign * point.J[k])
            targets.append((tables[0], side, k))
        edge = (program.z_lower, program.z_upper)[side]
        for i in np.flatnonzero(abs(z - edge) <= ACTIVE):
            columns.append(sign * np.eye(program.n)[i])
            targets.append((tables[1], side, i))
    residual = point.g.copy()
    if columns:
        matrix = np.array(columns).T
        sizes = np.maximum(np.linalg.norm(matrix, axis=0), 1e-30)
        weights = nnls(matrix / sizes, point.g)[0] / sizes
        residual = point.g - matrix @ weights
        for (table, side, k), weight in zip(targets, weights, strict=True):
            table[side, k] = weight
    size = max(1.0, float(np.max(abs(point.g), initial=0.0)))
    stationarity = float(np.max(abs(residual), initial=0.0)) / size
    return Multipliers(residual, stationarity, *tables[0], *tables[1])


def why_stuck(program: Program, z: np.ndarray, point: Point, residual: np.ndarray) -> str:
    """Why a search stopped at a non-stationary design, from two short steepest-descent steps.

    The objective may not decrease there (a kink or a jump), or the trial designs may fail. Empty if
    the objective decreases.
    """
    size = float(np.max(abs(residual), initial=0.0))
    for step in (1e-3, 1e-5):
        trial = program.value(z - step * residual / size)
        if trial is None:
            return f"; the designs along it fail: {program.problem.failures[-1]}"
        if trial[0] < point.f - 0.1 * step * float(residual @ residual) / size:
            return ""
    return (
        ", but the objective does not decrease along it: it has a kink or a jump here; use smooth="
    )


def solve_to_stationarity(
    program: Program, method: Optimizer, stop: Stop, z: np.ndarray
) -> OptimizerResult:
    """Solve from ``z``; restart with tighter tolerances while the end is not stationary.

    If that does not help, continue with the method returned by ``method.rescue``.
    """
    initial_count = len(program.history)
    best = method.solve(program, z, stop)
    if method.is_global or best.optima:
        return best
    for round_number in range(1, ROUNDS + 1):
        iterations_left = stop.max_iterations - (len(program.history) - initial_count)
        if iterations_left <= 0 or _is_stationary(program, best.z) or not program.restart(best.z):
            break
        before = program.last
        iterations_used = stop.used + stop.max_iterations - iterations_left
        sharper = Stop(
            iterations_left, max(stop.tolerance * 0.01**round_number, 1e-15), iterations_used
        )
        finishing = method.finishing()
        outcome = finishing.solve(program, best.z, sharper)
        if finishing is not method:  # the search itself reports its extent
            outcome = replace(outcome, message=best.message, is_complete=best.is_complete)
        after = program.objective(outcome.z)
        if after < before or outcome.success:
            best = outcome
        if not after < before - 1e-3 * abs(before) and _is_feasible(program, best.z):
            break
    rescue = method.rescue()
    if rescue is None or not _is_stuck(program, best.z):
        return best
    iterations_left = stop.max_iterations - (len(program.history) - initial_count)
    return _rescue(
        program,
        rescue,
        Stop(max(iterations_left, 1), stop.tolerance, stop.max_iterations - iterations_left),
        best,
    )


def _rescue(
    program: Program, method: Optimizer, stop: Stop, best: OptimizerResult
) -> OptimizerResult:
    """Outcome of another method from the end of the first, if that is better."""
    if not program.restart(best.z):
        return best
    outcome = method.solve(program, best.z, stop)
    values = [
        program.problem.evaluate(program.unscale(end.z), gradient=False) for end in (outcome, best)
    ]
    if values[0] is None or values[1] is None:
        return best
    if not program.is_better(values[0].values, values[1].values):
        return best
    return replace(outcome, message=f"{best.message}, but {outcome.message}")


def _is_stuck(program: Program, z: np.ndarray) -> bool:
    """Whether the design is not optimal though better designs nearby can be run."""
    point = program.point(z, record=False)
    if point is None:
        return False
    if not _is_feasible(program, z):
        return True
    kkt = multipliers(program, z, point)
    return kkt.stationarity > OPTIMAL and not why_stuck(program, z, point, kkt.residual)


def _is_feasible(program: Program, z: np.ndarray) -> bool:
    evaluation = program.problem.evaluate(program.unscale(z), gradient=False)
    return evaluation is not None and program.violation(evaluation.values) <= FEASIBLE


def _is_stationary(program: Program, z: np.ndarray) -> bool:
    point = program.point(z, record=False)
    if point is None or abs(point.f) < RESCALE or not _is_feasible(program, z):
        return False
    return multipliers(program, z, point).stationarity <= OPTIMAL
