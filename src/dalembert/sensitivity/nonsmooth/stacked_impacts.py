"""Moving impacts of the steps of a stack; the equations are those of ``moving_impacts``."""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.connected_contacts import connections
from dalembert.integrators.contact.approach import SLOW, SLOWEST, largest_nearby
from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.sensitivity.nonsmooth.connected_contacts import (
    closing_times,
    remain_closed,
)
from dalembert.sensitivity.nonsmooth.contact_changes import MARGIN, ContactChanges
from dalembert.sensitivity.nonsmooth.free_steps import FreeSteps, LastingContacts, mobility_of
from dalembert.sensitivity.nonsmooth.gap_matrices import distance_slopes
from dalembert.sensitivity.nonsmooth.gap_values import GapValues
from dalembert.sensitivity.nonsmooth.instant_shifts import InstantShifts
from dalembert.sensitivity.nonsmooth.source_slopes import StepState
from dalembert.sensitivity.nonsmooth.stacked_maps import StackedMaps
from dalembert.sensitivity.nonsmooth.triplets import DiagonalBlocks, Sparse

SIMULTANEOUS = 1e-6
"""Threshold of the distance of simultaneous impacts, relative to the step [-]."""


class StackedImpacts:
    """Impacts of the steps of a stack.

    Parameters
    ----------
    maps : StackedMaps

    Attributes
    ----------
    located : (K,) mask of the steps whose impacts are among these; others have impacts on bodies
        coupled by forces, or impacts on the same bodies that come one after the other and do not
        remain closed
    """

    def __init__(self, maps: StackedMaps):
        self._maps, self._steps, self._values = maps, maps.steps, maps.contacts.gaps.values
        self.located = maps.solved.copy()
        begins = maps.contacts.slopes.bounces & self._steps.begins
        travel = -maps.steps.h[self._steps.owner] * self._values.before[:, 0]
        begins &= travel > SLOWEST * self._values.distance
        if maps.maps.contact_step.smooth.coupling.coupled.size:
            self.located[self._steps.owner[begins]] = False
        self._rows = np.flatnonzero(begins & self.located[self._steps.owner])
        self._near = np.zeros(self._steps.count, dtype=bool)
        self._impacting, self._before = self._rows, np.zeros(0)
        if self._rows.size:
            self._impacting, self._before = self._located()
        self._label = np.zeros(0, dtype=int)  # of each impacting contact that moves in time
        self._moving, self._masks = self._parts()
        firsts = np.unique(self._label, return_index=True)[1]
        self._step_of = self._owner(self._moving[firsts])  # of each impact

    def _owner(self, rows: np.ndarray) -> np.ndarray:
        return self._steps.owner[rows]

    def _located(self) -> tuple[np.ndarray, np.ndarray]:
        """Contacts that close by an impact, and accelerations before."""
        steps, values, rows, maps = self._steps, self._values, self._rows, self._maps
        owner, width = self._owner(rows), values.before.shape[1]
        has = np.bincount(owner, minlength=steps.count) > 0
        free = FreeSteps(maps.maps, maps.state, steps.h)
        before = free.with_contacts(*self._carrying(has))
        gaps, h = maps.contacts.gaps, steps.h[owner]
        normals, turning = gaps.directions[::width], free.turning(gaps)[:, 0]
        own, nearby = (
            np.abs(steps.h[steps.owner] * (normals @ a.T.ravel()) + turning)
            for a in (before, free.accelerations)
        )
        forced = np.maximum(own, nearby)[rows]
        fall = 2 * forced / h * np.maximum(values.distance[rows], 0.0)
        forced = np.maximum(forced, largest_nearby(gaps.directions, nearby)[rows])
        speed = np.sqrt(values.before[rows, 0] ** 2 + fall)
        forced = np.maximum(1.0, maps.maps.contact_step.rest / h) * forced
        margin = np.abs(speed - SLOW * forced)
        self._near = np.bincount(owner, margin <= MARGIN * speed, steps.count) > 0
        return rows[speed > SLOW * forced], before

    def _carrying(self, has: np.ndarray) -> tuple[GapValues, LastingContacts]:
        """Gaps of the contacts that carry bodies before the impacts of some steps, also those that
        the impacts open, all with directions in the middle of the step."""
        steps, gaps, kept = self._steps, self._maps.contacts.gaps, self._steps.active.kept
        lasting = has[steps.owner] & ~steps.begins
        rows, turned = np.flatnonzero(lasting & ~kept), np.flatnonzero(lasting & kept)
        ended = np.flatnonzero(has[steps.ended_owner])
        if not (turned.size or ended.size):
            return gaps, steps.lasting(rows)
        owner, keys, impulses, sticks = (
            np.concatenate([values[rows], values[turned], others[ended]])
            for values, others in (
                (steps.owner, steps.ended_owner),
                (steps.active.keys, steps.ended.keys),
                (steps.active.impulses, steps.ended.impulses),
                (steps.sticks, steps.ended_sticks),
            )
        )
        own, order = np.arange(rows.size), np.argsort(owner, kind="stable")
        others = np.arange(rows.size, owner.size)
        evaluated = self._maps.maps.values(self._maps.state, keys[others], owner[others])
        joined = GapValues.joined([(own, gaps.some(rows)), (others, evaluated)])
        return joined, LastingContacts(order, owner[order], impulses[order], sticks[order])

    def _parts(self) -> tuple[np.ndarray, np.ndarray]:
        """Contacts of moving impacts, in the order of these, and (m, n_x) masks of the entries of
        the state that each impact changes."""
        steps, rows, size = self._steps, self._impacting, self._steps.x.shape[0]
        if not rows.size:
            return rows, np.zeros((0, size))
        count = np.bincount(self._owner(rows), minlength=steps.count)
        near = np.flatnonzero((count > 0)[steps.owner])
        labels, moved = self._connected(near)
        label = labels[np.searchsorted(near, rows)]
        order = np.argsort(label, kind="stable")
        rows, label = rows[order], label[order]
        starts = np.flatnonzero(np.diff(label, prepend=-1))
        sizes, times = np.diff(np.append(starts, label.size)), np.zeros(label.size)
        if (several := np.repeat(sizes > 1, sizes)).any():
            times[several] = self._times(rows[several])
        with np.errstate(invalid="ignore"):
            spread = np.maximum.reduceat(times, starts) - np.minimum.reduceat(times, starts)
        owner = self._owner(rows[starts])
        together = (sizes == 1) | (spread <= SIMULTANEOUS * steps.earlier_h[owner])
        closed = np.logical_and.reduceat(self._closed[rows], starts)
        self.located[owner[~together & ~closed]] = False
        moving = np.repeat(together, sizes)
        numbers = np.repeat(np.cumsum(together) - 1, sizes)[moving]
        self._label = numbers
        chosen = label[starts][together]
        own = self._changed(labels, moved, chosen, owner[together])
        return rows[moving], own

    def _connected(self, rows: np.ndarray) -> tuple[np.ndarray, Sparse]:
        """Connections of some contacts."""
        maps, steps, width = self._maps, self._steps, self._values.before.shape[1]
        state, equations = maps.state, maps.maps.equations
        still = np.zeros_like(state.before)
        arguments = still, state.y, still, state.t, state.p, 0.0
        mass = equations.consistent(*arguments)[1][0]
        mobility = mobility_of(maps.maps, mass, steps.count)
        by_states = equations.states_of_speeds(steps.count)
        groups, place = maps.maps.contact_step.groups, rows[:, None] * width + np.arange(width)
        directions = maps.contacts.gaps.directions[place.ravel()]
        laws = ContactLaws.of(self._values.laws[rows].T, groups)
        return connections(mobility, directions, laws, groups, by_states)

    def _times(self, rows: np.ndarray) -> np.ndarray:
        """Times until gaps close from the starts of the steps before their own."""
        steps, maps = self._steps, self._maps.maps
        y, v = np.split(steps.earlier, [maps.size])
        state = StepState(steps.earlier_t[None], y, maps.p, v, v)
        return closing_times(maps.values(state, steps.active.keys[rows], self._owner(rows)).values)

    def _changed(
        self, labels: np.ndarray, moved: Sparse, chosen: np.ndarray, owner: np.ndarray
    ) -> np.ndarray:
        """(m, n_x) masks of the entries of the state that contacts of some groups change."""
        maps, place = self._maps.maps, np.full(labels.max() + 1, -1)
        place[chosen] = np.arange(chosen.size)
        rows = place[labels[np.repeat(np.arange(labels.size), np.diff(moved.indptr))]]
        used = rows >= 0
        speeds = np.zeros((chosen.size, maps.speeds))
        speeds[rows[used], moved.indices[used] - maps.speeds * owner[rows[used]]] = 1.0
        positions = (maps.equations.reach @ speeds.T).T > 0
        return np.hstack([positions, speeds]).astype(float)

    @cached_property
    def _closed(self) -> np.ndarray:
        """(n,) mask of the contacts that remain closed after their steps."""
        steps, n = self._steps, self._maps.maps.size
        fastest = np.maximum(np.abs(steps.x[n:]).max(axis=0), np.abs(steps.end[n:]).max(axis=0))
        return remain_closed(self._values, fastest[steps.owner])

    @cached_property
    def _jumps(self) -> np.ndarray:
        """(m, n_x) derivatives of the states at the ends of steps by the instants."""
        maps, steps, contacts = self._maps, self._steps, self._maps.contacts
        has = np.bincount(self._step_of, minlength=steps.count) > 0
        t, end = (steps.t + steps.h)[None], steps.end
        y, v = np.split(end, [maps.maps.size])
        state = StepState(t, y, maps.maps.p, v, v, lead=maps.maps.lead(steps.h[None]))
        lasting = steps.lasting(np.flatnonzero(has[steps.owner] & self._closed))
        keys, owner = steps.active.keys[lasting.rows], lasting.owner
        gaps = maps.maps.values(state, keys, owner)
        own = LastingContacts(np.arange(keys.size), owner, lasting.impulses, lasting.sticks)
        after = FreeSteps(maps.maps, state, steps.h).with_contacts(gaps, own)
        start = maps.state
        before, later = (self._rates(part) for part in (start, state))
        p, one = np.zeros((maps.maps.p.size, steps.count)), np.ones((1, steps.count))
        dq = np.vstack([before, self._before, one, p])
        impacting = np.isin(np.arange(steps.owner.size), self._impacting)
        jump = maps.push(dq, contacts.impact_law(impacting), np.flatnonzero(has))
        jump = jump - np.vstack([later, after])
        return np.asarray(self._masks * jump.T[self._step_of])

    def _rates(self, state: StepState) -> np.ndarray:
        """(n_y, K) rates of the coordinates."""
        rates, count = self._maps.maps.equations.rates, state.count
        value, _ = rates(state.t, state.y, state.before, state.p, count=count)
        return value.reshape(count, -1).T

    @cached_property
    def _instants(self) -> Sparse:
        """(m, K n_q) derivatives of the instants."""
        rows, speeds = self._moving, self._values.before[self._moving, 0]
        sizes = np.bincount(self._label)[self._label]
        weights = -1 / (np.where(speeds != 0, speeds, 1.0) * sizes)
        shape = self._step_of.size, self._values.distance.size
        mean = scipy.sparse.csr_array((weights, (self._label, rows)), shape=shape)
        return mean @ distance_slopes(self._maps.contacts.gaps)

    @cached_property
    def _ordered(self) -> tuple[np.ndarray, DiagonalBlocks, np.ndarray]:
        """First impact of each step, and derivatives of the instants and by these, by steps."""
        order = np.argsort(self._step_of, kind="stable")
        first = np.searchsorted(self._step_of[order], np.arange(self._steps.count + 1))
        return first, DiagonalBlocks(self._instants[order], first), self._jumps[order]

    def at(self, k: int) -> InstantShifts | None:
        """Contribution of the impacts of a step; None without any."""
        if not self._step_of.size:
            return None
        first, instants, jumps = self._ordered
        begin, end = first[k : k + 2]
        return InstantShifts(instants.at(k), jumps[begin:end]) if begin < end else None

    def changes(self, k: int) -> ContactChanges:
        """Changes of contact states in a step and near it."""
        moving, largest, impacting = (int(count[k]) for count in self._counts)
        near, changing = bool(self._near[k]), bool(self._maps.changing[k])
        return ContactChanges(moving, largest > 1, impacting - moving, near, changing)

    @cached_property
    def _counts(self) -> np.ndarray:
        """(3, K) contacts of moving impacts, the most of one of them, all impacting contacts."""
        sizes, counts = np.bincount(self._label), np.zeros((3, self._steps.count), dtype=int)
        np.add.at(counts[0], self._step_of, sizes)
        np.maximum.at(counts[1], self._step_of, sizes)
        np.add.at(counts[2], self._owner(self._impacting), 1)
        return counts
