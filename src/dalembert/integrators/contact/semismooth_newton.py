"""Semismooth Newton method for frictional contact impulses."""

from __future__ import annotations

import numpy as np

from dalembert.integrators.contact.compiled_newton import FILES, OVERSHOOT, compiled_newton
from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus
from dalembert.integrators.contact.machine_code import machine_code
from dalembert.integrators.contact.places import Settings

MAX_ITERATIONS, STEP_FRACTIONS = 100, (1.0, 0.5, 0.25, 0.125)
REGULARIZATION = 1e-9
"""Regularisation relative to the mobility, so that nonunique impulses stay close to the old [-]."""


def semismooth_newton(
    problem: FrictionProblem,
    impulses: np.ndarray,
    tolerance: float,
    max_iterations: int = MAX_ITERATIONS,
) -> np.ndarray:
    """Solve ``P = proj(P − ρ u)`` from initial impulses (Alart & Curnier 1991).

    Contacts without pressure are not part of the linear equations. The iteration ends when the
    residual is within the tolerance, or when no step reduces the merit function.
    """
    operator = problem.matrix
    if isinstance(operator, Delassus) and machine_code(*FILES) is not None:
        settings = {
            Settings.TOLERANCE: tolerance,
            Settings.REGULARIZATION: REGULARIZATION,
            Settings.OVERSHOOT: OVERSHOOT,
        }
        return compiled_newton(problem, operator, impulses, settings, max_iterations)
    merit = _merit(problem, impulses)
    for _ in range(max_iterations):
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
    z = impulses - problem.speeds(impulses) / problem.mobility
    dz = step - (problem.matrix @ step.ravel()).reshape(problem.shape) / problem.mobility
    minimum = problem.minimum
    pressed = z[:, 0] > minimum
    radius, change = np.where(pressed, z[:, 0], minimum), np.where(pressed, dz[:, 0], 0.0)
    with np.errstate(all="ignore"):
        roots = [(minimum - z[:, 0]) / dz[:, 0]]
        for components, friction in problem.discs:
            x, dx, squares = z[:, components], dz[:, components], friction**2
            a = np.sum(dx**2, axis=1) - squares * change**2
            b = 2 * (np.sum(x * dx, axis=1) - squares * radius * change)
            c = np.sum(x**2, axis=1) - squares * radius**2
            root = np.sqrt(b**2 - 4 * a * c)
            roots += [(-b - root) / (2 * a), (-b + root) / (2 * a)]
    fractions = np.concatenate(roots)
    positive = fractions[np.isfinite(fractions) & (fractions > OVERSHOOT)]
    return float(min(positive.min(initial=1.0) * (1 + OVERSHOOT), 1.0))


def _merit(problem: FrictionProblem, impulses: np.ndarray) -> float:
    """Merit function: norm of the violation of the conditions [J^½]."""
    violation = impulses - problem.project(impulses, problem.speeds(impulses))
    return float(np.linalg.norm(violation * np.sqrt(problem.mobility)))


def _step(problem: FrictionProblem, impulses: np.ndarray) -> np.ndarray | None:
    """Newton step on the current pieces; None if the matrix is singular."""
    speeds, mobility = problem.speeds(impulses), problem.mobility
    residual = problem.project(impulses, speeds) - impulses
    step, z = residual.copy(), impulses - speeds / mobility
    active = np.flatnonzero((z[:, 0] > problem.minimum) | (problem.minimum > 0))
    if not active.size:
        return step
    k = problem.shape[1]
    own, coupled = pieces(problem, z, active)
    rows = (active[:, None] * k + np.arange(k)).ravel()
    inactive = step.copy()
    inactive[active] = 0.0
    change = (problem.matrix @ inactive.ravel())[rows].reshape(-1, k)
    own = own + REGULARIZATION * coupled * mobility[active, None, :]
    right = residual[active] - np.einsum("aij,aj->ai", coupled, change)
    try:
        step[active] = active_impulses(problem.matrix, rows.reshape(-1, k), own, coupled, right)
    except np.linalg.LinAlgError:
        return None
    return step if np.isfinite(step).all() else None


def pieces(
    problem: FrictionProblem, z: np.ndarray, active: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives (n, k, k) of ``P − proj z``, ``z = P − ρ u``, by ``P`` and ``u`` for active
    contacts.

    Each group sticks, ``ρ u``, or slips along ``d = z_T/|z_T|``: ``P_T − μ z_N d``. Where ``z_N``
    is below the minimum of ``P_N``, the minimum replaces it.
    """
    k, size, mobility = problem.shape[1], active.size, problem.mobility[active]
    minimum = np.broadcast_to(problem.minimum, z.shape[:1])[active]
    pressed = z[active, 0] > minimum
    pressure = np.where(pressed, z[active, 0], minimum)
    own, coupled = np.zeros((size, k, k)), np.zeros((size, k, k))
    own[:, 0, 0], coupled[:, 0, 0] = ~pressed, pressed / mobility[:, 0]
    for components, coefficients in problem.discs:
        tangential, friction = z[active, components], coefficients[active]
        length, radius = np.linalg.norm(tangential, axis=1), friction * pressure
        slips = (length > radius) | (friction == 0)
        length = np.where(length > 0, length, 1.0)
        direction, eye = tangential / length[:, None], np.eye(tangential.shape[1])
        across = eye - direction[:, :, None] * direction[:, None, :]
        slip = np.where(slips[:, None, None], eye - (radius / length)[:, None, None] * across, 0.0)
        own[:, components, components] = slip
        along = mobility[:, components.start]
        coupled[:, components, components] = (eye - slip) / along[:, None, None]
        limit = np.where(slips & pressed, friction, 0.0)[:, None] * direction
        own[:, components, 0] = -limit
        coupled[:, components, 0] = limit / mobility[:, :1]
    return own, coupled


def active_impulses(
    matrix: np.ndarray | Delassus,
    rows: np.ndarray,
    own: np.ndarray,
    coupled: np.ndarray,
    right: np.ndarray,
) -> np.ndarray:
    """``(own + coupled H) P = right`` for contacts ``rows`` (n, k), with blocks (n, k, k).

    Raises
    ------
    numpy.linalg.LinAlgError
        The matrix is singular.
    """
    if isinstance(matrix, Delassus):
        if matrix.dense is None:
            return matrix.active_impulses(rows, own, coupled, right)
        matrix = matrix.dense
    size, k = rows.shape
    flat = rows.ravel()
    block = matrix[flat[:, None], flat].reshape(size, k, size, k)
    system = np.einsum("aij,ajbl->aibl", coupled, block)
    system[np.arange(size), :, np.arange(size), :] += own
    solution = np.linalg.solve(system.reshape(size * k, size * k), right.ravel())
    return np.asarray(solution).reshape(size, k)
