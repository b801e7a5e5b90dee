"""Static friction above the friction of sliding contacts.

    |P_T| ≤ μ_s P_N  while u_T = 0,      P_T = −μ P_N u_T/|u_T|  otherwise

A contact that stuck in the step before, or whose slip is below rounding, has ``μ_s``, and so has a
contact whose slip would turn back within the step. If it slips with ``μ_s``, the step is repeated
with ``μ`` for this contact.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.integrators.contact.contact_solver import ContactSolver
from dalembert.integrators.contact.contacts import Contacts, FrictionProblem, among
from dalembert.integrators.contact.impulses import Impulses

STILL = 10.0
"""Slip of a sticking contact, relative to the tolerance of the solver [-]."""


def may_stick(
    contacts: Contacts, before: np.ndarray, stuck: np.ndarray, rounding: float
) -> np.ndarray:
    """(n,) mask of contacts with static friction.

    Parameters
    ----------
    contacts : Contacts
    before : (n, k) relative velocities before the step
    stuck : keys of the contacts that stuck in the step before
    rounding : slip that counts as rounding [m/s]
    """
    higher = contacts.laws.higher_at_rest
    if not higher.any():
        return higher
    slow = np.linalg.norm(before[:, 1 : contacts.linear], axis=1) <= rounding
    static: np.ndarray = higher & (slow | among(contacts.key, stuck))
    return static


def solve_with_static_friction(
    solver: ContactSolver,
    problem: FrictionProblem,
    start: np.ndarray,
    laws: ContactLaws,
    static: np.ndarray,
    before: np.ndarray,
) -> tuple[Impulses, np.ndarray]:
    """Impulses, and (n,) mask of the contacts that keep static friction.

    Parameters
    ----------
    solver, problem, start : as in ``ContactSolver.solve``, with the friction of sliding contacts
    laws : ContactLaws
    static : (n,) mask of contacts with static friction at first
    before : (n, k) relative velocities before the step
    """
    higher = laws.higher_at_rest
    if not higher.any():
        return solver.solve(problem, start), static
    rounds, slips = 0, np.zeros_like(static)
    while True:
        own = problem
        if static.any():
            friction = problem.friction.copy()
            friction[static, :1] = laws.static_friction[static, None]
            own = replace(problem, friction=friction)
        solution = solver.solve(own, start)
        start, rounds = solution.impulses, rounds + solution.rounds
        if not solution.accepted:
            break
        after = problem.speeds(start)[:, 1 : problem.linear]
        turned = (after * before[:, 1 : problem.linear]).sum(axis=1) < 0
        slips |= static & ~sticks(solver, problem, solution)
        changed = (static | (turned & higher & (start[:, 0] > 0))) & ~slips
        if (changed == static).all():
            break
        static = changed
    return replace(solution, rounds=rounds), static


def solve_precisely(
    solver: ContactSolver,
    problem: FrictionProblem,
    solution: Impulses,
    limit: float,
    *state: *tuple[ContactLaws, np.ndarray, np.ndarray],
) -> tuple[Impulses, np.ndarray]:
    """The same with a residual of at most ``limit`` [m/s], from a solution within the tolerance.

    This is relative to the impulses, which are large where heavy bodies press on light ones. Where
    contacts jam, and impulses have no effect, there is no such solution, and none is accepted.
    """
    share, rounds = limit / problem.size(solution.impulses), solution.rounds
    precise = replace(solver, tolerance=min(share, solver.tolerance))
    for start in (solution.impulses, np.zeros(problem.shape)):
        solution, static = solve_with_static_friction(precise, problem, start, *state)
        rounds += solution.rounds
        if solution.residual <= limit:
            break
    accepted = solution.accepted and solution.residual <= limit
    return replace(solution, rounds=rounds, accepted=accepted), static


def sticks(solver: ContactSolver, problem: FrictionProblem, solution: Impulses) -> np.ndarray:
    """(n,) mask of the contacts without slip."""
    slip = np.linalg.norm(problem.speeds(solution.impulses)[:, 1 : problem.linear], axis=1)
    tolerance = max(solver.newton_tolerance * problem.size(solution.impulses), solution.residual)
    still: np.ndarray = slip <= STILL * tolerance
    return still
