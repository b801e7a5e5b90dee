"""A search that goes on until gradients say that it is at an optimum, or nothing more is gained."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.design.methods.base import Ended, Optimizer, Stop
from dalembert.design.optimize.optimality import OPTIMAL, multipliers, why_stuck
from dalembert.design.optimize.program import FEASIBLE, Program

ROUNDS = 4
"""How often a search goes on."""
FALL = 1e-2
"""Fall of the objective from which its scale, and so the tolerance, is measured anew."""


def settled(program: Program, method: Optimizer, stop: Stop, z: np.ndarray) -> Ended:
    """Where a method ends from ``z``, taken up again with sharper tolerances if stuck.

    If that does not help, the method that it names goes on.
    """
    used = len(program.history)
    ended = method.solve(program, z, stop)
    if method.is_global or ended.optima:
        return ended
    for number in range(1, ROUNDS + 1):
        left = stop.max_iterations - (len(program.history) - used)
        if left <= 0 or _is_settled(program, ended.z) or not program.begin(ended.z):
            break
        before = program.last
        spent = stop.used + stop.max_iterations - left
        sharper = Stop(left, max(stop.tolerance * 0.01**number, 1e-15), spent)
        finishing = method.finishing()
        found = finishing.solve(program, ended.z, sharper)
        if finishing is not method:  # what was searched is said by the search
            found = replace(found, message=ended.message, is_whole=ended.is_whole)
        after = program.objective(found.z)
        if after < before or found.success:
            ended = found
        if not after < before - 1e-3 * abs(before) and _is_feasible(program, ended.z):
            break
    rescue = method.rescue()
    if rescue is None or not _is_stuck(program, ended.z):
        return ended
    left = stop.max_iterations - (len(program.history) - used)
    return _rescued(
        program, rescue, Stop(max(left, 1), stop.tolerance, stop.max_iterations - left), ended
    )


def _rescued(program: Program, method: Optimizer, stop: Stop, ended: Ended) -> Ended:
    """Where another method ends from there, if that is better."""
    if not program.begin(ended.z):
        return ended
    found = method.solve(program, ended.z, stop)
    values = [
        program.problem.evaluate(program.unscale(e.z), gradient=False) for e in (found, ended)
    ]
    if values[0] is None or values[1] is None:
        return ended
    if not program.is_better(values[0].values, values[1].values):
        return ended
    return replace(found, message=f"{ended.message}, but {found.message}")


def _is_stuck(program: Program, z: np.ndarray) -> bool:
    """No optimum, though designs nearby can be run and are better."""
    point = program.point(z, record=False)
    if point is None:
        return False
    if not _is_feasible(program, z):
        return True
    left = multipliers(program, z, point)
    return left.stationarity > OPTIMAL and not why_stuck(program, z, point, left.residual)


def _is_feasible(program: Program, z: np.ndarray) -> bool:
    found = program.problem.evaluate(program.unscale(z), gradient=False)
    return found is not None and program.violation(found.values) <= FEASIBLE


def _is_settled(program: Program, z: np.ndarray) -> bool:
    point = program.point(z, record=False)
    if point is None or abs(point.f) < FALL or not _is_feasible(program, z):
        return False
    return multipliers(program, z, point).stationarity <= OPTIMAL
