"""Impacts of a step that act on the same bodies."""

from __future__ import annotations

from typing import Any

import numpy as np
import scipy

from dalembert.errors import SingularityError
from dalembert.sensitivity.nonsmooth.active_contacts import ContactEquations
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps
from dalembert.sensitivity.nonsmooth.slope_function import Sparse

RESTING = 1e-8
"""Threshold of the speed of a closed contact after an impact, relative to that before [-]."""
SIMULTANEOUS = 1e-6
"""Threshold of the distance of simultaneous impacts, relative to the step [-]."""
MOVED = 1e-9
"""Threshold of a change of speed by an impulse, relative to the largest change [-]."""


def remain_closed(steps: ContactSteps, k: int, contacts: ContactEquations) -> np.ndarray:
    """Mask of the contacts that remain closed after step ``k``: at rest, or without restitution."""
    values = contacts.gaps.values
    fastest = float(np.abs(steps.x[steps.size :, k : k + 2]).max())
    limit = RESTING * np.maximum(np.abs(values.before[:, 0]), fastest)
    closed: np.ndarray = (np.abs(values.after[:, 0]) <= limit) | (values.laws[:, 0] == 0)
    return closed


def simultaneous(steps: ContactSteps, k: int, keys: np.ndarray) -> bool:
    """True if gaps close at one instant, extrapolated from the step before their correction."""
    before = max(k - 1, 0)
    t, h = steps.span(before)
    values = steps.maps.gaps_at(steps.x[:, before], t, keys).values
    return bool(np.ptp(-values.distance / values.before[:, 0]) <= SIMULTANEOUS * h)


def connected(steps: ContactSteps, k: int, contacts: ContactEquations) -> tuple[np.ndarray, Sparse]:
    """(n,) numbers of the groups of contacts on connected bodies or states, and (n, n_v) masks of
    the speeds that each contact changes, as ones and zeros."""
    (t, _), (y, _), gaps = steps.span(k), steps.split(k), contacts.gaps
    mobility = steps.step.smooth.at(t, y, steps.p)[0]
    normals = gaps.directions[np.arange(contacts.keys.size) * gaps.values.before.shape[1]]
    speeds = scipy.sparse.csr_array(abs(mobility.responses(normals)))
    largest = np.repeat(speeds.max(axis=1).toarray().ravel(), np.diff(speeds.indptr))
    speeds.data = (speeds.data > MOVED * largest).astype(float)
    speeds.eliminate_zeros()
    states = steps.maps.equations.reach[list(steps.step.model.equations.states)]
    moved = scipy.sparse.hstack([speeds, speeds @ states.T]) if states.shape[0] else speeds
    labels = scipy.sparse.csgraph.connected_components(moved @ moved.T, directed=False)[1]
    return labels, speeds


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
    if impacting.size == 1:
        return [(impacting, np.ones(steps.x.shape[0]))]
    keys, (labels, speeds) = steps.active(k).keys, connected(steps, k, contacts)
    matrix: Any = steps.maps.equations.reach
    closed, parts = remain_closed(steps, k, contacts), []
    for label in np.unique(labels[impacting]):
        rows = impacting[labels[impacting] == label]
        if rows.size > 1 and not simultaneous(steps, k, keys[rows]):
            if closed[rows].all():
                continue
            raise SingularityError(
                f"impacts on the same bodies come within one step at t = {t:.9g} s: which is "
                "first depends on parameters, and so does the motion after them; take shorter "
                "steps"
            )
        moved = speeds[labels == label].sum(axis=0) > 0
        parts.append((rows, np.concatenate([matrix @ moved > 0, moved]).astype(float)))
    return parts
