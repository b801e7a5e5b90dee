"""Derivatives of impacts with compression and expansion at the start of a step.

With the sums ``S_j`` of the impulses and ``A δ_j + Cᵀ Λ_j = Wᵀ S_j``, ``C δ_j = 0``, the velocities
after increment ``j`` are ``u_j = u⁻ + W δ_j``, and change by

    du_j = du⁻ + R_j + H dS_j,      R_j = dW δ_j + W dδ_j  at constant S_j
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dalembert.analysis.nonsmooth.impact_stage import ImpactStage
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.integrators.contact.impact_path import Increment
from dalembert.sensitivity.nonsmooth.gap_changes import GapChanges
from dalembert.sensitivity.nonsmooth.gap_slopes import Gaps
from dalembert.sensitivity.nonsmooth.impact_system import ImpactSystem
from dalembert.sensitivity.nonsmooth.proximal_factors import ProximalFactors
from dalembert.sensitivity.nonsmooth.triplets import Sparse


@dataclass(frozen=True, eq=False)
class Motions:
    """Functions of speeds and multipliers of a step without forces.

    Attributes
    ----------
    factors : of ``[[A, Cᵀ], [C, 0]]``
    slopes : ``(δ, Λ)`` → derivatives of ``A δ + Cᵀ Λ`` and ``C δ`` by ``q``
    gaps : ``keys``, ``S``, ``δ`` → gaps with the velocities ``W v`` and ``W (v + δ)``
    middle : ``keys``, ``0`` → gaps with ``u⁻`` and ``2 u − u⁻``, ``u`` where the directions are
    means : ``δ`` → the same as ``gaps`` of all pressing contacts, as in the rest of the step
    speeds, first : number of the speeds, and of the first of them in ``q``
    """

    factors: ProximalFactors
    slopes: Callable[[np.ndarray], Sparse]
    gaps: Callable[[np.ndarray, np.ndarray, np.ndarray], Gaps]
    middle: Callable[[np.ndarray, np.ndarray], Gaps]
    means: Callable[[np.ndarray], Gaps]
    speeds: int
    first: int


class ImpactSlopes:
    """Impulses of impacts at the start of a step, and their derivatives.

    Parameters
    ----------
    stage : of the run
    keys : of the pressing contacts of the step
    motions : Motions

    Attributes
    ----------
    rows : (n,) numbers of the contacts that take part among the pressing ones
    struck : (m, k) velocities of the pressing contacts after the impacts
    momentum : (n_v,) ``Wᵀ S``
    inelastic : whether a contact by the energetic law has no restitution, ``e = 0``
    """

    def __init__(self, stage: ImpactStage, keys: np.ndarray, motions: Motions):
        contacts = stage.contacts
        order = np.argsort(contacts.key)
        order = order[np.isin(contacts.key[order], keys)]
        self.rows, self._motions = np.searchsorted(keys, contacts.key[order]), motions
        increments = [_some(part, order) for part in stage.increments]
        sums = np.cumsum([part.impulses for part in increments], axis=0)
        none = np.zeros_like(sums[-1])
        own, still = contacts.key[order], np.zeros(motions.speeds)
        across = motions.gaps(own, none, still).directions
        right = np.zeros((motions.factors.size, none.size))
        right[: motions.speeds] = across.T.toarray()
        responses = motions.factors.solve(right)
        self._across, self._gaps, self._slopes = across, [], []
        self._middle = motions.middle(own, none)
        for sum_ in sums:
            change = responses @ sum_.ravel()
            self._gaps.append(motions.gaps(own, sum_, change[: motions.speeds]))
            self._slopes.append(motions.slopes(change))
        laws = ContactLaws.of(self._gaps[0].values.laws.T, contacts.groups)
        self.inelastic = bool((laws.follows(ImpactLaw.ENERGETIC) & (laws.restitution == 0)).any())
        matrix = across @ responses[: motions.speeds]
        self._system = ImpactSystem(matrix, laws, contacts.groups, increments)
        self.momentum = np.asarray(across.T @ sums[-1].ravel())
        self._means = motions.means(change[: motions.speeds])
        self.struck, k = self._means.values.after, none.shape[1]
        self._normals = self._means.directions[np.arange(keys.size) * k]

    def push(self, dq: np.ndarray, path: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
        """Changes (n_v, c) of ``Wᵀ S`` and (m, c) of the normal velocities after the impacts, by
        those of ``q`` and of the speeds at the end of a path of means."""
        n, first, inputs = self._motions.speeds, self._motions.first, []
        own = self._across @ dq[first : first + n]
        for gaps, slope in zip(self._gaps, self._slopes, strict=True):
            change, momentum = gaps.push(dq)
            right = slope @ dq
            right[:n] -= momentum
            moved = self._across @ self._motions.factors.solve(right)[:n]
            turned = (change.after - change.before).reshape(own.shape) + own
            inputs.append(turned - moved)
        middle, _ = self._middle.push(dq)
        before = ((middle.before + middle.after).reshape(own.shape) + own) / 2
        laws = change.laws.reshape(-1, dq.shape[1])
        impulses = self._system.push(np.vstack([before, *inputs, laws]))
        momentum = momentum + self._across.T @ impulses
        right = -(slope @ dq)
        right[:n] += momentum
        moved = dq[first : first + n] + self._motions.factors.solve(right)[:n]
        return momentum, self._means.push(dq, path)[0].after[:, 0] + self._normals @ moved

    def pull(self, momentum: np.ndarray, struck: np.ndarray) -> np.ndarray:
        """Weights of ``q`` from those of ``Wᵀ S`` and of the normal velocities."""
        n, first, k = self._motions.speeds, self._motions.first, self.struck.shape[1]
        columns, size = momentum.shape[1], self._across.shape[0]
        means, still = self._struck(struck)
        total = self._means.pull(means, still)
        right, moved = (
            np.zeros((self._motions.factors.size, columns)),
            self._normals.T @ struck,
        )
        total[first : first + n] += moved
        right[:n] = moved
        inner = self._motions.factors.solve(right, transposed=True)
        total -= self._slopes[-1].T @ inner
        momentum = momentum + inner[:n]
        inputs = self._system.pull(self._across @ momentum)
        parts = np.split(inputs[: size * (1 + len(self._gaps))], 1 + len(self._gaps))
        for number, (gaps, slope) in enumerate(zip(self._gaps, self._slopes, strict=True)):
            own = gaps.values.like(columns)
            turned = parts[1 + number].reshape(-1, k, columns)
            own.after[:], own.before[:] = turned, -turned
            right = np.zeros((self._motions.factors.size, columns))
            right[:n] = self._across.T @ parts[1 + number]
            inner = -self._motions.factors.solve(right, transposed=True)
            push = -inner[:n]
            if number == len(self._gaps) - 1:
                push = push + momentum
                laws = inputs[size * (1 + len(self._gaps)) :]
                own.laws[:] = laws.reshape(own.laws.shape)
            pulled = gaps.pull(own, push) + slope.T @ inner
            pulled[first : first + n] += self._across.T @ parts[1 + number]
            total += pulled
        own = self._middle.values.like(columns)
        own.before[:] = own.after[:] = parts[0].reshape(-1, k, columns) / 2
        total += self._middle.pull(own, np.zeros_like(momentum))
        total[first : first + n] += self._across.T @ parts[0] / 2
        return np.asarray(total)

    def pull_path(self, struck: np.ndarray) -> np.ndarray:
        """Weights of the speeds at the end of a path of means."""
        return self._means.pull_path(*self._struck(struck))

    def _struck(self, struck: np.ndarray) -> tuple[GapChanges, np.ndarray]:
        weights = self._means.values.like(struck.shape[1])
        weights.after[:, 0] = struck
        return weights, np.zeros((self._motions.speeds, struck.shape[1]))


def _some(part: Increment, rows: np.ndarray) -> Increment:
    """An increment with some contacts."""
    names = "lowest", "minimum", "impulses", "before", "after", "ended"
    fields = (getattr(part, name)[rows] for name in names)
    return Increment(part.phase, part.span, part.centred, *fields)
