"""Changes of contact states in a step, and at nearby parameters."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from dalembert.sensitivity.nonsmooth.contact_equations import ContactEquations

MARGIN = 0.01
"""Threshold of the reserve of friction, slip or resting speed near a change of state [-]."""


@dataclass(frozen=True)
class ContactChanges:
    """Changes of contact states in a step, and at nearby parameters.

    Attributes
    ----------
    impacts : number of moving impacts
    simultaneous : some impacts on the same bodies come at one instant
    successive : number of impacts that come one after the other on the same bodies
    grazing : a gap closes close to the threshold of an impact
    changing : a contact is about to slip or to stick
    redundant : contacts contradict each other after most changes
    inelastic : a contact by the energetic law has no restitution
    breaks : number of instants at which contacts with static friction break away
    """

    impacts: int = 0
    simultaneous: bool = False
    successive: int = 0
    grazing: bool = False
    changing: bool = False
    redundant: bool = False
    inelastic: bool = False
    breaks: int = 0


def near_change(
    contacts: ContactEquations, impulses: np.ndarray, groups: tuple[int, ...], change: float
) -> np.ndarray:
    """Mask of the contacts close to the change between sticking and slipping.

    Parameters
    ----------
    impulses : (n, k)
    groups : widths of the groups of tangential components
    change : largest change of a speed in the step
    """
    values, near = contacts.gaps.values, np.zeros(impulses.shape[0], dtype=bool)
    starts, row = np.cumsum([1, *groups]), np.arange(near.size)
    for begin, end in pairwise(starts):
        push, slip = (np.linalg.norm(u[:, begin:end], axis=1) for u in (impulses, values.after))
        limit = values.laws[row, contacts.column[:, begin]] * impulses[:, 0]
        slips = contacts.own[:, begin:end].any(axis=(1, 2))
        close = np.where(slips, slip <= MARGIN * change, push > (1 - MARGIN) * limit)
        near |= (limit > 0) & close
    return near
