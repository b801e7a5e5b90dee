"""Pressing contacts of all steps of a run."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from dalembert.analysis.nonsmooth.active_contacts import ActiveContacts
from dalembert.results.nonsmooth_motion import ContactRecord


class RecordedContacts:
    """Pressing contacts of all steps, by steps and keys.

    Parameters
    ----------
    record : ContactRecord

    Attributes
    ----------
    all : ActiveContacts of all steps
    owner : (n,) step of each contact
    first : (K + 1,) first contact of each step
    """

    def __init__(self, record: ContactRecord):
        order = np.lexsort((record.key, record.step))
        fields = record.key, record.impulse, record.offset, record.curved, record.kept
        active = ActiveContacts(*fields, record.longest[record.step])
        self.all, self.owner = active.some(order), record.step[order]
        self.first = np.searchsorted(self.owner, np.arange(record.t.size))

    def of(self, k: int) -> ActiveContacts:
        """Pressing contacts of a step; none before the first."""
        return self.all.some(np.arange(*self.first[k : k + 2]) if k >= 0 else np.arange(0))

    @cached_property
    def follows(self) -> np.ndarray:
        """(n,) number of the same contact in the step before; -1 for contacts that do not press
        there."""
        keys, owner = self.all.keys, self.owner
        order, before = np.lexsort((owner, keys)), np.full(keys.size, -1)
        last, own = order[:-1], order[1:]
        same = (keys[own] == keys[last]) & (owner[own] == owner[last] + 1)
        before[own[same]] = last[same]
        return before

    @cached_property
    def ended(self) -> np.ndarray:
        """Numbers of the contacts that press in two steps, the second of which is theirs, and not
        in the next one."""
        lasted = np.flatnonzero(self.follows >= 0)
        return lasted[~np.isin(lasted, self.follows)]
