"""Linearised equations of the pressing contacts of a step.

    P − proj(P − ρ (u⁺ + offset)) = 0

with the branches of the projection (sticking, slipping) and of the offset that the step took. The
equation of an active gap is that of its normal component, ``u_N⁺ + offset_N = 0``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.active_contacts import ActiveContacts
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.integrators.contact.approach import Approach
from dalembert.integrators.contact.contact_laws import FIRST, ContactLaws
from dalembert.integrators.contact.contacts import Contacts, FrictionProblem
from dalembert.integrators.contact.offset_slopes import OffsetSlopes
from dalembert.integrators.contact.semismooth_newton import pieces
from dalembert.sensitivity.nonsmooth.force_slopes import ForceSlopes
from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.gap_matrices import (
    joined_matrices,
    momentum_slopes,
    weighted_sums,
)
from dalembert.sensitivity.nonsmooth.gap_slopes import Gaps
from dalembert.sensitivity.nonsmooth.impact_slopes import ImpactSlopes
from dalembert.sensitivity.nonsmooth.triplets import Sparse, Triplets

STICK_MARGIN = 1e-6
"""Excess of a friction force over the sliding one that static friction explains [-]."""


@dataclass(frozen=True, eq=False)
class ContactEquations:
    """Linearised equations ``own P + coupled (u⁺ + offset) = 0`` of contacts.

    Attributes
    ----------
    keys : (n,)
    gaps : Gaps
    own, coupled : (n, k, k)
    slopes : of the offsets
    limit : (n, k) derivatives of the equations by the coefficients of friction
    column : (n, k) numbers of these coefficients
    factors : (n, k) derivatives of the offsets by the velocities before
    residual : (n k,)
    impact : impacts at the start of the step; None without any
    forces : contacts with force laws; None without any
    """

    keys: np.ndarray
    gaps: Gaps
    own: np.ndarray
    coupled: np.ndarray
    slopes: OffsetSlopes
    limit: np.ndarray
    column: np.ndarray
    factors: np.ndarray
    residual: np.ndarray
    impact: ImpactSlopes | None = None
    forces: ForceSlopes | None = None

    @classmethod
    def of(
        cls,
        gaps: Gaps,
        step: ContactStep,
        active: ActiveContacts,
        h: float | np.ndarray,
        inertia: np.ndarray,
        change: np.ndarray,
        impact: ImpactSlopes | None = None,
        forces: ForceSlopes | None = None,
    ) -> ContactEquations:
        """Equations of a step as it was taken, scaled by an approximate ``inertia`` (n_v,).

        ``change`` (n_v,) is that of the speeds in the step. The speeds of several steps may follow
        one another, with lengths ``h`` (n,) of the step of each contact.
        """
        values, w, groups = gaps.values, gaps.directions, step.groups
        (count, k), keys = values.before.shape, active.keys
        laws = ContactLaws.of(values.laws.T, groups)
        soft = np.zeros(0, dtype=int) if forces is None else forces.rows
        turning = gaps.turning(change) / 2
        turning[soft], turning[active.curved] = 0.0, 0.0
        distance = step.cleared(values.distance, turning, h)
        contacts = Contacts(distance, w, np.zeros((count, k)), laws, groups, keys, 0 * keys)
        approach = Approach(contacts, values.before, values.after, h, active.longest)
        if impact is not None:
            hit = np.isin(np.arange(count), impact.rows)
            approach = replace(approach, struck=impact.struck, hit=hit)
        rounding = 2 * step.rounding / h
        if forces is None:
            slopes = step.scheme.slopes(approach, active.offsets, rounding)
        else:
            slopes = forces.slopes(step.scheme, approach, active.offsets, rounding)
        row = np.repeat(np.arange(count * k), np.diff(w.indptr))
        diagonal = np.bincount(row, w.data**2 / inertia[w.indices], count * k).astype(float)
        speeds, impulses = values.after + active.offsets, active.impulses
        speeds[soft, 0] = 0.0  # friction is that of the impulses
        friction, static = laws.friction.copy(), _static(laws, groups, impulses)
        friction[static, :1] = (1 + STICK_MARGIN) * laws.static_friction[static, None]
        problem = FrictionProblem(scipy.sparse.diags_array(diagonal), speeds, friction, groups)
        z = impulses - speeds / problem.mobility
        own, coupled = pieces(problem, z, np.arange(count))
        coupled[soft, :, 0] = 0.0
        limited = active.at_limit
        _slide(own, coupled, active, laws.static_friction)
        residual = (own @ impulses[..., None] + coupled @ speeds[..., None])[..., 0]
        if forces is not None:
            own[soft, 0], coupled[soft, 0] = np.eye(k)[0], 0.0
            coupled[soft, 0, 0] = -forces.after
            residual[soft, 0] = impulses[soft, 0] - forces.impulse
        limit, column = _limit_slopes(problem, own, z)
        column[:, 1 : contacts.linear] -= (static & ~limited)[:, None]
        if active.limits is not None:
            column[limited, 1 : contacts.linear] = FIRST - 1
            limit[limited, 1 : contacts.linear] = (impulses[:, :1] * active.limits)[limited]
        factors = np.zeros((count, k))
        factors[:, 1 : contacts.linear] = laws.tangential[:, None]
        factors[:, 1:][slopes.idle] = 1.0
        factors[:, 0] = slopes.speed
        equations = own, coupled, slopes, limit, column, factors, residual.ravel()
        return cls(keys, gaps, *equations, impact, forces)

    @classmethod
    def of_openings(
        cls, keys: np.ndarray, gaps: Gaps, distance: np.ndarray, presses: np.ndarray
    ) -> ContactEquations:
        """``N δ + g = 0``, with ``g`` constant unless the contact presses."""
        zero, one = np.zeros(distance.size), np.ones((distance.size, 1, 1))
        idle = np.zeros((distance.size, 0), dtype=bool)
        slopes = OffsetSlopes(presses.astype(float), zero, zero, zero, zero, zero, idle, ~presses)
        residual, still = gaps.values.after[:, 0] + distance, zero[:, None]
        column = np.zeros((distance.size, 1), dtype=int)
        return cls(keys, gaps, 0 * one, one, slopes, still, column, still, residual)

    def impact_law(self, impacting: np.ndarray) -> ContactEquations:
        """The same equations if some contacts follow their law of impact, and the others remain
        closed."""
        zero, laws = np.zeros(self.slopes.gap.size), self.gaps.values.laws
        speed, factors = zero.copy(), self.factors.copy()
        speed[impacting], struck = laws[impacting, 0], self.slopes.struck
        if self.impact is not None:
            own, struck = self.impact.rows, struck.copy()
            struck[own[impacting[own]]], speed[own] = -1.0, 0.0
        if self.forces is not None:
            soft = self.forces.rows
            zero[soft], speed[soft] = self.slopes.gap[soft], self.slopes.speed[soft]
        factors[:, 0], none = speed, np.zeros_like(speed)
        slopes = replace(self.slopes, gap=zero, speed=speed, restitution=none, struck=struck)
        return replace(self, slopes=slopes, factors=factors)

    @property
    def struck(self) -> np.ndarray | float:
        """(n_v,) momentum by impacts at the start of the step."""
        return 0.0 if self.impact is None else self.impact.momentum

    @property
    def by_forced(self) -> np.ndarray:
        """(n k,) derivatives by the largest change of a normal speed by forces."""
        return np.asarray((self.coupled[:, :, 0] * self.slopes.forced[:, None]).ravel())

    @property
    def by_impulse(self) -> Triplets:
        """(n k, n k) derivatives by the impulses."""
        count, k, _ = self.own.shape
        row, column = np.broadcast_arrays(np.arange(k)[:, None], np.arange(k))
        first = k * np.arange(count)[:, None, None]
        places = (first + row).ravel(), (first + column).ravel()
        return Triplets(*places, self.own.ravel(), (count * k, count * k))

    @property
    def by_speed(self) -> Sparse:
        """(n k, n_v) derivatives by the speeds at the end."""
        return scipy.sparse.csr_array(_diagonal(self.coupled) @ self.gaps.directions)

    def push(self, dq: np.ndarray, path: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
        """Changes of ``Wᵀ P`` and of the equations by those of ``q`` and of a path's speeds."""
        change, momentum = self.gaps.push(dq, path)
        rows = sum(
            (slopes @ getattr(change, name).reshape(slopes.shape[0], -1, dq.shape[1]))
            for name, slopes in self.by_gaps.items()
        )
        if self.impact is not None:
            exchanged, struck = self.impact.push(dq, path)
            momentum = momentum + exchanged
            rows += self.coupled[:, :, :1] * (self.slopes.struck[:, None] * struck)[:, None]
        if self.forces is not None:
            by_p = self.forces.parameters
            rows[self.forces.rows, 0] -= by_p @ dq[dq.shape[0] - by_p.shape[1] :]
        return momentum, rows.reshape(-1, dq.shape[1])

    def pull(self, momentum: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Weights of ``q`` from those of ``Wᵀ P`` and of the equations."""
        own = self._weights(weights)
        pulled = self.gaps.pull(own, momentum)
        if self.forces is not None:
            by_p, rows = self.forces.parameters, weights.reshape(*self.coupled.shape[:2], -1)
            pulled[pulled.shape[0] - by_p.shape[1] :] -= by_p.T @ rows[self.forces.rows, 0]
        if self.impact is None:
            return pulled
        struck = self.slopes.struck[:, None] * own.after[:, 0]
        return np.asarray(pulled + self.impact.pull(momentum, struck))

    @property
    def by_q(self) -> tuple[Sparse, Sparse]:
        """Derivatives of ``Wᵀ P`` (n_v, n_q) and of the equations (n k, n_q) by ``q``,
        without means over a path, impacts at the start and force laws."""
        return momentum_slopes(self.gaps), weighted_sums(self.gaps, self.by_gaps)

    @cached_property
    def gap_slopes(self) -> dict[str, Sparse]:
        """Derivatives of the gaps, and of ``Wᵀ P``, by ``q``."""
        return joined_matrices(self.gaps)

    def pull_path(self, momentum: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Weights of the speeds at the end of a path of means."""
        own = self._weights(weights)
        pulled = self.gaps.pull_path(own, momentum)
        if self.impact is not None:
            pulled = pulled + self.impact.pull_path(self.slopes.struck[:, None] * own.after[:, 0])
        return pulled

    def _weights(self, weights: np.ndarray) -> GapChanges:
        """Weights of the gaps from those of the equations."""
        rows = weights.reshape(*self.coupled.shape[:2], -1)
        own = self.gaps.values.like(rows.shape[2])
        for name, slopes in self.by_gaps.items():
            weight = getattr(own, name)
            weight[:] = (slopes.swapaxes(1, 2) @ rows).reshape(weight.shape)
        return own

    @cached_property
    def by_gaps(self) -> dict[str, np.ndarray]:
        """(n, k, m) derivatives of the equations of each contact by the fields of its gap."""
        s, (count, k) = self.slopes, self.factors.shape
        laws = np.zeros((count, k, self.gaps.values.laws.shape[1]))
        laws[:, :, 0] = s.restitution[:, None] * self.coupled[:, :, 0]
        laws[:, :, 1] = (self.coupled[:, :, 1:] @ self._restituted[..., None])[..., 0]
        place = np.arange(count)[:, None], np.arange(k), self.column
        laws[place] += self.limit
        return {
            "distance": s.gap[:, None, None] * self.coupled[:, :, :1],
            "before": self.coupled * self.factors[:, None],
            "after": self.coupled,
            "laws": laws,
        }

    @property
    def _restituted(self) -> np.ndarray:
        """(n, k − 1) derivatives of the offsets by the tangential restitution."""
        before = self.gaps.values.before[:, 1:]
        return np.where((self.column[:, 1:] <= FIRST) & ~self.slopes.idle, before, 0.0)


def _static(laws: ContactLaws, groups: tuple[int, ...], impulses: np.ndarray) -> np.ndarray:
    """Mask of the contacts that stick by static friction, also at its limit."""
    slip = np.linalg.norm(impulses[:, 1 : 1 + sum(groups[:1])], axis=1)
    moving = laws.friction[:, 0] if groups else 0.0
    return np.asarray(laws.higher_at_rest & (slip > (1 + STICK_MARGIN) * moving * impulses[:, 0]))


def _slide(
    own: np.ndarray, coupled: np.ndarray, active: ActiveContacts, static: np.ndarray
) -> None:
    """``P_T + μ_s P_N d = 0`` for contacts that slip in directions ``d`` at the limit of static
    friction."""
    if active.limits is None:
        return
    rows, end = np.flatnonzero(active.at_limit), 1 + active.limits.shape[1]
    own[rows, 1:end], coupled[rows, 1:end] = np.eye(own.shape[1])[1:end], 0.0
    own[rows, 1:end, 0] = static[rows, None] * active.limits[rows]


def _limit_slopes(
    problem: FrictionProblem, own: np.ndarray, z: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(n, k) derivatives of the equations by the coefficients of friction, and their numbers."""
    slopes, columns = np.zeros(z.shape), np.zeros(z.shape, dtype=int)
    for number, (components, _) in enumerate(problem.discs):
        length = np.linalg.norm(z[:, components], axis=1)
        slips = own[:, components].any(axis=(1, 2)) & (length > 0) & (z[:, 0] > 0)
        share = np.where(slips, -z[:, 0] / np.where(slips, length, 1.0), 0.0)
        slopes[:, components] = share[:, None] * z[:, components]
        columns[:, components] = FIRST + number
    return slopes, columns


def _diagonal(blocks: np.ndarray) -> scipy.sparse.bsr_array:
    """Block-diagonal matrix."""
    count, rows, columns = blocks.shape
    numbers = np.arange(count), np.arange(count + 1)
    return scipy.sparse.bsr_array((blocks, *numbers), shape=(count * rows, count * columns))
