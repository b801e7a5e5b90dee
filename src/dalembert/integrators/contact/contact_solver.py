"""Solver for frictional contact impulses: semismooth Newton with proximal point fallback."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.options import options

MAX_ITERATIONS, STEP_FRACTIONS = 100, (1.0, 0.5, 0.25, 0.125)
OVERSHOOT = 1e-9
"""Relative overshoot of a step beyond a change of piece [-]."""
REGULARIZATION = 1e-9
"""Regularisation relative to the mobility, so that nonunique impulses stay close to the old [-]."""


def semismooth_newton(
    problem: FrictionProblem, impulses: np.ndarray, tolerance: float
) -> np.ndarray:
    """Solve ``P = proj(P − ρ u)`` from initial impulses (Alart & Curnier 1991).

    Contacts without pressure are not part of the linear equations. The iteration ends when the
    residual is within the tolerance, or when no step reduces the merit function.
    """
    merit = _merit(problem, impulses)
    for _ in range(MAX_ITERATIONS):
        if not problem.residual(impulses) > tolerance:
            break
        step = _step(problem, impulses)
        if step is None:
            break
        impulses, new_merit = _line_search(problem, impulses, step, merit)
        if not new_merit < merit:
            break
        merit = new_merit
    return impulses


def _line_search(
    problem: FrictionProblem, impulses: np.ndarray, step: np.ndarray, merit: float
) -> tuple[np.ndarray, float]:
    """Impulses after the longest fraction of a step that reduces the merit, and their merit."""
    for fraction in STEP_FRACTIONS:
        trial = impulses + fraction * step
        new_merit = _merit(problem, trial)
        if new_merit < merit:
            return trial, new_merit
    trial = impulses + _first_change(problem, impulses, step) * step
    new_merit = _merit(problem, trial)
    return (trial, new_merit) if new_merit < merit else (impulses, merit)


def _first_change(problem: FrictionProblem, impulses: np.ndarray, step: np.ndarray) -> float:
    """Fraction of a step at which the first contact changes its piece.

    Up to there the step solves the equations. Steps may be long if impulses are not unique, and
    end there.
    """
    z = _argument(problem, impulses, problem.speeds(impulses))
    dz = _argument(problem, step, (problem.matrix @ step.ravel()).reshape(problem.shape))
    squares = problem.friction**2
    a = np.sum(dz[:, 1:] ** 2, axis=1) - squares * dz[:, 0] ** 2
    b = 2 * (np.sum(z[:, 1:] * dz[:, 1:], axis=1) - squares * z[:, 0] * dz[:, 0])
    c = np.sum(z[:, 1:] ** 2, axis=1) - squares * z[:, 0] ** 2
    with np.errstate(all="ignore"):
        root = np.sqrt(b**2 - 4 * a * c)
        roots = [-z[:, 0] / dz[:, 0], (-b - root) / (2 * a), (-b + root) / (2 * a)]
    fractions = np.concatenate(roots)
    positive = fractions[np.isfinite(fractions) & (fractions > OVERSHOOT)]
    return float(min(positive.min(initial=1.0) * (1 + OVERSHOOT), 1.0))


def _argument(problem: FrictionProblem, impulses: np.ndarray, speeds: np.ndarray) -> np.ndarray:
    """``z = P − ρ u``, the argument of the projection, which selects the piece."""
    normal, along = problem.mobility
    sizes = np.column_stack([normal, *[along] * (problem.shape[1] - 1)])
    return impulses - speeds / sizes


def _merit(problem: FrictionProblem, impulses: np.ndarray) -> float:
    """Merit function: norm of the violation of the conditions [J^½]."""
    violation = impulses - problem.project(impulses, problem.speeds(impulses))
    return float(np.linalg.norm(violation * np.sqrt(problem.mobility[0])[:, None]))


def _step(problem: FrictionProblem, impulses: np.ndarray) -> np.ndarray | None:
    """Newton step on the current pieces; None if the matrix is singular."""
    speeds = problem.speeds(impulses)
    normal, along = problem.mobility
    residual = problem.project(impulses, speeds) - impulses
    step = residual.copy()
    active = np.flatnonzero(impulses[:, 0] - speeds[:, 0] / normal > 0)
    if not active.size:
        return step
    k = problem.shape[1]
    own, coupled = _pieces(problem, impulses, speeds, active)
    rows = (active[:, None] * k + np.arange(k)).ravel()
    inactive = step.copy()
    inactive[active] = 0.0
    block = problem.matrix[rows]
    change = (block @ inactive.ravel()).reshape(-1, k)
    matrix = block[:, rows]
    mobility = np.column_stack([normal[active], np.tile(along[active, None], k - 1)])
    matrix[np.diag_indices_from(matrix)] += REGULARIZATION * mobility.ravel()
    size = active.size
    system = np.einsum("aij,ajbl->aibl", coupled, matrix.reshape(size, k, size, k))
    system[np.arange(size), :, np.arange(size), :] += own
    right = residual[active] - np.einsum("aij,aj->ai", coupled, change)
    try:
        solution = np.linalg.solve(system.reshape(size * k, size * k), right.ravel())
    except np.linalg.LinAlgError:
        return None
    step[active] = solution.reshape(size, k)
    return step if np.isfinite(step).all() else None


def _pieces(
    problem: FrictionProblem, impulses: np.ndarray, speeds: np.ndarray, active: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives (n, k, k) of ``P − proj(P − ρ u)`` by ``P`` and ``u`` for active contacts.

    They stick, ``ρ u``, or slip along ``d = z/|z|`` with ``z = P_T − ρ u_T``: ``P_T − μ z_N d``.
    """
    k, (normal, along) = problem.shape[1], problem.mobility
    size, friction = active.size, problem.friction[active]
    own, coupled = np.zeros((size, k, k)), np.zeros((size, k, k))
    coupled[:, 0, 0] = 1 / normal[active]
    if k == 1:
        return own, coupled
    pressure = impulses[active, 0] - speeds[active, 0] / normal[active]
    tangential = impulses[active, 1:] - speeds[active, 1:] / along[active, None]
    length, radius = np.linalg.norm(tangential, axis=1), friction * pressure
    slips = (length > radius) | (friction == 0)
    direction = tangential / np.where(length > 0, length, 1.0)[:, None]
    normal_plane = np.eye(k - 1) - direction[:, :, None] * direction[:, None, :]
    rotation = (
        normal_plane
        * np.where(length > 0, radius / np.where(length > 0, length, 1.0), 0.0)[:, None, None]
    )
    slip = np.where(slips[:, None, None], np.eye(k - 1) - rotation, 0.0)
    own[:, 1:, 1:] = slip
    coupled[:, 1:, 1:] = (np.eye(k - 1) - slip) / along[active, None, None]
    limit = np.where(slips, friction, 0.0)[:, None] * direction
    own[:, 1:, 0] = -limit
    coupled[:, 1:, 0] = limit / normal[active, None]
    return own, coupled


WEIGHT, INCREASE, DECREASE, WEIGHT_MAX, WEIGHT_MIN = 0.01, 4.0, 0.3, 1.0, 1e-11
"""Proximal weight: initial value, factors after failure and success, upper and lower limit [-]."""
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

    def _proximal(self, problem: FrictionProblem, impulses: np.ndarray, allowed: float) -> Impulses:
        weight, residual, rounds = WEIGHT, problem.residual(impulses), 0
        best = impulses, residual
        while best[1] > allowed and rounds < self.max_iterations and np.isfinite(residual):
            proximal = proximal_problem(problem, impulses, weight)
            tolerance = max(RESIDUAL_SHARE * residual, TOLERANCE_SHARE * allowed)
            trial = semismooth_newton(proximal, impulses, tolerance)
            solved = proximal.residual(trial) <= tolerance
            changed = weight * (DECREASE if solved else INCREASE)
            weight = min(max(changed, WEIGHT_MIN), WEIGHT_MAX)
            rounds += 1
            if solved or weight == WEIGHT_MAX:
                impulses, residual = trial, problem.residual(trial)
                best = min(best, (impulses, residual), key=lambda pair: pair[1])
        return Impulses(*best, bool(best[1] <= allowed), rounds)


def sticking_impulses(problem: FrictionProblem) -> np.ndarray:
    """Impulses that stop all contacts, the only solution when sliding jams (Painlevé)."""
    change = -problem.velocity.ravel()
    if not (np.isfinite(problem.matrix).all() and np.isfinite(change).all()):
        return np.zeros(problem.shape)
    impulses = np.linalg.lstsq(problem.matrix, change, rcond=None)[0]
    return impulses.reshape(problem.shape)


def proximal_problem(
    problem: FrictionProblem, impulses: np.ndarray, weight: float
) -> FrictionProblem:
    """The problem with a proximal term at ``impulses``."""
    normal, along = problem.mobility
    diagonal = weight * np.column_stack([normal, *[along] * (problem.shape[1] - 1)])
    matrix = problem.matrix.copy()
    matrix[np.diag_indices_from(matrix)] += diagonal.ravel()
    return replace(problem, matrix=matrix, velocity=problem.velocity - diagonal * impulses)
