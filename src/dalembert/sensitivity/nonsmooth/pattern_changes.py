"""Notes on gradients of nonsmooth time stepping."""

from __future__ import annotations

import numpy as np

from dalembert.errors import SingularityError
from dalembert.integrators.contact.schemes import MoreauJean
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.sensitivity.nonsmooth.contact_maps import Friction
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps
from dalembert.sensitivity.nonsmooth.moving_impacts import SLOW, closing_speeds, moving_parts

MARGIN = 0.01
"""Threshold of the reserve of friction, slip or resting speed near a change of state [-]."""


def nonsmooth_notes(motion: NonsmoothMotion) -> list[str]:
    """Notes on contacts whose state changes at nearby parameters."""
    if not isinstance(motion.analysis.integrator, MoreauJean):  # type: ignore[attr-defined]
        return []
    steps = ContactSteps(motion)
    impacts, grazing, changing, simultaneous = 0, [], [], []
    for k in range(steps.count):
        if steps.patterns[k].keys() - (steps.patterns[k - 1].keys() if k else set()):
            speeds = closing_speeds(steps, k)
            closing = [key for key, (speed, rest) in speeds.items() if speed > SLOW * rest]
            impacts += len(closing)
            if _simultaneous(steps, k, closing):
                simultaneous.append(steps.record.t[k])
            for speed, rest in speeds.values():
                if abs(speed - SLOW * rest) <= MARGIN * speed:
                    grazing.append(steps.record.t[k])
        if any(_near_change(steps, k, key) for key in steps.patterns[k]):
            changing.append(steps.record.t[k])
    notes = []
    if impacts:
        notes.append(
            f"{impacts} impact{'s move' if impacts > 1 else ' moves'} in time with the parameters: "
            "the gradient includes this to the order of the step; the run has impacts at the ends "
            "of steps, so that its differences jump and do not confirm the gradient"
        )
    if simultaneous:
        notes.append(
            f"gaps on the same bodies close in one instant at t = {simultaneous[0]:.6g} s: "
            "parameters that separate them make successive impacts, so the derivative is that of a "
            "simultaneous impact"
        )
    if grazing:
        notes.append(
            f"an impact is close to the threshold of resting contact at t = {grazing[0]:.6g} s: "
            "with other parameters it is no impact, so the derivative is one-sided"
        )
    if changing:
        notes.append(
            f"a contact is about to slip or to stick at t = {changing[0]:.6g} s: with other "
            "parameters it does so in another step, so derivatives change there"
        )
    return notes


def _simultaneous(steps: ContactSteps, k: int, closing: list[int]) -> bool:
    """True if several closing gaps of a step make one impact."""
    try:
        return bool(closing) and len(moving_parts(steps, k, closing)) < len(closing)
    except SingularityError:  # successive impacts, which gradients refuse
        return False


def _near_change(steps: ContactSteps, k: int, key: int) -> bool:
    """True if a contact is close to the change between sticking and slipping."""
    state, impulse = steps.patterns[k][key]
    if state is Friction.NONE:
        return False
    gap, t, x = steps.maps.gap(key), float(steps.record.t[k]), steps.x[:, k : k + 2]
    y, before, after = x[: steps.size, 0], *x[steps.size :].T
    _, speeds, *_, friction = (value.full().ravel() for value in gap(t, y, after, steps.p))
    if state is Friction.STICK:
        limit = friction[0] * impulse[0]
        return float(np.linalg.norm(impulse[1:])) > (1 - MARGIN) * limit
    slip = float(np.linalg.norm(speeds[1:]))
    change = np.abs(after - before).max()
    return slip <= MARGIN * float(change)
