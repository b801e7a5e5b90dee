"""Contacts on connected bodies."""

from __future__ import annotations

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.mobility import Mobility
from dalembert.integrators.contact.contact_laws import ContactLaws

MOVED = 1e-9
"""Threshold of a change of speed by an impulse, relative to the largest change [-]."""
DENSE = 50_000
"""Upper limit of the entries of a dense matrix, which takes less time than a sparse one."""


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
    if rows.size * directions.shape[1] <= DENSE:
        responses = np.abs(scipy.sparse.csr_array(mobility.responses(directions[rows])).toarray())
        moves = responses > MOVED * responses.max(axis=1, initial=0.0, keepdims=True)
        first = np.searchsorted(rows, width * np.arange(count))  # each has a normal component
        dense = np.logical_or.reduceat(moves, first, axis=0).astype(float) if count else moves
        with_states = np.hstack([dense, dense @ by_states]) if by_states.shape[1] else dense
        return _components(with_states @ with_states.T > 0), scipy.sparse.csr_array(dense)
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
    return np.asarray(labels), speeds


def _components(adjacent: np.ndarray) -> np.ndarray:
    """(n,) numbers of the connected components of a graph of few nodes, by its (n, n) mask."""
    labels = np.arange(len(adjacent))
    while True:
        least = np.where(adjacent, labels, labels[:, None]).min(axis=1, initial=len(labels))
        least = np.minimum(labels, least)
        if np.array_equal(least, labels):
            return np.unique(labels, return_inverse=True)[1]
        labels = least
