"""Impacts of one step: their instants, and the speeds that they change."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from dalembert.analysis.nonsmooth.checks.missing_rebounds import effective_masses
from dalembert.analysis.nonsmooth.connected_contacts import connections
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.mobility import Mobility
from dalembert.analysis.nonsmooth.step_forces import states_moved_by_speeds
from dalembert.analysis.nonsmooth.step_state import StepStart
from dalembert.integrators.contact.approach import SLOW, Approach
from dalembert.integrators.contact.contacts import Contacts


@dataclass(frozen=True, eq=False)
class PressedContacts:
    """Pressing contacts of a step, in the order of their keys.

    Attributes
    ----------
    keys : (n,)
    impulses : (n,) normal impulses
    begins : (n,) mask of the contacts that do not press in the step before
    """

    keys: np.ndarray
    impulses: np.ndarray
    begins: np.ndarray

    @classmethod
    def of(cls, keys: np.ndarray, impulses: np.ndarray, last: np.ndarray) -> PressedContacts:
        """Contacts with impulses (n, k), after a step with the pressing contacts ``last``."""
        order = np.argsort(keys)
        return cls(keys[order], impulses[order, 0], ~np.isin(keys[order], last))


@dataclass(frozen=True, eq=False)
class GroupImpacts:
    """Impacts of a step on connected bodies.

    Attributes
    ----------
    keys : (n,) of the gaps that close
    instants : (n,) of these gaps, by their speeds at the start of the step [s]
    speeds : numbers of the speeds that change
    rebounds : whether a gap that closes has restitution; others remain closed, in any order
    drives : whether the impacts close further gaps within the step
    """

    keys: np.ndarray
    instants: np.ndarray
    speeds: np.ndarray
    rebounds: bool
    drives: bool

    @property
    def first(self) -> float:
        """The earliest instant [s]."""
        return float(self.instants.min())

    @property
    def spread(self) -> float:
        """Time from the first to the last instant, of gaps that do not remain closed [s]."""
        return float(np.ptp(self.instants)) if self.rebounds else 0.0


@dataclass(eq=False)
class LastImpacts:
    """Last impacts on each speed.

    Attributes
    ----------
    instants, lengths : (n_v,) their instants, and the lengths of their steps [s]
    keys : (n_v,) of the last gap that closed
    rebounds : (n_v,) whether these impacts rebound
    """

    instants: np.ndarray
    lengths: np.ndarray
    keys: np.ndarray
    rebounds: np.ndarray

    @classmethod
    def none(cls, speeds: int) -> LastImpacts:
        """No impacts."""
        no_time, zero = np.full(speeds, -np.inf), np.zeros(speeds)
        return cls(no_time, zero, np.full(speeds, -1), zero > 0)

    def since(self, group: GroupImpacts, h: float) -> tuple[float, float]:
        """Time since the last impact of another gap on the bodies of a group, and the same in
        steps, of which the group's has the length ``h``."""
        own = group.speeds[~np.isin(self.keys[group.speeds], group.keys)]
        own = own[(self.rebounds[own] | group.rebounds) & (self.instants[own] < group.first)]
        times = group.first - self.instants[own]
        steps = times / np.maximum(self.lengths[own], h)
        return float(times.min(initial=np.inf)), float(steps.min(initial=np.inf))

    def add(self, group: GroupImpacts, h: float) -> None:
        """Include impacts of a step with the length ``h``."""
        latest = int(np.argmax(group.instants))
        self.instants[group.speeds] = group.instants[latest]
        self.keys[group.speeds] = group.keys[latest]
        self.lengths[group.speeds], self.rebounds[group.speeds] = h, group.rebounds


@dataclass(frozen=True, eq=False)
class PressedGaps:
    """Gaps of pressing contacts of one step, or of several whose speeds follow one another.

    A gap closes by an impact if it is faster than forces change speeds in the longest step of the
    run; slower contacts come to rest.

    Attributes
    ----------
    approach : their contacts, with the lengths of the steps
    begins : (n,) mask of the rigid contacts that do not press in the step before
    keys, impulses : (n,), normal impulses
    t : start of the step, of each contact if they act in different ones [s]
    after : (n_v,) speeds at the end
    mobility : Mobility of the speeds
    by_states : (n_v, n_x) nonzero where a speed changes a state of first order
    longest : longest step of the run [s]
    """

    approach: Approach
    begins: np.ndarray
    keys: np.ndarray
    impulses: np.ndarray
    t: float | np.ndarray
    after: np.ndarray
    mobility: Mobility
    by_states: scipy.sparse.csr_array
    longest: float

    @cached_property
    def _acceleration(self) -> np.ndarray:
        return np.asarray(self.approach.nearby / self.approach.h)

    @property
    def _limit(self) -> np.ndarray:
        """(n,) speeds that an impact exceeds."""
        return np.asarray(SLOW * self._acceleration * self.longest)

    @cached_property
    def closes(self) -> np.ndarray:
        """(n,) mask of the gaps that close by an impact."""
        contacts, u = self.approach.contacts, self.approach.before[:, 0]
        fall = 2 * self._acceleration * np.maximum(contacts.distance, 0.0)
        return np.asarray(self.begins & (u < 0) & (np.sqrt(u**2 + fall) > self._limit))

    def _drives(self, smallest: float, shortest: float) -> np.ndarray:
        """(n,) mask of open gaps that an impact elsewhere closes."""
        contacts = self.approach.contacts
        reached = contacts.at_end(self.after)[:, 0]
        masses = effective_masses(contacts, self.mobility)
        pushed = np.divide(self.impulses, masses, out=np.zeros_like(masses), where=masses > 0)
        driven = pushed - reached
        least = np.maximum(smallest, 2 * shortest * driven)
        drives = self.begins & ~self.closes & (contacts.laws.restitution > 0)
        return np.asarray(drives & (driven > self._limit) & (contacts.distance > least))

    def groups(
        self, distance: np.ndarray, smallest: float, shortest: float
    ) -> list[tuple[int, GroupImpacts]]:
        """Impacts by groups of connected bodies, each with the number of one of its contacts.

        Parameters
        ----------
        distance : (n,) gaps at the start, before the correction of positions
        smallest : gap that counts as closed [m]
        shortest : difference of instants that counts as none [s]
        """
        contacts, u, closes = self.approach.contacts, self.approach.before[:, 0], self.closes
        instants = self.t + np.divide(-distance, u, out=np.zeros_like(u), where=u < 0)
        across = scipy.sparse.csr_array(contacts.directions)
        own = across, contacts.laws, contacts.groups, self.by_states
        labels, speeds = connections(self.mobility, *own)
        count = labels.max() + 1
        drives = np.bincount(labels, self._drives(smallest, shortest), count) > 0
        rebounds = np.bincount(labels, closes & (contacts.laws.restitution > 0), count) > 0
        moved = np.repeat(labels, np.diff(speeds.indptr)) * speeds.shape[1] + speeds.indices
        moved = np.divmod(np.unique(moved), speeds.shape[1])
        rows = np.flatnonzero(closes)
        rows = rows[np.argsort(labels[rows], kind="stable")]
        used = np.unique(labels[rows])
        limits = used, used + 1
        ends = np.stack([np.searchsorted(labels[rows], limits), np.searchsorted(moved[0], limits)])
        groups = []
        for label, (begin, end), (first, last) in zip(used, *ends.swapaxes(1, 2), strict=True):
            own_rows = rows[begin:end]
            impacts = self.keys[own_rows], instants[own_rows], moved[1][first:last]
            flags = bool(rebounds[label]), bool(drives[label])
            groups.append((int(own_rows[0]), GroupImpacts(*impacts, *flags)))
        return groups


def step_impacts(
    step: ContactStep,
    start: StepStart,
    pressed: PressedContacts,
    before: np.ndarray,
    after: np.ndarray,
    shortest: float,
) -> list[GroupImpacts]:
    """Impacts of a step by groups of connected bodies.

    Parameters
    ----------
    step : of the longest steps of the run
    before : positions at the start, before their correction
    after : speeds at the end
    shortest : difference of instants that counts as none [s]
    """
    if not pressed.begins.any():
        return []
    contacts = step.starting(start, pressed.keys)
    approach = start.approach(contacts, step.rounding)
    begins = pressed.begins & ~step.force_laws.compliant(contacts)
    own = approach, begins, pressed.keys, pressed.impulses, start.t, after
    gaps = PressedGaps(*own, start.motion.mobility, _by_states(step), step.longest)
    if not gaps.closes.any():
        return []
    distance = step.selected(step.at(start.t, before), pressed.keys).distance
    return [group for _, group in gaps.groups(distance, step.rounded_overlap, shortest)]


def connected(
    step: ContactStep, start: StepStart, contacts: Contacts
) -> tuple[np.ndarray, scipy.sparse.csr_array]:
    """(n,) numbers of the groups of contacts on connected bodies, and (n, n_v) masks of the speeds
    that each contact changes."""
    own = scipy.sparse.csr_array(contacts.directions), contacts.laws, contacts.groups
    return connections(start.motion.mobility, *own, _by_states(step))


def _by_states(step: ContactStep) -> scipy.sparse.csr_array:
    """(n_v, n_x) ones where a speed changes a state of first order."""
    e = step.model.equations
    if not e.states:
        return scipy.sparse.csr_array((e.speed_count, 0))
    rows, columns = states_moved_by_speeds(e).get_triplet()
    places = columns, rows
    return scipy.sparse.csr_array((np.ones(len(rows)), places), (e.speed_count, len(e.states)))
