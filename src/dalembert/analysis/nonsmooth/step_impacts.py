"""Impacts of one step: their instants, and the speeds that they change."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy

from dalembert.analysis.contact.gap_checks import ROUNDED
from dalembert.analysis.nonsmooth.checks.missing_rebounds import effective_masses
from dalembert.analysis.nonsmooth.connected_contacts import connections
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.step_forces import states_moved_by_speeds
from dalembert.analysis.nonsmooth.step_state import StepStart
from dalembert.integrators.contact.approach import SLOW
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


def step_impacts(
    step: ContactStep,
    start: StepStart,
    pressed: PressedContacts,
    before: np.ndarray,
    after: np.ndarray,
    shortest: float,
) -> list[GroupImpacts]:
    """Impacts of a step by groups of connected bodies.

    A gap closes by an impact if it is faster than forces change speeds in the longest step of the
    run; slower contacts come to rest.

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
    begins = pressed.begins & ~step.force_laws.compliant(contacts)
    approach = replace(start.approach(contacts, step.rounding), rest=step.longest)
    u, acceleration = approach.before[:, 0], approach.nearby / start.h
    fall = 2 * acceleration * np.maximum(contacts.distance, 0.0)
    limit = SLOW * acceleration * step.longest
    closes = begins & (u < 0) & (np.sqrt(u**2 + fall) > limit)
    if not closes.any():
        return []
    gaps = step.selected(step.at(start.t, before), pressed.keys).distance
    instants = start.t + np.divide(-gaps, u, out=np.zeros_like(u), where=u < 0)
    reached = contacts.at_end(after)[:, 0]
    masses = effective_masses(contacts, start.motion.mobility)
    pushed = np.divide(pressed.impulses, masses, out=np.zeros_like(masses), where=masses > 0)
    driven = pushed - reached  # speeds of open gaps that an impact elsewhere closes
    least = np.maximum(ROUNDED * step.model.scales.length, 2 * shortest * driven)
    drives = begins & ~closes & (contacts.laws.restitution > 0)
    drives &= (driven > limit) & (contacts.distance > least)
    labels, speeds = connected(step, start, contacts)
    groups = []
    for label in np.unique(labels[closes]):
        own = labels == label
        moved = np.unique(speeds[np.flatnonzero(own)].indices)
        rows = own & closes
        rebounds = bool((contacts.laws.restitution[rows] > 0).any())
        impacts = pressed.keys[rows], instants[rows], moved, rebounds
        groups.append(GroupImpacts(*impacts, bool((own & drives).any())))
    return groups


def connected(
    step: ContactStep, start: StepStart, contacts: Contacts
) -> tuple[np.ndarray, scipy.sparse.csr_array]:
    """(n,) numbers of the groups of contacts on connected bodies, and (n, n_v) masks of the speeds
    that each contact changes."""
    e = step.model.equations
    rows, columns = states_moved_by_speeds(e).get_triplet() if e.states else ([], [])
    by_states = scipy.sparse.csr_array(
        (np.ones(len(rows)), (columns, rows)), shape=(e.speed_count, len(e.states))
    )
    own = scipy.sparse.csr_array(contacts.directions), contacts.laws, contacts.groups
    return connections(start.motion.mobility, *own, by_states)
