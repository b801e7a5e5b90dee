"""What gradients of motions with many impacts do not tell by themselves."""

from __future__ import annotations

import numpy as np

from dalembert.errors import SingularityError
from dalembert.integrators.contact.schemes import MoreauJean
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.sensitivity.nonsmooth.contact_maps import Rubbing
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps
from dalembert.sensitivity.nonsmooth.moving_impacts import SLOW, closing_speeds, moving_parts

BARELY = 0.01
"""Share of friction, of the fastest slip or of the speed at rest, that is hardly any reserve."""


def pattern_changes(motion: NonsmoothMotion) -> list[str]:
    """Sentences about contacts that do something else at parameters nearby."""
    if not isinstance(motion.analysis.integrator, MoreauJean):  # type: ignore[attr-defined]
        return []
    steps = ContactSteps(motion)
    impacts, grazed, turning, company = 0, [], [], []
    for k in range(steps.count):
        if steps.patterns[k].keys() - (steps.patterns[k - 1].keys() if k else set()):
            speeds = closing_speeds(steps, k)
            closing = [key for key, (speed, rest) in speeds.items() if speed > SLOW * rest]
            impacts += len(closing)
            if _meet(steps, k, closing):
                company.append(steps.record.t[k])
            for speed, rest in speeds.values():
                if abs(speed - SLOW * rest) <= BARELY * speed:
                    grazed.append(steps.record.t[k])
        if any(_barely(steps, k, key) for key in steps.patterns[k]):
            turning.append(steps.record.t[k])
    found = []
    if impacts:
        found.append(
            f"{impacts} impact{'s move' if impacts > 1 else ' moves'} in time with the parameters: "
            "the gradient counts it to the order of the step; the run takes impacts at ends of "
            "steps and jumps, so that differences of it do not confirm the gradient"
        )
    if company:
        found.append(
            f"gaps on the same bodies close in one instant at t = {company[0]:.6g} s: parameters "
            "that part them make one impact follow the other, so the derivative is that of one "
            "impact at once"
        )
    if grazed:
        found.append(
            f"an impact is hardly faster than what counts as rest at t = {grazed[0]:.6g} s: with "
            "other parameters it is none, so the derivative is one-sided"
        )
    if turning:
        found.append(
            f"a contact is about to slip or to stick at t = {turning[0]:.6g} s: with other "
            "parameters it does so in another step, so derivatives change there"
        )
    return found


def _meet(steps: ContactSteps, k: int, closing: list[int]) -> bool:
    """Whether gaps that close in a step make one impact."""
    try:
        return bool(closing) and len(moving_parts(steps, k, closing)) < len(closing)
    except SingularityError:  # they close one after the other: gradients say so
        return False


def _barely(steps: ContactSteps, k: int, key: int) -> bool:
    """Whether a contact hardly sticks or hardly slips in a step."""
    rubs, impulse = steps.patterns[k][key]
    if rubs is Rubbing.NOT:
        return False
    gap, t, x = steps.maps.gap(key), float(steps.record.t[k]), steps.x[:, k : k + 2]
    y, before, after = x[: steps.size, 0], *x[steps.size :].T
    _, speeds, *_, friction = (value.full().ravel() for value in gap(t, y, after, steps.p))
    if rubs is Rubbing.STICKS:
        limit = friction[0] * impulse[0]
        return float(np.linalg.norm(impulse[1:])) > (1 - BARELY) * limit
    slip = float(np.linalg.norm(speeds[1:]))
    changed = np.abs(after - before).max()
    return slip <= BARELY * float(changed)
