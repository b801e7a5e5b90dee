"""Linearised maps of many steps, evaluated together.

States, gaps and equations of all steps follow one another, so that matrices are block-diagonal.
The linearisation is that of ``ContactMaps.step`` at the recorded solutions.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.active_contacts import ActiveContacts
from dalembert.sensitivity.nonsmooth.contact_changes import near_change
from dalembert.sensitivity.nonsmooth.contact_equations import ContactEquations
from dalembert.sensitivity.nonsmooth.contact_maps import ContactMaps
from dalembert.sensitivity.nonsmooth.forced_changes import ForcedSteps
from dalembert.sensitivity.nonsmooth.free_steps import LastingContacts
from dalembert.sensitivity.nonsmooth.gap_matrices import NAMES, MatrixGaps
from dalembert.sensitivity.nonsmooth.gap_slopes import Gaps
from dalembert.sensitivity.nonsmooth.linear_map import MapAt
from dalembert.sensitivity.nonsmooth.proximal_factors import (
    Block,
    ProximalFactors,
    ScaledMatrix,
    diagonal_block,
)
from dalembert.sensitivity.nonsmooth.residual_terms import SOLVED, terms_of
from dalembert.sensitivity.nonsmooth.source_slopes import StepState
from dalembert.sensitivity.nonsmooth.triplets import DiagonalBlocks, Sparse


@dataclass(frozen=True, eq=False)
class StepColumns:
    """Recorded steps in columns.

    Attributes
    ----------
    t, h : (K,) starts and lengths
    x, end : (n_x, K) states at the starts and ends
    active : pressing contacts of all steps
    owner : (n,) step of each contact, in ascending order
    begins : (n,) mask of the contacts that do not press in the step before
    sticks : (n,) mask of the contacts that do not slide
    earlier, earlier_t, earlier_h : states at the starts of the steps before, starts, and lengths
    ended, ended_owner, ended_sticks : contacts that press in the two steps before, but not in the
        step, which may be opened by its impacts, as ``active``, ``owner`` and ``sticks``
    """

    t: np.ndarray
    h: np.ndarray
    x: np.ndarray
    end: np.ndarray
    active: ActiveContacts
    owner: np.ndarray
    begins: np.ndarray
    sticks: np.ndarray
    earlier: np.ndarray
    earlier_t: np.ndarray
    earlier_h: np.ndarray
    ended: ActiveContacts
    ended_owner: np.ndarray
    ended_sticks: np.ndarray

    @property
    def count(self) -> int:
        """Number of steps."""
        return self.t.size

    @cached_property
    def first(self) -> np.ndarray:
        """(K + 1,) first contact of each step."""
        return np.searchsorted(self.owner, np.arange(self.count + 1))

    def lasting(self, rows: np.ndarray) -> LastingContacts:
        """Some contacts, as ones that neither impact nor part."""
        return LastingContacts(
            rows, self.owner[rows], self.active.impulses[rows], self.sticks[rows]
        )


class StackedMaps:
    """Maps of steps without joints, means over paths, impacts at the start and force laws.

    Parameters
    ----------
    maps : ContactMaps of the run
    steps : StepColumns

    Attributes
    ----------
    contacts : pressing contacts of all steps
    state : states at the starts and speeds at the ends
    solved : (K,) mask of the steps whose recorded solutions satisfy their equations
    following : (n_x, K) states at the ends, before corrections
    forced : (K,) mask of the steps with offsets that depend on the largest change by forces
    changing : (K,) mask of the steps with a contact that is about to slip or to stick
    """

    def __init__(self, maps: ContactMaps, steps: StepColumns):
        self.maps, self.steps = maps, steps
        (y, v), n = np.split(steps.x, [maps.size]), maps.speeds
        after, t, h = steps.end[maps.size :], steps.t[None], steps.h[None]
        value, (by_z, by_q), following, slopes = maps.equations.step(after, y, v, t, maps.p, h)
        self.following = following.reshape(steps.count, -1).T
        self._by_z, self._by_q, self._next = by_z, by_q, slopes
        active, owner = steps.active, steps.owner
        self.state = StepState(t, y, maps.p, v, after, lead=maps.lead(h))
        own = active.keys, active.impulses
        gaps = maps.gaps(self.state, *own, owner=owner, kept=active.kept)
        inertia = np.maximum(np.abs(by_z.diagonal()), np.finfo(float).tiny)
        step, width = maps.contact_step, active.impulses.shape[1]
        change = (after - v).T.ravel()
        self.contacts = ContactEquations.of(gaps, step, active, steps.h[owner], inertia, change)
        self._z = np.concatenate([after.T.ravel(), active.impulses.ravel()])
        right, blocks = maps.joined(value, self.contacts, active.impulses.ravel())
        matrix: list[Block] = [(0, 0, by_z), *blocks]
        self._step_of = np.concatenate(
            [np.repeat(np.arange(steps.count), n), np.repeat(owner, width)]
        )
        self._order = np.argsort(self._step_of, kind="stable")
        self._bounds = np.searchsorted(self._step_of[self._order], np.arange(steps.count + 1))
        place = np.argsort(self._order)
        weight = np.repeat([0.0, 1.0], [value.size, active.impulses.size])
        self._scaled = ScaledMatrix.of(matrix, weight, place).by_columns
        terms = terms_of(right, matrix, self._z)
        residual, largest = np.zeros(steps.count), np.ones(steps.count)
        np.maximum.at(residual, self._step_of, np.abs(right))
        np.maximum.at(largest, self._step_of, terms)
        self.solved = residual <= SOLVED * largest
        self.forced = np.bincount(owner, self.contacts.slopes.forced != 0, steps.count) > 0
        largest_change = np.abs(after - v).max(axis=0)
        near = near_change(self.contacts, active.impulses, step.groups, largest_change[owner])
        self.changing = np.bincount(owner, near, steps.count) > 0
        self._factors: dict[int, ProximalFactors] = {}

    def factors(self, k: int) -> ProximalFactors:
        """Factors of the equations of a step."""
        if k not in self._factors:
            self._factors[k] = ProximalFactors(self._scaled.block(*self._bounds[k : k + 2]))
        return self._factors[k]

    def push(self, dq: np.ndarray, contacts: ContactEquations, numbers: np.ndarray) -> np.ndarray:
        """Changes (n_x, K) of the states at the ends of the steps ``numbers``, by those of ``q``
        (n_q, K), with other equations of the contacts."""
        change = dq.T.reshape(-1, 1)
        momentum, rows = contacts.push(change)
        if self.forced.any():
            largest = (self._forced @ change)[np.repeat(self.steps.owner, contacts.own.shape[1])]
            rows += contacts.by_forced[:, None] * largest
        right = np.concatenate([self._by_q @ change - momentum, rows])[self._order]
        solution = np.zeros_like(right)
        for k in numbers:
            own = slice(*self._bounds[k : k + 2])
            solution[self._order[own]] = -self.factors(k).solve(right[own])
        by_z, by_q = self._next
        end = by_z @ solution[: by_z.shape[1]] + by_q @ change
        return np.asarray(end.reshape(self.steps.count, -1).T)

    @cached_property
    def _by_all(self) -> Sparse:
        """Derivatives of all equations by ``q``, by steps."""
        momentum, rows = self.contacts.by_q
        if self.forced.any():
            rows = rows + self._by_forced @ self._forced
        joined = scipy.sparse.csr_array(scipy.sparse.vstack([self._by_q - momentum, rows]))
        return joined[self._order]

    @cached_property
    def _all_blocks(self) -> DiagonalBlocks:
        """Derivatives of all equations of each step by ``q``."""
        return DiagonalBlocks(self._by_all, self._bounds)

    @cached_property
    def _next_blocks(self) -> tuple[DiagonalBlocks, DiagonalBlocks]:
        """Derivatives of the states after each step by the unknowns and by ``q``."""
        first = self.following.shape[0] * np.arange(self.steps.count + 1)
        by_z, by_q = self._next
        return DiagonalBlocks(by_z, first), DiagonalBlocks(by_q, first)

    def at(self, k: int, whole: bool) -> MapAt:
        """Map of a step.

        Parameters
        ----------
        whole : whether ``by_q`` has the derivatives of the contacts, too, in place of their
            equations
        """
        begin, end = self._bounds[k : k + 2]
        first, contacts = self.steps.first, None
        if whole:
            by_q = self._all_blocks.at(k)
        else:
            by_q = self._block(self._by_q, self.maps.speeds * np.arange(k, k + 2), k)
            contacts = self._contacts(k) if first[k] < first[k + 1] else None
        forced = None
        if self.forced[k] and not whole:
            forced = self._block(self._forced, np.arange(k, k + 2), k)
        by_z, next_by_q = self._next_blocks
        matrices, z = (by_q, by_z.at(k), next_by_q.at(k)), self._z[self._order[begin:end]]
        return MapAt(z, self.following[:, k], self.factors(k), *matrices, contacts, forced)

    def _block(self, matrix: Sparse, rows: np.ndarray, k: int) -> Sparse:
        """Block of step ``k``, from the first of two rows to the second one."""
        width, (begin, end) = matrix.shape[1] // self.steps.count, rows
        return diagonal_block(matrix, begin, end, width * k, width)

    @cached_property
    def _forced(self) -> Sparse:
        """(K, K n_q) derivatives of the largest changes of normal speeds by forces, 0 in the steps
        without offsets that depend on them."""
        steps, numbers = self.steps, np.flatnonzero(self.forced)
        rows = np.flatnonzero(self.contacts.slopes.forced)
        slopes = self.contacts.slopes.some(rows)
        ends = np.searchsorted(steps.owner[rows], numbers[1:])
        parts = np.split(slopes.change, ends), np.split(slopes.forced, ends)
        own = ForcedSteps(steps.x[:, numbers], steps.t[numbers], steps.h[numbers], *parts)
        changes = self.maps.forced_changes(own).tocoo()
        width = steps.x.shape[0] + 1 + self.maps.p.size
        row, (step, column) = numbers[changes.row], np.divmod(changes.col, width)
        places = row, numbers[step] * width + column
        shape = steps.count, steps.count * width
        return scipy.sparse.csr_array((changes.data, places), shape=shape)

    @property
    def _by_forced(self) -> Sparse:
        """(n k, K) derivatives of the equations of contacts by the largest changes."""
        count, rows = self.steps.count, self.contacts.by_forced
        owner = np.repeat(self.steps.owner, self.contacts.own.shape[1])
        places = owner, np.arange(rows.size + 1)
        return scipy.sparse.csr_array((rows, *places), shape=(rows.size, count))

    def _contacts(self, k: int) -> ContactEquations:
        """Equations of the contacts of a step."""
        whole, ends = self.contacts, self.steps.first[k : k + 2]
        rows, (total, width) = np.arange(*ends), whole.factors.shape
        matrices = whole.gap_slopes
        slopes = {
            name: self._block(matrices[name], matrices[name].shape[0] // total * ends, k)
            for name in NAMES
        }
        momentum = self._block(matrices["momentum"], self.maps.speeds * np.arange(k, k + 2), k)
        across = self._block(whole.gaps.directions, width * ends, k)
        values, size = whole.gaps.values.some(rows), momentum.shape[1]
        part = MatrixGaps(np.arange(rows.size), values, across, slopes, momentum, size)
        gaps = Gaps(values, across, [part])
        own = whole.own[rows], whole.coupled[rows], whole.slopes.some(rows)
        limits = whole.limit[rows], whole.column[rows], whole.factors[rows]
        residual = whole.residual.reshape(total, width)[rows].ravel()
        return ContactEquations(whole.keys[rows], gaps, *own, *limits, residual)
