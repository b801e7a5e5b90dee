"""Record of the pressing contacts of steps in machine code, and initial impulses of the next."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dalembert.analysis.nonsmooth.active_contacts import ActiveContacts
from dalembert.analysis.nonsmooth.free_bodies.path_contacts import PathContacts
from dalembert.analysis.nonsmooth.step_entries import StepEntries
from dalembert.integrators.contact.places import Counts
from dalembert.integrators.contact.step_calls import StepOutcome
from dalembert.integrators.contact.step_places import RecordColumns, Sizes


class RecordedContacts(PathContacts):
    """Steps with a record of their pressing contacts: keys, impulses, offsets.

    A subclass allocates the arrays.
    """

    numbers: np.ndarray
    displacement: np.ndarray
    _last: tuple[np.ndarray, np.ndarray]
    _solved: np.ndarray
    _pairs: np.ndarray
    _pair_of: np.ndarray
    _pressed: np.ndarray
    _impulses: np.ndarray
    _offsets: np.ndarray
    _kept: np.ndarray

    def warm(self, keys: np.ndarray, impulses: np.ndarray) -> None:
        """Initial impulses of contacts with some keys, zero for others."""
        count = keys.size
        if count > self._last[0].size:
            self._reserve(count)
        self._last[0][:count], self._last[1][:count] = keys, impulses
        self._sizes[Sizes.LAST_IMPULSES] = count

    def warm_more(self, keys: np.ndarray, impulses: np.ndarray) -> None:
        """Initial impulses of more contacts."""
        count = self._sizes[Sizes.LAST_IMPULSES]
        others = ~np.isin(self._last[0][:count], keys)
        first, second = (part[:count][others] for part in self._last)
        self.warm(np.concatenate([first, keys]), np.concatenate([second, impulses]))

    def pressing_shapes(self) -> np.ndarray:
        """(2, n) shapes of the pressing contacts of the last step."""
        count = int(self.counts[Counts.CONTACTS])
        pressing = self._solved[: count * self.width : self.width] > 0
        return np.asarray(self._pairs[:2, self._pair_of[:count][pressing]])

    def near_shapes(self, reach: float) -> np.ndarray:
        """(2, n) shapes of the contacts of the last step that pressed or were within reach [m]."""
        count = int(self.counts[Counts.CONTACTS])
        near = self._solved[: count * self.width : self.width] > 0
        near |= self._gaps[:count] <= reach
        return np.asarray(self._pairs[:2, self._pair_of[:count][near]])

    def last_recorded(self) -> list[np.ndarray]:
        """Keys, impulses and offsets of the pressing contacts of the last step."""
        end, count = int(self.counts[Counts.RECORDED_CONTACTS]), self.pressing_shapes().shape[1]
        begin = end - int(
            self.numbers[self.counts[Counts.RECORDED_STEPS] - 1, RecordColumns.PRESSING]
        )
        return [array[begin : begin + count].copy() for array in self._recorded[:3]]

    def last_active(self, longest: float, curved: np.ndarray) -> ActiveContacts:
        """Pressing contacts of the last step.

        Parameters
        ----------
        longest : longest step that might follow [s]
        curved : keys of contacts with means over the path
        """
        last = self.numbers[self.counts[Counts.RECORDED_STEPS] - 1, RecordColumns.PRESSING]
        end = int(self.counts[Counts.RECORDED_CONTACTS])
        keys, impulses, offsets, kept = (part[end - int(last) : end] for part in self._recorded)
        order, room = np.argsort(keys), np.full(keys.size, longest)
        own = keys, impulses, offsets, np.isin(keys, curved), kept > 0, room
        return ActiveContacts(*(part[order] for part in own))

    def rest(self) -> StepOutcome:
        """A step in which no body moves, without contacts."""
        if self.counts[Counts.RECORDED_CONTACTS] >= self.counts[Counts.MAX_RECORDED]:
            return StepOutcome.FULL
        self.numbers[self.counts[Counts.RECORDED_STEPS]] = 0.0
        self.counts[Counts.RECORDED_STEPS] += 1
        self.counts[Counts.CONTACTS], self._sizes[Sizes.LAST_IMPULSES], self.displacement[:] = (
            0,
            0,
            0.0,
        )
        return StepOutcome.DONE

    def append(self, keys: np.ndarray, impulses: np.ndarray, offsets: np.ndarray) -> None:
        """Append contacts to the record of the last step."""
        own = slice(
            int(self.counts[Counts.RECORDED_CONTACTS]),
            int(self.counts[Counts.RECORDED_CONTACTS]) + keys.size,
        )
        kept = np.zeros(keys.size, dtype=np.int32)
        for array, part in zip(self._recorded, (keys, impulses, offsets, kept), strict=True):
            array[own] = part
        self.counts[Counts.RECORDED_CONTACTS] += keys.size
        self.numbers[self.counts[Counts.RECORDED_STEPS] - 1, RecordColumns.PRESSING] += keys.size

    def entries(self, steps: int, longest: np.ndarray, curved: Sequence[np.ndarray]) -> StepEntries:
        """The first recorded steps, with their contacts in the order of the keys.

        Parameters
        ----------
        longest : (steps,) longest step that might follow [s]
        curved : (steps,) keys of the contacts of each step with means over its path
        """
        numbers = self.numbers[:steps].copy()
        count = numbers[:, RecordColumns.PRESSING].astype(int)
        keys, impulses, offsets, kept = (array[: count.sum()] for array in self._recorded)
        owner = np.repeat(np.arange(steps), count)
        order = np.lexsort((keys, owner))
        keys, zero = keys[order], np.zeros(keys.size)
        means = np.zeros(keys.size, dtype=bool)
        for step, own in enumerate(curved):
            if own.size:
                means |= (owner == step) & np.isin(keys, own)
        return StepEntries(
            multiplier=np.zeros((0, steps)),
            count=count,
            owner=np.zeros(keys.size, dtype=int),
            key=keys,
            impulse=impulses[order],
            offset=offsets[order],
            curved=means,
            kept=kept[order] > 0,
            longest=longest,
            loss=numbers[:, RecordColumns.LOSS],
            friction=numbers[:, RecordColumns.FRICTION],
            work=zero,
            fraction=zero,
            residual=numbers[:, RecordColumns.RESIDUAL],
            rounds=numbers[:, RecordColumns.ROUNDS].astype(int),
            converged=np.ones(steps, dtype=bool),
        )

    @property
    def _recorded(self) -> tuple[np.ndarray, ...]:
        return self._pressed, self._impulses, self._offsets, self._kept

    def forget(self, steps: int, contacts: int) -> None:
        """Remove the first steps, and their contacts, from the record."""
        done, pressing = self.counts[Counts.RECORDED_STEPS], self.counts[Counts.RECORDED_CONTACTS]
        self.numbers[: done - steps] = self.numbers[steps:done].copy()
        for array in self._recorded:
            array[: pressing - contacts] = array[contacts:pressing].copy()
        self.counts[Counts.RECORDED_STEPS] -= steps
        self.counts[Counts.RECORDED_CONTACTS] -= contacts

    def remove_last(self) -> None:
        """Remove the last step from the record."""
        self.counts[Counts.RECORDED_STEPS] -= 1
        self.counts[Counts.RECORDED_CONTACTS] -= int(
            self.numbers[self.counts[Counts.RECORDED_STEPS], RecordColumns.PRESSING]
        )
