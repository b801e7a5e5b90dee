"""Impacts of a step that act on the same bodies."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.analysis.nonsmooth.connected_contacts import connections
from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.sensitivity.nonsmooth.connected_contacts import (
    closing_times,
    remain_closed,
)
from dalembert.sensitivity.nonsmooth.contact_equations import ContactEquations
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps
from dalembert.sensitivity.nonsmooth.near_impacts import unresolved
from dalembert.sensitivity.nonsmooth.stacked_impacts import SIMULTANEOUS
from dalembert.sensitivity.nonsmooth.triplets import Sparse


def simultaneous(steps: ContactSteps, k: int, keys: np.ndarray) -> bool:
    """True if gaps close at one instant, extrapolated from the step before their correction."""
    before = max(k - 1, 0)
    t, h = steps.span(before)
    times = closing_times(steps.maps.gaps_at(steps.x[:, before], t, keys).values)
    return bool(np.ptp(times) <= SIMULTANEOUS * h)


def closed_after(steps: ContactSteps, k: int, contacts: ContactEquations) -> np.ndarray:
    """Mask of the contacts that remain closed after step ``k``."""
    fastest = float(np.abs(steps.x[steps.size :, k : k + 2]).max())
    return remain_closed(contacts.gaps.values, fastest)


def connected(steps: ContactSteps, k: int, contacts: ContactEquations) -> tuple[np.ndarray, Sparse]:
    """Connections of the contacts of a step."""
    (t, _), (y, _), gaps, groups = steps.span(k), steps.split(k), contacts.gaps, steps.step.groups
    by_states = steps.maps.equations.states_of_speeds(1)
    own = gaps.directions, ContactLaws.of(gaps.values.laws.T, groups), groups
    return connections(steps.step.smooth.at(t, y, steps.p)[0], *own, by_states)


def moving_parts(
    steps: ContactSteps, k: int, contacts: ContactEquations, impacting: np.ndarray
) -> list[tuple[np.ndarray, np.ndarray]]:
    """Rows of the contacts of each impact of step ``k``, and a mask of the entries of the state
    that it changes, as ones and zeros.

    Gaps that change the same entries and close simultaneously make one impact. Successive ones that
    remain closed stay at the time of the step.

    Raises
    ------
    SingularityError
        Two successive impacts change the same entries.
    """
    t = steps.span(k)[0]
    keys, (labels, speeds) = steps.active(k).keys, connected(steps, k, contacts)
    matrix: Any = steps.maps.equations.reach
    closed, parts = closed_after(steps, k, contacts), []
    for label in np.unique(labels[impacting]):
        rows = impacting[labels[impacting] == label]
        if rows.size > 1 and not simultaneous(steps, k, keys[rows]):
            if closed[rows].all():
                continue
            raise unresolved(t, steps.step.rest > 0)
        moved = speeds[labels == label].sum(axis=0) > 0
        parts.append((rows, np.concatenate([matrix @ moved > 0, moved]).astype(float)))
    return parts
