"""Pressing contacts of a step, and the equations that they satisfy.

    P − proj(P − ρ (u⁺ + offset)) = 0

with the branches of the projection (sticking, slipping) and of the offset that the step took. The
equation of an active gap is that of its normal component, ``u_N⁺ + offset_N = 0``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.integrators.contact.contacts import Contacts, FrictionProblem
from dalembert.integrators.contact.offset_slopes import OffsetSlopes
from dalembert.integrators.contact.schemes import Approach
from dalembert.integrators.contact.semismooth_newton import pieces
from dalembert.sensitivity.nonsmooth.gap_slopes import GapChanges, SourceGaps
from dalembert.sensitivity.nonsmooth.slope_function import Sparse


@dataclass(frozen=True, eq=False)
class ActiveContacts:
    """Pressing contacts, in the order of their keys.

    Attributes
    ----------
    keys : (n,)
    impulses, offsets : (n, k)
    """

    keys: np.ndarray
    impulses: np.ndarray
    offsets: np.ndarray

    def some(self, selected: np.ndarray) -> ActiveContacts:
        """The selected contacts."""
        return ActiveContacts(self.keys[selected], self.impulses[selected], self.offsets[selected])

    def pressing(self, impulses: np.ndarray) -> ActiveContacts:
        """The same contacts with other impulses."""
        return ActiveContacts(self.keys, impulses.reshape(self.impulses.shape), self.offsets)


@dataclass(frozen=True, eq=False)
class Gaps:
    """Gaps of all sources at a state.

    Attributes
    ----------
    parts : gaps of each source
    values : GapChanges
    directions : (n k, n_v) ``W``
    """

    parts: list[SourceGaps]
    values: GapChanges
    directions: Sparse

    @classmethod
    def of(cls, parts: list[SourceGaps], width: int) -> Gaps:
        """Gaps of several sources, in the order of their keys."""
        count = sum(part.rows.size for part in parts)
        values = GapChanges.zero(count, width)
        for part in parts:
            for kind in part.kinds:
                values.add(part.rows[kind.kind.row], kind.values)
        directions = [part.directions() for part in parts]
        joined = directions[0] if len(parts) == 1 else scipy.sparse.vstack(directions)
        across = Sparse(joined)
        across.sort_indices()
        return cls(parts, values, across)

    def push(self, dq: np.ndarray) -> tuple[GapChanges, np.ndarray]:
        """Changes of the gaps and of ``Wᵀ P`` by those of ``q`` (n_q, c)."""
        count, width = self.values.before.shape
        changes, momentum = GapChanges.zero(count, width, dq.shape[1]), np.zeros(0)
        for part in self.parts:
            change, own = part.push(dq)
            changes.add(part.rows, change)
            momentum = own if not momentum.size else momentum + own
        return changes, momentum

    def pull(self, weights: GapChanges, momentum: np.ndarray) -> np.ndarray:
        """Weights of ``q`` from those of the gaps and of ``Wᵀ P``."""
        pulled = [part.pull(weights.some(part.rows), momentum) for part in self.parts]
        return np.asarray(sum(pulled[1:], pulled[0]))

    def distance_slopes(self, row: int) -> np.ndarray:
        """(n_q,) derivatives of a gap."""
        weights = GapChanges.zero(*self.values.before.shape, 1)
        weights.distance[row] = 1.0
        return self.pull(weights, np.zeros((self.directions.shape[1], 1))).ravel()


@dataclass(frozen=True, eq=False)
class ContactEquations:
    """Linearised equations ``own P + coupled (u⁺ + offset) = 0`` of contacts.

    Attributes
    ----------
    gaps : Gaps
    own, coupled : (n, k, k)
    slopes : of the offsets
    limit : (n, k) derivatives of the equations by the coefficient of friction
    residual : (n k,)
    """

    gaps: Gaps
    own: np.ndarray
    coupled: np.ndarray
    slopes: OffsetSlopes
    limit: np.ndarray
    residual: np.ndarray

    @classmethod
    def of(
        cls, gaps: Gaps, step: ContactStep, active: ActiveContacts, h: float, inertia: np.ndarray
    ) -> ContactEquations:
        """Equations of a step as it was taken, scaled by an approximate ``inertia`` (n_v,)."""
        values, w = gaps.values, gaps.directions
        count, k = values.before.shape
        none, keys = np.zeros((count, k)), active.keys
        contacts = Contacts(values.distance, w, none, *values.laws.T, keys, 0 * keys)
        approach = Approach(contacts, values.before, values.after, h)
        slopes = step.scheme.slopes(approach, active.offsets, 2 * step.rounding / h)
        row = np.repeat(np.arange(count * k), np.diff(w.indptr))
        diagonal = np.bincount(row, w.data**2 / inertia[w.indices], count * k).astype(float)
        speeds, impulses = values.after + active.offsets, active.impulses
        problem = FrictionProblem(scipy.sparse.diags_array(diagonal), speeds, values.laws[:, 2])
        own, coupled = pieces(problem, impulses, speeds, np.arange(count))
        residual = (own @ impulses[..., None] + coupled @ speeds[..., None]).ravel()
        limit = _limit_slopes(problem, own, impulses, speeds)
        return cls(gaps, own, coupled, slopes, limit, residual)

    @classmethod
    def of_openings(cls, gaps: Gaps, distance: np.ndarray, presses: np.ndarray) -> ContactEquations:
        """``N δ + g = 0``, with ``g`` constant unless the contact presses."""
        zero, one = np.zeros(distance.size), np.ones((distance.size, 1, 1))
        slopes = OffsetSlopes(presses.astype(float), zero, zero, zero, zero, presses)
        residual = gaps.values.after[:, 0] + distance
        return cls(gaps, 0 * one, one, slopes, zero[:, None], residual)

    @property
    def by_impulse(self) -> Sparse:
        """(n k, n k) derivatives by the impulses."""
        return Sparse(_diagonal(self.own))

    @property
    def by_speed(self) -> Sparse:
        """(n k, n_v) derivatives by the speeds at the end."""
        return Sparse(_diagonal(self.coupled) @ self.gaps.directions)

    def push(self, dq: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Changes of ``Wᵀ P`` and of the equations by those of ``q``."""
        change, momentum = self.gaps.push(dq)
        s, values, columns = self.slopes, self.gaps.values, dq.shape[1]
        offset = s.tangential[:, None, None] * change.before
        offset += (s.tangential == values.laws[:, 1])[:, None, None] * (
            values.before[..., None] * change.laws[:, 1, None]
        )
        offset[:, 0] = (
            s.gap[:, None] * change.distance
            + s.speed[:, None] * change.before[:, 0]
            + s.restitution[:, None] * change.laws[:, 0]
        )
        rows = self.coupled @ (change.after + offset)
        rows += self.limit[..., None] * change.laws[:, 2, None]
        return momentum, rows.reshape(-1, columns)

    def pull(self, momentum: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Weights of ``q`` from those of ``Wᵀ P`` and of the equations."""
        s, values = self.slopes, self.gaps.values
        rows = weights.reshape(*self.coupled.shape[:2], -1)
        after = self.coupled.swapaxes(1, 2) @ rows
        before, normal = s.tangential[:, None, None] * after, after[:, 0]
        before[:, 0] = s.speed[:, None] * normal
        law = s.tangential == values.laws[:, 1]
        along = (values.before[:, 1:, None] * after[:, 1:]).sum(axis=1)
        laws = [
            s.restitution[:, None] * normal,
            law[:, None] * along,
            (self.limit[..., None] * rows).sum(axis=1),
        ]
        own = GapChanges(s.gap[:, None] * normal, before, after, np.stack(laws, axis=1))
        return self.gaps.pull(own, momentum)


def _limit_slopes(
    problem: FrictionProblem, own: np.ndarray, impulses: np.ndarray, speeds: np.ndarray
) -> np.ndarray:
    """(n, k) derivatives of the equations by the coefficient of friction."""
    normal, along = problem.mobility
    pressure = impulses[:, 0] - speeds[:, 0] / normal
    tangential = impulses[:, 1:] - speeds[:, 1:] / along[:, None]
    length = np.linalg.norm(tangential, axis=1)
    slips = own[:, 1:].any(axis=(1, 2)) & (length > 0)
    share = np.where(slips, -pressure / np.where(slips, length, 1.0), 0.0)
    return np.column_stack([0 * pressure, share[:, None] * tangential])


def _diagonal(blocks: np.ndarray) -> scipy.sparse.bsr_array:
    """Block-diagonal matrix."""
    count, k, _ = blocks.shape
    numbers = np.arange(count), np.arange(count + 1)
    return scipy.sparse.bsr_array((blocks, *numbers), shape=(count * k, count * k))
