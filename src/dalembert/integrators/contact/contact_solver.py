"""Solver for frictional contact impulses: sweeps, semismooth Newton, proximal point fallback."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.integrators.contact.semismooth_newton import MAX_ITERATIONS, semismooth_newton
from dalembert.integrators.contact.sweeps import swept
from dalembert.options import options

WEIGHT, INCREASE, DECREASE, WEIGHT_MAX, WEIGHT_MIN = 0.01, 4.0, 0.3, 1.0, 1e-11
"""Proximal weight: initial value, factors after failure and success, upper and lower limit [-]."""
ALTERNATIONS, NEWTON_ITERATIONS = 20, 5
"""Upper limits for many contacts: rounds of sweeps and Newton's method; iterations of the latter,
which without friction is not limited further."""
SWEEP_SHARE = 0.1
"""Tolerance of sweeps relative to that of the problem [-]."""
RESIDUAL_SHARE, TOLERANCE_SHARE = 0.01, 0.3
"""Tolerance of a proximal problem relative to the residual and to the tolerance of the original
problem; the larger one counts [-]."""


@dataclass(frozen=True, eq=False)
class Impulses:
    """Impulses of a contact problem and their residual.

    Attributes
    ----------
    impulses : (n, k)
    residual : largest violation of the conditions [m/s]
    converged : whether the residual is within the tolerance
    rounds : iterations of the proximal method; 0 if Newton's method converged alone
    """

    impulses: np.ndarray
    residual: float
    converged: bool
    rounds: int = 0


@options
class ContactSolver:
    """Semismooth Newton method (Alart & Curnier 1991), started from the previous impulses.

    For many contacts accelerated Gauss–Seidel sweeps precede it and alternate with it.

    If it stagnates, the proximal point method follows: it solves a sequence of problems with
    ``H + α D`` and ``b − α D P``, ``D`` the diagonal of ``H``, whose solution is the next ``P``.
    These problems are definite, so that Newton's method converges, and their limit solves the
    original problem (Acary, Brémond & Huber 2018).

    Parameters
    ----------
    tolerance : upper limit of the residual, relative to the largest speed of a contact [-]
    max_iterations : upper limit of iterations of the proximal method

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("landing", gravity=(0, -10))
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.3)))
    >>> contact = planar.contact
    >>> shapes = [contact.Circle(ball.center, 0.1), contact.HalfPlane(system.ground.center)]
    >>> hits = system.add(planar.Collisions("hits", shapes))
    >>> solver = da.ContactSolver(tolerance=1e-12)
    >>> motion = da.solve_nonsmooth(system.build(), 0.5, step=0.01, solver=solver)
    >>> round(float(motion.impulse("hits").sum()), 6)  # m g t, the impulse of gravity
    5.0
    """

    tolerance: float = 1e-9
    max_iterations: int = 500

    def __post_init__(self) -> None:
        if not 0 < self.tolerance < 1:
            text = f"ContactSolver(tolerance={self.tolerance}): give a share such as 1e-9"
            raise UnsupportedError(text)
        if self.max_iterations < 0:
            text = f"ContactSolver(max_iterations={self.max_iterations}): give 0 or more"
            raise UnsupportedError(text)

    def solve(self, problem: FrictionProblem, start: np.ndarray | None = None) -> Impulses:
        """Impulses of a problem, from an initial guess ``start``, zero by default."""
        guess = np.zeros(problem.shape) if start is None else start
        allowed = self.tolerance * problem.size(guess)
        if isinstance(problem.matrix, Delassus):
            guess, residual = self._alternating(problem, guess, allowed)
            if residual <= allowed:
                return Impulses(guess, residual, True)
            if problem.matrix.dense is None:
                return self._proximal(problem, guess, self.tolerance * problem.size(guess))
        impulses = semismooth_newton(problem, guess, allowed)
        residual = problem.residual(impulses)
        allowed = self.tolerance * problem.size(impulses)
        if residual <= allowed:
            return Impulses(impulses, residual, True)
        impulses = semismooth_newton(problem, sticking_impulses(problem), allowed)
        residual = problem.residual(impulses)
        if residual <= self.tolerance * problem.size(impulses):
            return Impulses(impulses, residual, True)
        return self._proximal(problem, guess, self.tolerance * problem.size(guess))

    def _alternating(
        self, problem: FrictionProblem, impulses: np.ndarray, allowed: float
    ) -> tuple[np.ndarray, float]:
        """Impulses after sweeps and Newton's method in turns, and their residual."""
        few = NEWTON_ITERATIONS if problem.friction.any() else MAX_ITERATIONS
        for _ in range(ALTERNATIONS):
            impulses = swept(problem, impulses, SWEEP_SHARE * allowed)
            if (residual := problem.residual(impulses)) <= allowed:
                break
            impulses = semismooth_newton(problem, impulses, allowed, few)
            if (residual := problem.residual(impulses)) <= allowed:
                break
        return impulses, residual

    def _proximal(self, problem: FrictionProblem, impulses: np.ndarray, allowed: float) -> Impulses:
        weight, residual, rounds = WEIGHT, problem.residual(impulses), 0
        best = impulses, residual
        while best[1] > allowed and rounds < self.max_iterations and np.isfinite(residual):
            proximal = proximal_problem(problem, impulses, weight)
            tolerance = max(RESIDUAL_SHARE * residual, TOLERANCE_SHARE * allowed)
            start = swept(proximal, impulses, SWEEP_SHARE * tolerance)
            trial = semismooth_newton(proximal, start, tolerance)
            solved = proximal.residual(trial) <= tolerance
            changed = weight * (DECREASE if solved else INCREASE)
            weight = min(max(changed, WEIGHT_MIN), WEIGHT_MAX)
            rounds += 1
            if solved or weight == WEIGHT_MAX:
                impulses, residual = trial, problem.residual(trial)
                best = min(best, (impulses, residual), key=lambda pair: pair[1])
        return Impulses(*best, bool(best[1] <= allowed), rounds)


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
    normal, along = problem.mobility
    diagonal = weight * np.column_stack([normal, *[along] * (problem.shape[1] - 1)])
    matrix = problem.matrix
    if isinstance(matrix, Delassus):
        matrix = matrix.shifted(diagonal.ravel())
    else:
        matrix = matrix + np.diag(diagonal.ravel())
    return replace(problem, matrix=matrix, velocity=problem.velocity - diagonal * impulses)
