"""Stacks of consecutive steps of a run, whose maps are evaluated together."""

from __future__ import annotations

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.nonsmooth_motion import ContactRecord
from dalembert.sensitivity.nonsmooth.contact_maps import ContactMaps
from dalembert.sensitivity.nonsmooth.recorded_contacts import RecordedContacts
from dalembert.sensitivity.nonsmooth.stacked_impacts import StackedImpacts
from dalembert.sensitivity.nonsmooth.stacked_maps import StackedMaps, StepColumns

STACK, ENTRIES = 256, 800_000
"""Upper limits of the steps whose maps are evaluated together, and of the entries of their states,
which bound the memory."""
UNMOVED = 0.1
"""Threshold of a correction of positions, relative to the penetration that counts as rounding
[-]."""


def stack_length(size: int) -> int:
    """Number of steps whose maps are evaluated together, with states of ``size`` entries."""
    return int(np.clip(ENTRIES // size, 1, STACK))


class StepStacks:
    """Stacks of a run; the last one is cached.

    Parameters
    ----------
    maps : ContactMaps of the run
    record : ContactRecord
    contacts : RecordedContacts
    single : (K,) mask of the steps with several solutions, which belong to no stack
    sticks : (n,) mask of the contacts of all steps that do not slide
    """

    def __init__(
        self,
        maps: ContactMaps,
        record: ContactRecord,
        contacts: RecordedContacts,
        single: np.ndarray,
        sticks: np.ndarray,
    ):
        step = maps.contact_step
        self._maps, self._record, self._contacts, self._sticks = maps, record, contacts, sticks
        self._x = np.vstack([record.ends.y, record.ends.v])
        has_means = step.smooth.takes_means(step.scheme.theta)
        unfit = has_means or step.smooth.has_joints or step.force_laws.elements
        self._fit = np.zeros_like(single) if unfit else ~single
        self._length = stack_length(self._x.shape[0])
        self._number = -1
        self._impacts: StackedImpacts | None = None
        self._last: tuple[dict[int, int], StackedMaps | None] = {}, None

    def at(self, k: int) -> tuple[StackedMaps, int] | None:
        """Maps that contain those of a step, and its number among them; None if the step has
        joints, means over its path, force laws, corrections of positions or several
        solutions."""
        if not self._fit[k]:
            return None
        number = k // self._length
        if number != self._number:
            self._number, self._last = number, self._evaluated(number)
            self._impacts = None
        places, maps = self._last
        return None if maps is None or k not in places else (maps, places[k])

    def impacts_at(self, k: int) -> tuple[StackedImpacts, int] | None:
        """Impacts that contain those of a step, and its number among them; None for a step outside
        of stacks, or with impacts that are not located there."""
        stacked = self.at(k)
        if stacked is None:
            return None
        maps, place = stacked
        if self._impacts is None:
            self._impacts = StackedImpacts(maps)
        return (self._impacts, place) if self._impacts.located[place] else None

    def _evaluated(self, number: int) -> tuple[dict[int, int], StackedMaps | None]:
        """Places of steps in their maps, and the maps."""
        t, first = self._record.t, number * self._length
        numbers = first + np.flatnonzero(self._fit[first : first + self._length])
        place = np.full(self._fit.size, -1)
        place[numbers] = np.arange(numbers.size)
        rows = np.flatnonzero(place[self._contacts.owner] >= 0)
        contacts, owner = self._contacts.all.some(rows), place[self._contacts.owner[rows]]
        h, last = np.diff(t), np.maximum(numbers - 1, 0)
        ended = self._contacts.ended
        ended = ended[self._contacts.owner[ended] + 1 < place.size]
        ended = ended[place[self._contacts.owner[ended] + 1] >= 0]
        columns = StepColumns(
            t[numbers],
            h[numbers],
            self._x[:, numbers],
            self._x[:, numbers + 1],
            contacts,
            owner,
            begins=self._contacts.follows[rows] < 0,
            sticks=self._sticks[rows],
            earlier=self._x[:, last],
            earlier_t=t[last],
            earlier_h=h[last],
            ended=self._contacts.all.some(ended),
            ended_owner=place[self._contacts.owner[ended] + 1],
            ended_sticks=self._sticks[ended],
        )
        try:
            maps = StackedMaps(self._maps, columns)
        except AnalysisError:  # of one of the steps, which raises it on its own
            return {}, None
        moved = np.abs(maps.following - columns.end).max(axis=0)
        usable = maps.solved & (moved <= UNMOVED * self._maps.contact_step.rounding)
        return {int(numbers[i]): int(i) for i in np.flatnonzero(usable)}, maps
