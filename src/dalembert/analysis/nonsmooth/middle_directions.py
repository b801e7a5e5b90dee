"""Directions of gaps in the middle of a step.

    u⁻ = W(y) v + w,      u⁺ = W_m v⁺ + w_m + b,      b = W_m v + w_m − u⁻
    M (v⁺ − v) = h F + W_mᵀ P

``W_m`` and ``w_m`` are those where bodies have moved for ``(1−θ) h`` with the speeds ``v``, with
half of the rotations of ``2 (1−θ) h v``: in the middle of a step by the midpoint rule. Their
tangents follow those at the start (``gaps.tangents``). So
``u⁺ + u⁻ = W_m (v⁺ + v) + 2 w_m``: the mean of both velocities is that of the gap over the step,
and impulses do the work ``P·(u⁺ + u⁻)/2``. ``u⁺`` is the velocity at the end, ``W(y⁺) v⁺ + w``,
but for ``O(h²)``. In schemes of first order ``W(y) v⁺ + w`` acts for it (Acary & Brogliato 2008,
10.1).

For a ball and small impulses, the attitude at the end is ``e ⊗ (1, c)``, normalised,
``c = h (ω⁺ + ω)/4``. A torque normal to the spin then changes the angular momentum in its own
direction, by ``1/√(1 + |c|²)`` of itself.

The gap at the end is ``g + h (u⁺ + u⁻)/2`` but for ``O(h³)``. ``AnticipatedImpacts`` leaves it a
small clearance, so that few steps have a closed gap at their end. Gaps that close by an impact keep
``W(y)``, ``b = 0``: laws of impact apply to the state at the start, and a body that would move
through another one has opposite directions in the middle. Such a gap closes faster than forces
change speeds, and without contacts it is closed in the middle or, with the directions there, at the
end of the step, or its normal direction is reversed. Other bodies move past each other, though the
linear part of the gap may close.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy

from dalembert.integrators.contact.contacts import Contacts
from dalembert.symbolic.evaluation.kernel import Matrix

TURNS = 10.0
"""Least ratio of the clearance of a gap to its change by the turn of its directions [-]."""


def in_middle(start: Contacts, middle: Contacts, kept: np.ndarray, v: np.ndarray) -> Contacts:
    """Gaps at the start of a step with their directions in its middle.

    Parameters
    ----------
    start, middle : the same gaps at both positions
    kept : (n,) mask of those that keep the directions at the start
    v : (n_v,) speeds at the start
    """
    directions, drift = middle.directions, middle.drift
    if kept.any():
        rows = np.repeat(kept, start.drift.shape[1])
        directions = _chosen(rows, start.directions, directions)
        drift = np.where(kept[:, None], start.drift, drift)
    speeds = (directions @ v).reshape(drift.shape) + drift
    turning = speeds - start.speeds(v)
    return replace(start, directions=directions, drift=drift, kept=kept, turning=turning)


def is_same_side(start: Contacts, middle: Contacts, sizes: np.ndarray) -> np.ndarray:
    """(n,) mask of the gaps whose normal direction turns by less than a right angle.

    Parameters
    ----------
    start, middle : the same gaps at both positions
    sizes : (n_v,) natural displacements
    """
    one, other = start.normals, middle.normals
    if isinstance(one, np.ndarray):
        return np.asarray((one * other) @ sizes**2 > 0)
    return np.asarray(scipy.sparse.csr_array(one).multiply(other) @ sizes**2 > 0)


def with_clearance(
    distance: np.ndarray, turning: np.ndarray, rounding: float, clearance: float
) -> np.ndarray:
    """Distances (n,) less a clearance where directions turn, not below zero; negative ones remain.

    The clearance of a gap is ``clearance`` times the least power of a tenth that is not below
    ``TURNS`` times the change by its turn: bodies that hardly turn use the room between them to
    come to rest. It is constant between these powers, so that it has no derivatives.

    Parameters
    ----------
    turning : (n,) change of the gap by that of its directions in a step [m]
    rounding : such change that counts as zero [m]
    """
    change = np.abs(turning)
    turns = (change > rounding) & (distance > 0)
    ratio = TURNS * np.maximum(change, rounding) / clearance
    shares = 10.0 ** np.minimum(np.ceil(np.log10(ratio)), 0.0)
    return np.where(turns, np.maximum(distance - shares * clearance, 0.0), distance)


def _chosen(rows: np.ndarray, one: Matrix, other: Matrix) -> Matrix:
    """``rows`` of one matrix, and the others of another one."""
    if isinstance(one, np.ndarray):
        return np.where(rows[:, None], one, other)
    both = scipy.sparse.csr_array(scipy.sparse.vstack([one, other]))
    number = np.arange(rows.size)
    return both[np.where(rows, number, number + rows.size)]
