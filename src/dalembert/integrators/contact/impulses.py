"""Impulses of frictional contact: sweeps, semismooth Newton method, proximal point fallback."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dalembert.integrators.contact.compiled_newton import compiled_solution
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.integrators.contact.semismooth_newton import MAX_ITERATIONS, semismooth_newton
from dalembert.integrators.contact.solution_settings import (
    DECREASE,
    FEW_PROXIMAL,
    INCREASE,
    NEWTON_SHARE,
    RESIDUAL_SHARE,
    TOLERANCE_SHARE,
    WEIGHT,
    WEIGHT_MAX,
    WEIGHT_MIN,
)
from dalembert.integrators.contact.sweeps import SWEEPS, swept

ALTERNATIONS, NEWTON_ITERATIONS = 3, 5
"""Upper limits for many contacts: rounds of sweeps and Newton's method; iterations of the latter,
which without friction is not limited further."""
BLOCK_ALTERNATIONS, BLOCK_ITERATIONS, BLOCK_SWEEPS = 6, 30, 60
"""The same where Newton's method factorises the blocks of free bodies, and precedes the sweeps; and
the upper limit of these."""
SWEEP_SHARE = 0.1
"""Tolerance of sweeps relative to that of the problem [-]."""
PROGRESS, PATIENCE, LONG_PATIENCE = 0.9, 40, 100
"""Factor by which the residual of the proximal method has to fall, and the numbers of iterations
within which it has to as long as it is above the tolerance: where it is acceptable, and elsewhere.
"""
LARGEST_SHARE = 1e-3
"""Largest residual relative to the speeds before the impulses: these may be large without effect
where contacts jam [-]."""


@dataclass(frozen=True, eq=False)
class Impulses:
    """Impulses of a contact problem and their residual.

    Attributes
    ----------
    impulses : (n, k)
    residual : largest violation of the conditions [m/s]
    converged : whether the residual is within the tolerance
    rounds : iterations of the proximal method; 0 if Newton's method converged alone
    accepted : whether the residual is acceptable
    """

    impulses: np.ndarray
    residual: float
    converged: bool
    rounds: int = 0
    accepted: bool = True


def solved_impulses(
    problem: FrictionProblem,
    guess: np.ndarray,
    share: float,
    acceptable: float,
    max_iterations: int,
) -> Impulses:
    """Impulses of a problem.

    Parameters
    ----------
    guess : (n, k) initial impulses
    share, acceptable : tolerance, and limit of the residual without progress, relative to the
        largest speed of a contact [-]; neither is above ``LARGEST_SHARE`` of ``problem.scale``
    max_iterations : upper limit of iterations of the proximal method
    """
    allowed = _allowed(problem, guess, share)
    if isinstance(problem.matrix, Delassus):
        if problem.matrix.by_blocks:
            solution = _by_blocks(problem, guess, share, acceptable, max_iterations)
            if solution.converged:
                return solution
            guess = solution.impulses
        guess, residual = _alternating(problem, guess, allowed)
        if residual <= allowed:
            return Impulses(guess, residual, True)
        if problem.matrix.dense is None:
            return _proximal(problem, guess, share, acceptable, max_iterations)
    impulses = semismooth_newton(problem, guess, NEWTON_SHARE * allowed)
    residual = problem.residual(impulses)
    allowed = _allowed(problem, impulses, share)
    if residual <= allowed:
        return Impulses(impulses, residual, True)
    impulses = semismooth_newton(problem, sticking_impulses(problem), NEWTON_SHARE * allowed)
    residual = problem.residual(impulses)
    if residual <= _allowed(problem, impulses, share):
        return Impulses(impulses, residual, True)
    return _proximal(problem, guess, share, acceptable, max_iterations)


def _allowed(problem: FrictionProblem, impulses: np.ndarray, share: float) -> float:
    """Largest residual with a tolerance relative to the largest speed of a contact [m/s]."""
    return min(share * problem.size(impulses), LARGEST_SHARE * problem.scale)


def _by_blocks(problem: FrictionProblem, impulses: np.ndarray, *limits: float | int) -> Impulses:
    """Impulses of free bodies: Newton's method, proximal problems and interior points in machine
    code, otherwise Newton's method and few proximal problems."""
    share, acceptable, max_iterations = limits
    solution = compiled_solution(problem, impulses, share, int(max_iterations))
    if solution is not None:
        impulses, rounds = solution
        residual = problem.residual(impulses)
        converged, accepted = (
            residual <= _allowed(problem, impulses, limit) for limit in (share, acceptable)
        )
        return Impulses(impulses, residual, converged, rounds, accepted)
    allowed = _allowed(problem, impulses, share)
    impulses = semismooth_newton(problem, impulses, NEWTON_SHARE * allowed, BLOCK_ITERATIONS)
    if (residual := problem.residual(impulses)) <= allowed:
        return Impulses(impulses, residual, True)
    few = min(FEW_PROXIMAL, int(max_iterations))
    return _proximal(problem, impulses, share, acceptable, few)


def _alternating(
    problem: FrictionProblem, impulses: np.ndarray, allowed: float
) -> tuple[np.ndarray, float]:
    """Impulses after sweeps and Newton's method in turns, and their residual."""
    assert isinstance(problem.matrix, Delassus)
    alternations, few, sweeps = ALTERNATIONS, NEWTON_ITERATIONS, SWEEPS
    if problem.matrix.by_blocks:
        alternations, few, sweeps = BLOCK_ALTERNATIONS, BLOCK_ITERATIONS, BLOCK_SWEEPS
    few = few if problem.friction.any() else MAX_ITERATIONS
    residual = np.inf
    for number in range(2 * alternations):
        if number % 2:
            trial = semismooth_newton(problem, impulses, NEWTON_SHARE * allowed, few)
        else:
            trial = swept(problem, impulses, SWEEP_SHARE * allowed, sweeps)
        trial_residual = problem.residual(trial)
        if not trial_residual <= problem.scale and residual == np.inf:
            residual = problem.residual(impulses)
        if trial_residual <= max(residual, problem.scale):  # others have diverged
            impulses, residual = trial, trial_residual
        if residual <= allowed:
            break
    return impulses, residual


def _proximal(
    problem: FrictionProblem,
    impulses: np.ndarray,
    share: float,
    acceptable: float,
    max_iterations: int,
) -> Impulses:
    """Impulses by the proximal point method."""

    def limits(impulses: np.ndarray) -> list[float]:
        return [_allowed(problem, impulses, part) for part in (share, acceptable)]

    allowed, limit = limits(impulses)
    weight, residual, rounds, progress = WEIGHT, problem.residual(impulses), 0, 0
    best, least = (impulses, residual), residual
    while best[1] > allowed and rounds < max_iterations and np.isfinite(residual):
        proximal = proximal_problem(problem, impulses, weight)
        tolerance = max(RESIDUAL_SHARE * residual, TOLERANCE_SHARE * allowed)
        start, few = impulses, BLOCK_ITERATIONS
        if not isinstance(problem.matrix, Delassus) or not problem.matrix.by_blocks:
            start, few = swept(proximal, impulses, SWEEP_SHARE * tolerance), MAX_ITERATIONS
        trial = semismooth_newton(proximal, start, tolerance, few)
        solved = proximal.residual(trial) <= tolerance
        changed = weight * (DECREASE if solved else INCREASE)
        weight = min(max(changed, WEIGHT_MIN), WEIGHT_MAX)
        rounds += 1
        if solved or weight == WEIGHT_MAX:
            impulses, residual = trial, problem.residual(trial)
            best = min(best, (impulses, residual), key=lambda pair: pair[1])
            allowed, limit = limits(best[0])
        if best[1] <= PROGRESS * least:
            least, progress = best[1], rounds
        if rounds - progress >= (PATIENCE if best[1] <= limit else LONG_PATIENCE):
            break
    return Impulses(*best, bool(best[1] <= allowed), rounds, bool(best[1] <= limit))


def sticking_impulses(problem: FrictionProblem) -> np.ndarray:
    """Impulses that stop few contacts, the only solution when sliding jams (Painlevé)."""
    change, matrix = -problem.velocity.ravel(), problem.matrix
    if isinstance(matrix, Delassus):
        assert matrix.dense is not None
        matrix = matrix.dense
    if not (np.isfinite(matrix).all() and np.isfinite(change).all()):
        return np.zeros(problem.shape)
    impulses = np.linalg.lstsq(matrix, change, rcond=None)[0]
    return impulses.reshape(problem.shape)


def proximal_problem(
    problem: FrictionProblem, impulses: np.ndarray, weight: float
) -> FrictionProblem:
    """The problem with a proximal term at ``impulses``."""
    diagonal = weight * problem.mobility
    matrix = shifted(problem.matrix, diagonal.ravel())
    return replace(problem, matrix=matrix, velocity=problem.velocity - diagonal * impulses)


def compliant_problem(problem: FrictionProblem, compliance: np.ndarray) -> FrictionProblem:
    """The problem with an addition (n,) to the normal diagonal that is no motion of bodies."""
    if not compliance.any():
        return problem
    diagonal = np.zeros(problem.shape)
    diagonal[:, 0] = compliance
    return replace(problem, matrix=shifted(problem.matrix, diagonal.ravel()), compliance=compliance)


def shifted(matrix: np.ndarray | Delassus, diagonal: np.ndarray) -> np.ndarray | Delassus:
    """The matrix with an addition to its diagonal."""
    return matrix.shifted(diagonal) if isinstance(matrix, Delassus) else matrix + np.diag(diagonal)
