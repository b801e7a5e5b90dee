"""Times between impacts on connected bodies."""

from __future__ import annotations

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.step_impacts import LastImpacts, PressedContacts, step_impacts
from dalembert.errors import SingularityError
from dalembert.results.nonsmooth_motion import ContactRecord

UNRESOLVED, NEAR = 1.0, 4.0
"""Times between impacts on connected bodies below which there is no gradient, and below which a
note states them, in steps [-]."""


def times_between_impacts(step: ContactStep, record: ContactRecord) -> np.ndarray:
    """(K,) time since the last impact of another gap on the bodies of the impacts of each step, in
    steps; infinite without any, and zero if an impact closes further gaps within the step.

    An instant has an error of the order of the step. Bodies are displaced accordingly after an
    impact, so that the order and the effect of impacts within a few steps are uncertain.
    """
    count, (y, v, t) = record.loss.size, (record.ends.y, record.ends.v, record.t)
    times, last = np.full(count, np.inf), LastImpacts.none(step.model.equations.speed_count)
    order = np.argsort(record.step, kind="stable")
    bounds = np.searchsorted(record.step[order], np.arange(count + 1))
    keys = record.key[:0]
    for k in range(count):
        own = order[bounds[k] : bounds[k + 1]]
        pressed = PressedContacts.of(record.key[own], record.impulse[own], keys)
        keys = record.key[own]
        if not pressed.begins.any():
            continue
        h = float(t[k + 1] - t[k])
        start = step.begin(float(t[k]), h, y[:, k], v[:, k], k == 0)
        for group in step_impacts(step, start, pressed, y[:, k], v[:, k + 1], 0.0):
            since = 0.0 if group.drives else last.since(group, h)[1]
            times[k] = min(times[k], since)
            last.add(group, h)
    return times


def unresolved(t: float, separated: bool) -> SingularityError:
    """Error of a gradient by impacts at a time that are not separated, in a run that divides steps
    to separate impacts or not."""
    cure = (
        "give solve_nonsmooth separate_impacts=True, which divides such steps, or take shorter ones"
    )
    if separated:
        cure = "they are simultaneous but for 2⁻¹⁶ steps, as in a rattling cluster; shorten the run"
    return SingularityError(
        f"impacts on the same bodies come within one step at t = {t:.9g} s: which is first depends "
        f"on parameters, and so does the motion after them; {cure}"
    )
