"""Repeated search with tighter tolerances until first-order optimality holds or progress ends."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.design.methods.base import Optimizer, OptimizerResult, Stop
from dalembert.design.optimize.optimality import OPTIMAL, multipliers, why_stuck
from dalembert.design.optimize.program import FEASIBLE, Program

ROUNDS = 4
"""Upper limit of the restarts of a search."""
FALL = 1e-2
"""Threshold of the scaled objective below which the search is rescaled and restarted [-]."""


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
        if iterations_left <= 0 or _is_stationary(program, best.z) or not program.begin(best.z):
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
    if not program.begin(best.z):
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
    if point is None or abs(point.f) < FALL or not _is_feasible(program, z):
        return False
    return multipliers(program, z, point).stationarity <= OPTIMAL
