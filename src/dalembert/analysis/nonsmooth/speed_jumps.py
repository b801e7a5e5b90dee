"""Jumps of prescribed speeds under pressing contacts.

Joints constrain the mean of the speeds in a step: where the speed of a driver jumps by ``V`` at the
fraction ``s`` of a step, the driven body has ``2 (1 − s) V`` at its end, and a contact passes this
speed on. The speed is projected to ``V`` after the step; here the contacts that press take part,

    M (v − v⁺) + Cᵀ λ − Wᵀ p = 0,   C v = −Φ_t,   0 ≤ W v − u⁺ ⟂ P + p ≥ 0,   Coulomb's law

so that a resting body leaves with the driven one. Its speed before the jump is zero relative to the
driver, hence there is no rebound by Newton's law for any restitution (Moreau 1988).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction import ConsistentSpeeds, consistent_speeds
from dalembert.analysis.nonsmooth.mobility import Mobility, delassus
from dalembert.analysis.nonsmooth.step_state import StepResult
from dalembert.integrators.contact.contacts import Contacts, FrictionProblem, among

JUMP = 0.75
"""Difference of a prescribed speed in the middle of a step from the mean of those at its ends,
relative to half of its change, above which it jumps: 1 for a jump, small for a smooth law [-]."""
LEAST = 0.02
"""Smallest jump, relative to the prescribed speed [-]."""
NOTICEABLE = 0.01
"""Change of a normal speed by the projection, relative to that by the impulses, above which the
contacts take part in it [-]."""


def speeds_after(
    step: ContactStep, t: float, h: float, y: np.ndarray, result: StepResult
) -> tuple[ConsistentSpeeds, StepResult]:
    """Speeds at the end of a step from ``t`` that satisfy the joints at the position ``y``, and the
    result with the impulses of this projection."""
    plain = consistent_speeds(step, t + h, y, result.v)
    contacts = step.rigid(result.contacts)
    pressing = among(contacts.key, result.pressing[0])
    if not (pressing.any() and step.smooth.prescribes):
        return plain, result
    contacts, change = contacts.some(pressing), plain.v - result.v
    shift = (contacts.directions @ change).reshape(contacts.drift.shape)[:, 0]
    if not shift.any() or not speed_jumps(step, t, h, y):
        return plain, result
    mobility = step.smooth.at(t + h, y, step.p)[0]
    return _projected(step, plain, result, contacts, mobility, shift)


def speed_jumps(step: ContactStep, t: float, h: float, y: np.ndarray) -> bool:
    """Whether a prescribed speed jumps within a step."""
    start, middle, end = (step.smooth.prescribed(t + s * h, y, step.p) for s in (0.0, 0.5, 1.0))
    bend, speed = np.abs(start + end - 2 * middle), np.maximum(np.abs(start), np.abs(end))
    return bool(((bend > JUMP * np.abs(end - start)) & (bend > LEAST * speed) & (bend > 0)).any())


def _projected(
    step: ContactStep,
    plain: ConsistentSpeeds,
    result: StepResult,
    contacts: Contacts,
    mobility: Mobility,
    shift: np.ndarray,
) -> tuple[ConsistentSpeeds, StepResult]:
    """The projection with some contacts; the ``plain`` one if it hardly changes their speeds."""
    rows = np.flatnonzero(among(result.contacts.key, contacts.key))
    impulses = result.impulses.impulses[rows]
    matrix = delassus(contacts.directions, mobility)
    passed = (matrix @ impulses.ravel()).reshape(impulses.shape)
    if not (np.abs(shift) > NOTICEABLE * np.abs(passed[:, 0])).any():
        return plain, result
    velocity = contacts.at_end(plain.v) - passed
    velocity[:, 0] -= contacts.at_end(result.v)[:, 0]
    scale = float(np.abs(velocity[:, : contacts.linear]).max(initial=0.0)) or 1.0
    problem = FrictionProblem(matrix, velocity, contacts.laws.friction, contacts.groups, scale)
    solution = step.solver.solve(problem, impulses)
    if not solution.accepted:
        return plain, result
    push = contacts.directions.T @ (solution.impulses - impulses).ravel()
    added, reactions = mobility(push)
    after = plain.v + added
    change = after - result.v
    momentum = mobility.matrix @ change
    supplied = float((momentum - push) @ after)
    gained = float(momentum @ (after + result.v)) / 2
    everything = result.impulses.impulses.copy()
    everything[rows] = solution.impulses
    result = replace(
        result,
        multiplier=result.multiplier + reactions,
        impulses=replace(result.impulses, impulses=everything),
    )
    return ConsistentSpeeds(after, supplied - gained, supplied), result
