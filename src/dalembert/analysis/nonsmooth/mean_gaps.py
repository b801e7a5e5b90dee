"""Gaps over the path of a step, with velocities whose integral is the change of the gap."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import scipy

from dalembert.integrators.contact.contacts import Contacts
from dalembert.model.graph.manifold import Manifold
from dalembert.symbolic.evaluation.kernel import Matrix

LOBATTO = {0.0: 1 / 12, (1 - 5**-0.5) / 2: 5 / 12, (1 + 5**-0.5) / 2: 5 / 12, 1.0: 1 / 12}
"""Fractions of the path and their weights in the mean (Lobatto's rule with four points)."""


def mean_gaps(
    gaps_at: Callable[[float, np.ndarray], Contacts],
    manifold: Manifold,
    span: tuple[float, float],
    y: np.ndarray,
    displacement: np.ndarray,
) -> tuple[Contacts, Contacts]:
    """Gaps at the start of a path ``y ⊕ s δ``, ``0 ≤ s ≤ 1``, and the same with means of their
    directions over it and the distance ``g(y ⊕ δ) − W̄ δ − h w̄``, so that the gap at the end of
    the step is linear in ``δ``.

    Along the normals, ``W̄ δ + h w̄`` is the change of the gap but for ``O(h⁷)``. An impulse
    therefore does the work that closes the gap, on curved paths too (discrete gradient: Gonzalez
    1996).

    Parameters
    ----------
    gaps_at : gaps at a time and position, with tangents that follow those at the start
    manifold : of the positions
    span : start time and length ``h`` of the step
    y : position at the start
    displacement : (n_v,) ``δ``
    """
    t, h = span
    parts = []
    for s in LOBATTO:
        parts.append(gaps_at(t + s * h, manifold.go(y, s * displacement)))
    directions = []
    for (s, weight), gaps in zip(LOBATTO.items(), parts, strict=True):
        shares = manifold.path_shares(displacement, s)
        directions.append(weight * _scaled_normals(gaps, shares))
    drift = np.tensordot(list(LOBATTO.values()), [gaps.drift for gaps in parts], axes=1)
    mean = replace(parts[0], directions=sum(directions[1:], directions[0]), drift=drift)
    change = h * mean.speeds(displacement / h)[:, 0]
    return parts[0], replace(mean, distance=parts[-1].distance - change)


def _scaled_normals(gaps: Contacts, factors: np.ndarray) -> Matrix:
    """Directions whose columns are multiplied by factors in the rows along the normals.

    Those along tangents remain, so that a body that rolls without slip satisfies their mean and
    their values at the start alike.
    """
    normal = np.arange(gaps.directions.shape[0]) % gaps.drift.shape[1] == 0
    if isinstance(gaps.directions, np.ndarray):
        return np.where(normal[:, None], gaps.directions * factors, gaps.directions)
    rows = scipy.sparse.csr_array(gaps.directions)
    scaled = rows.copy()
    own = np.repeat(normal, np.diff(rows.indptr))
    scaled.data = np.where(own, rows.data * factors[rows.indices], rows.data)
    return scaled
