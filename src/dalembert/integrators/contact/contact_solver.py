"""Impulses of contacts with friction: Newton's method, and its proximal form where it fails."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.friction_problem import FrictionProblem
from dalembert.integrators.contact.semismooth_newton import semismooth_newton
from dalembert.options import options

WEIGHT, STRONGER, WEAKER, MOST, LEAST = 0.01, 4.0, 0.3, 1.0, 1e-11
"""Of the nearness to the impulses before: at first, after a failure, after a success, at most, at
least."""
SHARE, ENOUGH = 0.01, 0.3
"""Residual of a proximal problem, as a share of that of the problem itself and of the tolerance."""


@dataclass(frozen=True, eq=False)
class Impulses:
    """What a solver found.

    Attributes
    ----------
    impulses : (n, k)
    residual : largest speed by which the conditions are missed [m/s]
    converged : the residual is within the tolerance
    rounds : of the proximal method; 0 where Newton's alone was enough
    """

    impulses: np.ndarray
    residual: float
    converged: bool
    rounds: int = 0


@options
class ContactSolver:
    """Semismooth Newton (Alart & Curnier 1991) from the impulses of the step before.

    Where it gets stuck the proximal point method follows: again and again the same problem with
    ``H + α D`` and ``b − α D P``, ``D`` the diagonal of ``H``, whose solution is the next ``P``.
    Its problems are definite, so that Newton's method solves them, and its limit solves the one
    given (Acary, Brémond & Huber 2018).

    Parameters
    ----------
    tolerance : largest residual, relative to the largest speed of a contact
    max_iterations : rounds of the proximal method

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("landing", gravity=(0, -10))
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.3)))
    >>> floor = (system.ground.center, (0, 1))
    >>> hits = system.add(planar.Collisions("hits", [(ball.center, 0.1)], [floor]))
    >>> solver = da.ContactSolver(tolerance=1e-12)
    >>> motion = da.solve_nonsmooth(system.build(), 0.5, step=0.01, solver=solver)
    >>> round(float(motion.impulse("hits").sum()), 6)  # m g t: all that gravity gave
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
        """Impulses of a problem, from ``start`` if given."""
        begun = np.zeros(problem.shape) if start is None else start
        allowed = self.tolerance * problem.size(begun)
        found = semismooth_newton(problem, begun, allowed)
        left = problem.residual(found)
        allowed = self.tolerance * problem.size(found)
        if left <= allowed:
            return Impulses(found, left, True)
        stuck = semismooth_newton(problem, sticking(problem), allowed)
        left = problem.residual(stuck)
        if left <= self.tolerance * problem.size(stuck):
            return Impulses(stuck, left, True)
        return self._proximal(problem, begun, self.tolerance * problem.size(begun))

    def _proximal(self, problem: FrictionProblem, found: np.ndarray, allowed: float) -> Impulses:
        weight, left, rounds = WEIGHT, problem.residual(found), 0
        best = found, left
        while best[1] > allowed and rounds < self.max_iterations and np.isfinite(left):
            near = nearer(problem, found, weight)
            wanted = max(SHARE * left, ENOUGH * allowed)
            tried = semismooth_newton(near, found, wanted)
            solved = near.residual(tried) <= wanted
            weight = max(weight * WEAKER, LEAST) if solved else min(weight * STRONGER, MOST)
            rounds += 1
            if solved or weight == MOST:
                found, left = tried, problem.residual(tried)
                best = min(best, (found, left), key=lambda pair: pair[1])
        return Impulses(*best, bool(best[1] <= allowed), rounds)


def sticking(problem: FrictionProblem) -> np.ndarray:
    """Impulses that stop all contacts: where friction jams sliding (Painlevé) no others may do."""
    wanted = -problem.velocity.ravel()
    if not (np.isfinite(problem.matrix).all() and np.isfinite(wanted).all()):
        return np.zeros(problem.shape)
    found = np.linalg.lstsq(problem.matrix, wanted, rcond=None)[0]
    return found.reshape(problem.shape)


def nearer(problem: FrictionProblem, impulses: np.ndarray, weight: float) -> FrictionProblem:
    """The problem with a share of the way back to some impulses."""
    normal, along = problem.mobility
    diagonal = weight * np.column_stack([normal, *[along] * (problem.shape[1] - 1)])
    matrix = problem.matrix.copy()
    matrix[np.diag_indices_from(matrix)] += diagonal.ravel()
    return replace(problem, matrix=matrix, velocity=problem.velocity - diagonal * impulses)
