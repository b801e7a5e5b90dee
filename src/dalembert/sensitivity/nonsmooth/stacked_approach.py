"""Impacts of many steps of free bodies, evaluated together."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from dalembert.analysis.nonsmooth.step_impacts import GroupImpacts, PressedGaps
from dalembert.integrators.contact.approach import Approach
from dalembert.integrators.contact.contact_laws import ContactLaws
from dalembert.integrators.contact.contacts import Contacts
from dalembert.results.nonsmooth_motion import ContactRecord
from dalembert.sensitivity.nonsmooth.contact_maps import ContactMaps
from dalembert.sensitivity.nonsmooth.free_steps import FreeSteps
from dalembert.sensitivity.nonsmooth.recorded_contacts import RecordedContacts
from dalembert.sensitivity.nonsmooth.source_slopes import StepState
from dalembert.sensitivity.nonsmooth.step_stacks import stack_length


def impacts_of_free_bodies(
    maps: ContactMaps, record: ContactRecord, contacts: RecordedContacts, numbers: np.ndarray
) -> Iterator[tuple[int, GroupImpacts]]:
    """Steps of some ``numbers``, each with the impacts of one group of connected bodies."""
    length, n = stack_length(record.ends.y.shape[0] + maps.speeds), maps.speeds
    smallest = maps.contact_step.rounded_overlap
    for begin in range(0, numbers.size, length):
        some = numbers[begin : begin + length]
        gaps, owner, distance = _pressed_gaps(maps, record, contacts, some)
        if gaps.closes.any():
            for row, group in gaps.groups(distance, smallest, 0.0):
                own = replace(group, speeds=group.speeds - n * owner[row])
                yield int(some[owner[row]]), own


def _pressed_gaps(
    maps: ContactMaps, record: ContactRecord, contacts: RecordedContacts, numbers: np.ndarray
) -> tuple[PressedGaps, np.ndarray, np.ndarray]:
    """Gaps of the pressing contacts of some steps, their steps among these, and their distances."""
    step, t, h = maps.contact_step, record.t[numbers], np.diff(record.t)[numbers]
    place = np.full(record.loss.size, -1)
    place[numbers] = np.arange(numbers.size)
    rows = np.flatnonzero(place[contacts.owner] >= 0)
    owner, active = place[contacts.owner[rows]], contacts.all.some(rows)
    y, v = record.ends.y[:, numbers], record.ends.v[:, numbers]
    state = StepState(t[None], y, maps.p, v, v, lead=maps.lead(h[None]))
    gaps = maps.values(state, active.keys, owner, active.kept)
    values, free, speeds = gaps.values, FreeSteps(maps, state, h), v.T.ravel()
    turning, across = free.turning(gaps) / 2, gaps.directions
    drift = values.before + turning - (across @ speeds).reshape(turning.shape)
    distance = step.cleared(values.distance, turning, h[owner])
    laws, none = ContactLaws.of(values.laws.T, step.groups), np.zeros(owner.size, dtype=int)
    own = distance, across, drift, laws, step.groups, active.keys, none, turning, active.kept
    pressing = Contacts(*own)
    end = pressing.at_end(speeds + free.change)
    approach = Approach(pressing, values.before, end, h[owner], step.longest)
    begins, impulses = contacts.follows[rows] < 0, active.impulses[:, 0]
    after = record.ends.v[:, numbers + 1].T.ravel()
    by_states = maps.equations.states_of_speeds(numbers.size)
    pressed = approach, begins, active.keys, impulses, t[owner], after
    return PressedGaps(*pressed, free.mobility, by_states, step.longest), owner, values.distance
