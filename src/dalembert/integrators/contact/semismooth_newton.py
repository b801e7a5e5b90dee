"""Semismooth Newton method for frictional contact impulses."""

from __future__ import annotations

import numpy as np

from dalembert.integrators.contact.contacts import FrictionProblem
from dalembert.integrators.contact.delassus import Delassus

MAX_ITERATIONS, STEP_FRACTIONS = 100, (1.0, 0.5, 0.25, 0.125)
OVERSHOOT = 1e-9
"""Relative overshoot of a step beyond a change of piece [-]."""
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
    own, coupled = pieces(problem, impulses, speeds, active)
    rows = (active[:, None] * k + np.arange(k)).ravel()
    inactive = step.copy()
    inactive[active] = 0.0
    change = (problem.matrix @ inactive.ravel())[rows].reshape(-1, k)
    mobility = np.column_stack([normal[active], np.tile(along[active, None], k - 1)])
    own = own + REGULARIZATION * coupled * mobility[:, None, :]
    right = residual[active] - np.einsum("aij,aj->ai", coupled, change)
    try:
        step[active] = active_impulses(problem.matrix, rows.reshape(-1, k), own, coupled, right)
    except np.linalg.LinAlgError:
        return None
    return step if np.isfinite(step).all() else None


def pieces(
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
