"""Times between impacts on connected bodies."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dalembert.analysis.nonsmooth.step_impacts import (
    GroupImpacts,
    LastImpacts,
    PressedContacts,
    step_impacts,
)
from dalembert.errors import SingularityError
from dalembert.results.nonsmooth_motion import ContactRecord
from dalembert.sensitivity.nonsmooth.contact_maps import ContactMaps
from dalembert.sensitivity.nonsmooth.recorded_contacts import RecordedContacts
from dalembert.sensitivity.nonsmooth.stacked_approach import impacts_of_free_bodies

UNRESOLVED, NEAR = 1.0, 4.0
"""Times between impacts on connected bodies below which there is no gradient, and below which a
note states them, in steps [-]."""


def times_between_impacts(
    maps: ContactMaps, record: ContactRecord, contacts: RecordedContacts
) -> np.ndarray:
    """(K,) time since the last impact of another gap on the bodies of the impacts of each step, in
    steps; infinite without any, and zero if an impact closes further gaps within the step.

    An instant has an error of the order of the step. Bodies are displaced accordingly after an
    impact, so that the order and the effect of impacts within a few steps are uncertain.
    """
    times, lengths = np.full(record.loss.size, np.inf), np.diff(record.t)
    last = LastImpacts.none(maps.speeds)
    for k, group in _impacts(maps, record, contacts):
        h = float(lengths[k])
        since = 0.0 if group.drives else last.since(group, h)[1]
        times[k] = min(times[k], since)
        last.add(group, h)
    return times


def _impacts(
    maps: ContactMaps, record: ContactRecord, contacts: RecordedContacts
) -> Iterator[tuple[int, GroupImpacts]]:
    """Steps, each with the impacts of one group of connected bodies."""
    step, numbers = maps.contact_step, np.unique(contacts.owner[contacts.follows < 0])
    joined = step.smooth.has_joints or step.smooth.coupling.coupled.size
    if joined or step.force_laws.elements:
        return impacts_one_by_one(maps, record, contacts, numbers)
    return impacts_of_free_bodies(maps, record, contacts, numbers)


def impacts_one_by_one(
    maps: ContactMaps, record: ContactRecord, contacts: RecordedContacts, numbers: np.ndarray
) -> Iterator[tuple[int, GroupImpacts]]:
    """Steps of some ``numbers``, each with the impacts of one group of connected bodies."""
    step, y, v, t = maps.contact_step, record.ends.y, record.ends.v, record.t
    for k in map(int, numbers):
        active, last = contacts.of(k), contacts.of(k - 1)
        pressed = PressedContacts.of(active.keys, active.impulses, last.keys)
        start = step.begin(float(t[k]), float(t[k + 1] - t[k]), y[:, k], v[:, k], k == 0)
        for group in step_impacts(step, start, pressed, y[:, k], v[:, k + 1], 0.0):
            yield k, group


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
