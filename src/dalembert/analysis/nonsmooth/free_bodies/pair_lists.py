"""Calls of the machine code of a step, with lists of near pairs and orders of elimination."""

from __future__ import annotations

from abc import abstractmethod

import numpy as np

from dalembert.analysis.nonsmooth.free_bodies.recorded_contacts import RecordedContacts
from dalembert.analysis.nonsmooth.free_bodies.step_arrays import integers
from dalembert.analysis.nonsmooth.free_bodies.step_shapes import StepShapes
from dalembert.analysis.nonsmooth.gaps.neighbours import Neighbours
from dalembert.integrators.contact.places import Counts, Inputs, Status
from dalembert.integrators.contact.step_calls import Calls, StepOutcome
from dalembert.integrators.contact.step_places import Limits, Sizes

GROWTH = 1.5
"""Ratio of new memory for pairs or contacts to the number that first exceeded it [-]."""
RENEWALS = 4
"""Upper limit of the repetitions of a call with other lists and orders."""


class PairLists(RecordedContacts):
    """Calls for which lists of pairs and orders of elimination are renewed.

    A subclass allocates the arrays.

    Attributes
    ----------
    corners, normals : of the shapes
    lists : number of lists of pairs so far
    """

    corners: np.ndarray
    normals: np.ndarray
    radii: np.ndarray
    lists: int
    _shapes: StepShapes
    _neighbours: Neighbours
    _status: np.ndarray
    _old: tuple[np.ndarray, np.ndarray]
    _order: dict[int, np.ndarray]
    _contacts: int
    _entries: int

    @abstractmethod
    def _allocate(self, pairs: int, contacts: int, entries: int) -> None:
        """Arrays for numbers of listed pairs, of contacts and of matrix entries."""

    def __call__(self) -> StepOutcome:
        """A step from the state and the forces in the arrays; other lists of pairs and orders of
        elimination are made where these are needed."""
        for _ in range(RENEWALS):
            assert self._loop is not None
            self._loop()
            outcome = StepOutcome(int(self.counts[Counts.OUTCOME]))
            if outcome is StepOutcome.OUTDATED and np.isfinite(self._status[Status.REACH]):
                self._renew_list(float(self._status[Status.REACH]))
            elif outcome is StepOutcome.UNORDERED:
                self._renew_order()
            elif outcome is StepOutcome.MORE:
                self._reserve(int(self.counts[Counts.CONTACTS]))
            else:
                return outcome
        return StepOutcome.UNSOLVED

    def again(self) -> StepOutcome:
        """The last step, whose entry in the record is removed, with the forces in the arrays."""
        self.remove_last()
        self._sizes[Sizes.CALL] = Calls.AGAIN
        outcome = self()
        self._sizes[Sizes.CALL] = Calls.STEP
        return outcome

    def _renew_list(self, reach: float) -> None:
        """Pairs within reach and a margin."""
        centers, radii = self._shapes.sizes(self.corners, self.radii)
        near = self._neighbours.listed(centers, self.normals.copy(), radii, reach)
        pairs, laws = self._shapes.touching(near)
        self.renumber(pairs)
        if pairs.shape[1] > self._pairs.shape[1]:
            self._allocate(int(GROWTH * pairs.shape[1]), self._contacts, self._entries)
        self.counts[Counts.PAIRS] = count = pairs.shape[1]
        self._pairs[:2, :count], self._pairs[2, :count] = pairs, laws
        self._old[0][:], self._old[1][:] = near.positions, near.normals
        self.lists += 1
        self.limits[Limits.REACH] = near.reach

    def _renew_order(self) -> None:
        """Order of elimination for the contacts of the step."""
        bodies = self.body[self._pairs[:2, self._ordered_pairs()]]
        order = self._motion.orderings.between(*bodies[:, (bodies >= 0).all(axis=0)])
        parts = {
            Inputs.BLOCK_OF_SPEED: order.owner,
            Inputs.PLACE_IN_BLOCK: order.position,
            Inputs.FACTOR_STARTS: order.first,
            Inputs.FACTOR_ROWS: order.row,
            Inputs.BLOCK_MEMBERS: order.members,
        }
        rows = self._order[Inputs.FACTOR_ROWS]
        if order.row.size > rows.size or order.entries > self._entries:
            self._order[Inputs.FACTOR_ROWS] = integers(int(GROWTH * order.row.size) + 1)
            entries = int(GROWTH * order.entries)
            self._allocate(self._pairs.shape[1], self._contacts, entries)
        for place, part in parts.items():
            self._order[place].ravel()[: part.size] = part.ravel()
        self.counts[Counts.ENTRIES] = order.entries

    def _ordered_pairs(self) -> np.ndarray:
        """Listed pairs that an order of elimination covers."""
        return self._pair_of[: self.counts[Counts.CONTACTS]]

    def reorder(self) -> None:
        """Order of elimination without the bodies that take no part."""
        self._motion.orderings.forget()
        self._renew_order()
