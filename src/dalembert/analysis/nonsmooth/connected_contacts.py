"""Contacts on connected bodies."""

from __future__ import annotations

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.mobility import Mobility
from dalembert.integrators.contact.contact_laws import ContactLaws

MOVED = 1e-9
"""Threshold of a change of speed by an impulse, relative to the largest change [-]."""


def connections(
    mobility: Mobility,
    directions: scipy.sparse.csr_array,
    laws: ContactLaws,
    groups: tuple[int, ...],
    by_states: scipy.sparse.csr_array,
) -> tuple[np.ndarray, scipy.sparse.csr_array]:
    """(n,) numbers of the groups of contacts on connected bodies or states, and (n, n_v) masks of
    the speeds that each contact changes, along its normal or by friction, as ones and zeros.

    Parameters
    ----------
    directions : (n k, n_v) of the impulses of the contacts
    groups : widths of the groups of tangential components
    by_states : (n_v, n_x) nonzero where a speed changes a state of first order
    """
    count, width = laws.restitution.size, 1 + sum(groups)
    acts = np.ones((count, width), dtype=bool)
    if groups:
        acts[:, 1:] = np.repeat(laws.friction > 0, groups, axis=1)
    rows = np.flatnonzero(acts)
    speeds = scipy.sparse.csr_array(abs(mobility.responses(directions[rows])))
    largest = np.repeat(speeds.max(axis=1).toarray().ravel(), np.diff(speeds.indptr))
    speeds.data = (speeds.data > MOVED * largest).astype(float)
    speeds.eliminate_zeros()
    own = scipy.sparse.csr_array(
        (np.ones(rows.size), (rows // width, np.arange(rows.size))), shape=(count, rows.size)
    )
    speeds = scipy.sparse.csr_array(own @ speeds)
    speeds.data = np.ones_like(speeds.data)
    moved = speeds
    if by_states.shape[1]:
        moved = scipy.sparse.csr_array(scipy.sparse.hstack([speeds, speeds @ by_states]))
    labels = scipy.sparse.csgraph.connected_components(moved @ moved.T, directed=False)[1]
    return labels, speeds
