"""Newton's method on the conditions of contact, which are smooth piece by piece."""

from __future__ import annotations

import numpy as np

from dalembert.integrators.contact.friction_problem import FrictionProblem

ROUNDS, HALVINGS = 100, (1.0, 0.5, 0.25, 0.125)
JUST = 1e-9
"""How far beyond a change of pieces a step goes, as a share."""
SOFTNESS = 1e-9
"""Share of the mobility added to it, so that impulses that are not unique keep near the old."""


def semismooth_newton(
    problem: FrictionProblem, impulses: np.ndarray, tolerance: float
) -> np.ndarray:
    """From some impulses to where ``P = proj(P − ρ u)`` (Alart & Curnier 1991).

    Contacts that do not press take no part in the linear equations. Ends where the residual is
    small enough, or where no step reduces it.
    """
    found, left = impulses, _missed(problem, impulses)
    for _ in range(ROUNDS):
        if not problem.residual(found) > tolerance:
            break
        step = _step(problem, found)
        if step is None:
            break
        found, after = _advanced(problem, found, step, left)
        if not after < left:
            break
        left = after
    return found


def _advanced(
    problem: FrictionProblem, impulses: np.ndarray, step: np.ndarray, left: float
) -> tuple[np.ndarray, float]:
    """The longest share of a step that reduces what is missed, and what is then; or no step."""
    for share in HALVINGS:
        trial = impulses + share * step
        after = _missed(problem, trial)
        if after < left:
            return trial, after
    trial = impulses + _first_change(problem, impulses, step) * step
    after = _missed(problem, trial)
    return (trial, after) if after < left else (impulses, left)


def _first_change(problem: FrictionProblem, impulses: np.ndarray, step: np.ndarray) -> float:
    """The share of a step just after which the first contact is on another piece.

    Up to there the equations are those that the step solves. Where impulses are not unique steps
    may be long, and end there.
    """
    z = _aimed(problem, impulses, problem.speeds(impulses))
    dz = _aimed(problem, step, (problem.matrix @ step.ravel()).reshape(problem.shape))
    squares = problem.friction**2
    a = np.sum(dz[:, 1:] ** 2, axis=1) - squares * dz[:, 0] ** 2
    b = 2 * (np.sum(z[:, 1:] * dz[:, 1:], axis=1) - squares * z[:, 0] * dz[:, 0])
    c = np.sum(z[:, 1:] ** 2, axis=1) - squares * z[:, 0] ** 2
    with np.errstate(all="ignore"):
        root = np.sqrt(b**2 - 4 * a * c)
        shares = np.concatenate([-z[:, 0] / dz[:, 0], (-b - root) / (2 * a), (-b + root) / (2 * a)])
    ahead = shares[np.isfinite(shares) & (shares > JUST)]
    return float(min(ahead.min(initial=1.0) * (1 + JUST), 1.0))


def _aimed(problem: FrictionProblem, impulses: np.ndarray, speeds: np.ndarray) -> np.ndarray:
    """``z = P − ρ u``, whose place tells the piece."""
    normal, along = problem.mobility
    sizes = np.column_stack([normal, *[along] * (problem.shape[1] - 1)])
    return impulses - speeds / sizes


def _missed(problem: FrictionProblem, impulses: np.ndarray) -> float:
    """Norm of what the conditions are missed by, in roots of energies."""
    missed = impulses - problem.projected(impulses, problem.speeds(impulses))
    return float(np.linalg.norm(missed * np.sqrt(problem.mobility[0])[:, None]))


def _step(problem: FrictionProblem, impulses: np.ndarray) -> np.ndarray | None:
    """The change that solves the conditions on the pieces where they are now."""
    speeds = problem.speeds(impulses)
    normal, along = problem.mobility
    missed = problem.projected(impulses, speeds) - impulses
    step = missed.copy()
    active = np.flatnonzero(impulses[:, 0] - speeds[:, 0] / normal > 0)
    if not active.size:
        return step
    k = problem.shape[1]
    own, coupled = _pieces(problem, impulses, speeds, active)
    rows = (active[:, None] * k + np.arange(k)).ravel()
    quiet = step.copy()
    quiet[active] = 0.0
    block = problem.matrix[rows]
    reached = (block @ quiet.ravel()).reshape(-1, k)
    matrix = block[:, rows]
    softness = np.column_stack([normal[active], np.tile(along[active, None], k - 1)])
    matrix[np.diag_indices_from(matrix)] += SOFTNESS * softness.ravel()
    size = active.size
    system = np.einsum("aij,ajbl->aibl", coupled, matrix.reshape(size, k, size, k))
    system[np.arange(size), :, np.arange(size), :] += own
    right = missed[active] - np.einsum("aij,aj->ai", coupled, reached)
    try:
        solved = np.linalg.solve(system.reshape(size * k, size * k), right.ravel())
    except np.linalg.LinAlgError:
        return None
    step[active] = solved.reshape(size, k)
    return step if np.isfinite(step).all() else None


def _pieces(
    problem: FrictionProblem, impulses: np.ndarray, speeds: np.ndarray, active: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives (n, k, k) of ``P − proj(P − ρ u)`` by ``P`` and by ``u`` of contacts that press.

    They stick, ``ρ u``, or slip along ``d = z/|z|`` with ``z = P_T − ρ u_T``: ``P_T − μ z_N d``.
    """
    k, (normal, along) = problem.shape[1], problem.mobility
    size, friction = active.size, problem.friction[active]
    own, coupled = np.zeros((size, k, k)), np.zeros((size, k, k))
    coupled[:, 0, 0] = 1 / normal[active]
    if k == 1:
        return own, coupled
    pressed = impulses[active, 0] - speeds[active, 0] / normal[active]
    aimed = impulses[active, 1:] - speeds[active, 1:] / along[active, None]
    length, radius = np.linalg.norm(aimed, axis=1), friction * pressed
    slips = (length > radius) | (friction == 0)
    way = aimed / np.where(length > 0, length, 1.0)[:, None]
    across = np.eye(k - 1) - way[:, :, None] * way[:, None, :]
    turning = (
        across
        * np.where(length > 0, radius / np.where(length > 0, length, 1.0), 0.0)[:, None, None]
    )
    share = np.where(slips[:, None, None], np.eye(k - 1) - turning, 0.0)
    own[:, 1:, 1:] = share
    coupled[:, 1:, 1:] = (np.eye(k - 1) - share) / along[active, None, None]
    growing = np.where(slips, friction, 0.0)[:, None] * way
    own[:, 1:, 0] = -growing
    coupled[:, 1:, 0] = growing / normal[active, None]
    return own, coupled
