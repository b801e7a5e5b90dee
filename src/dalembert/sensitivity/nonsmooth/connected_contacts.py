"""Contacts on connected bodies, and their state after an impact."""

from __future__ import annotations

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.mobility import Mobility
from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.slope_function import Sparse

RESTING = 1e-8
"""Threshold of the speed of a closed contact after an impact, relative to that before [-]."""
MOVED = 1e-9
"""Threshold of a change of speed by an impulse, relative to the largest change [-]."""


def connections(
    mobility: Mobility, normals: Sparse, by_states: Sparse
) -> tuple[np.ndarray, Sparse]:
    """(n,) numbers of the groups of contacts on connected bodies or states, and (n, n_v) masks of
    the speeds that each contact changes, as ones and zeros.

    Parameters
    ----------
    normals : (n, n_v) normal directions of the contacts
    by_states : (n_v, n_x) nonzero where a speed changes a state of first order
    """
    speeds = scipy.sparse.csr_array(abs(mobility.responses(normals)))
    largest = np.repeat(speeds.max(axis=1).toarray().ravel(), np.diff(speeds.indptr))
    speeds.data = (speeds.data > MOVED * largest).astype(float)
    speeds.eliminate_zeros()
    moved = speeds
    if by_states.shape[1]:
        moved = scipy.sparse.csr_array(scipy.sparse.hstack([speeds, speeds @ by_states]))
    labels = scipy.sparse.csgraph.connected_components(moved @ moved.T, directed=False)[1]
    return labels, speeds


def remain_closed(values: GapChanges, fastest: float | np.ndarray) -> np.ndarray:
    """Mask of the contacts that remain closed after a step: at rest, or without restitution.

    Parameters
    ----------
    values : of their gaps
    fastest : largest speed of the step, of each contact if they act in different ones
    """
    limit = RESTING * np.maximum(np.abs(values.before[:, 0]), fastest)
    closed: np.ndarray = (np.abs(values.after[:, 0]) <= limit) | (values.laws[:, 0] == 0)
    return closed


def closing_times(values: GapChanges) -> np.ndarray:
    """(n,) times until gaps close, extrapolated with their speeds."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(-values.distance / values.before[:, 0])
