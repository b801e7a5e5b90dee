"""When contacts act in a step, and which velocities they ask for afterwards."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.contacts import Contacts
from dalembert.options import options

Offsets = np.ndarray
"""(n, k) of the velocities after a step, so that ``u⁺ + offset`` meets the conditions."""


@dataclass(frozen=True, eq=False)
class Approach:
    """Contacts before a step.

    Attributes
    ----------
    contacts : Contacts
    before, free : (n, k) relative velocities at the start, and at the end without impulses
    h : step [s]
    """

    contacts: Contacts
    before: np.ndarray
    free: np.ndarray
    h: float

    def newton(self) -> Offsets:
        """Restitution, ``u_N⁺ ≥ −e u_N⁻`` and ``u_T⁺ + e_T u_T⁻`` (Newton; Moreau 1988)."""
        offsets = self.contacts.tangential[:, None] * self.before
        offsets[:, 0] = self.contacts.restitution * self.before[:, 0]
        return offsets


class ContactScheme(ABC):
    """How a step treats contacts: one file reads like its page.

    A new one says which contacts take part (``acting``), what they ask for (``first``), and, where
    that depends on the impulses found, whether to ask for something else (``again``).
    """

    theta: float
    projection: bool
    anticipates: ClassVar[bool] = False
    """Gaps stay open by themselves, so that none needs to be opened after the step."""

    @abstractmethod
    def acting(self, approach: Approach) -> np.ndarray:
        """(n,) which contacts take part."""

    @abstractmethod
    def first(self, approach: Approach) -> Offsets:
        """What the contacts that take part ask for."""

    def again(
        self, approach: Approach, offsets: Offsets, impulses: np.ndarray, after: np.ndarray
    ) -> Offsets | None:
        """What they ask for instead, once impulses and velocities are known; None to keep them."""
        return None


@options
class MoreauJean(ContactScheme):
    """Moreau–Jean scheme: a gap that would close within half a step bounces in it.

        M (v⁺ − v) = h F_θ + Wᵀ P,   y⁺ = y ⊕ h (θ v⁺ + (1−θ) v)
        g + γ h u_N⁻ ≤ 0  ⇒  0 ≤ u_N⁺ + e u_N⁻ ⟂ P_N ≥ 0

    (Moreau 1988; Jean 1999; Acary & Brogliato 2008, 10.2). Gaps close by up to half a step's
    motion; ``projection`` opens them again, along ``M⁻¹``, without a change of speeds.

    Parameters
    ----------
    theta : 0.5 keeps energy, 1 is implicit
    gamma : part of a step over which a gap is looked ahead
    projection : positions with closed gaps are corrected
    """

    theta: float = 0.5
    gamma: float = 0.5
    projection: bool = True

    def __post_init__(self) -> None:
        check_share("MoreauJean", "theta", self.theta)
        check_share("MoreauJean", "gamma", self.gamma)

    def acting(self, approach: Approach) -> np.ndarray:
        ahead = self.gamma * approach.h * approach.before[:, 0]
        return approach.contacts.distance + ahead <= 0

    def first(self, approach: Approach) -> Offsets:
        return approach.newton()


@options
class AnticipatedImpacts(ContactScheme):
    """Gaps are kept open at the end of every step, so that nothing passes through anything.

    With the midpoint rule, ``y⁺ = y ⊕ h (v⁺ + v)/2``, a linear or convex gap stays open where

        u_N⁺ ≥ s = −2 g/h − u_N⁻

    (gaps at the end of the step: Stewart & Trinkle 1996, Anitescu & Potra 1997). An impact, which
    would leave no room for the half step it still goes on, is taken while there is room:
    ``u_N⁺ ≥ max(−e u_N⁻, s)``. As ``u_N⁺ = s`` or ``−e u_N⁻`` is at most ``−u_N⁻``, the work of
    each normal impulse, ``P_N (u_N⁺ + u_N⁻)/2``, is never positive. Friction that would do work,
    as it stops what a force turns back within the step, follows ``u_T⁺ + u_T⁻`` instead of
    ``u_T⁺``, against which it does none.
    """

    theta: ClassVar[float] = 0.5  # type: ignore[misc]
    projection: ClassVar[bool] = True  # type: ignore[misc]
    anticipates: ClassVar[bool] = True

    def acting(self, approach: Approach) -> np.ndarray:
        return np.ones(approach.contacts.count, dtype=bool)

    def first(self, approach: Approach) -> Offsets:
        offsets = approach.newton()
        room = _room(approach)
        impact = (approach.free[:, 0] < room) & (approach.before[:, 0] <= 0)
        offsets[:, 0] = -np.where(impact, _bounce(approach), room)
        return offsets

    def again(
        self, approach: Approach, offsets: Offsets, impulses: np.ndarray, after: np.ndarray
    ) -> Offsets | None:
        bounce = _bounce(approach)
        pressed = (impulses[:, 0] > 0) & (approach.before[:, 0] <= 0) & (-offsets[:, 0] < bounce)
        work = (impulses[:, 1:] * (after + approach.before)[:, 1:]).sum(axis=1)
        pushing = (work > 0) & (offsets[:, 1:] != approach.before[:, 1:]).any(axis=1)
        if not (pressed.any() or pushing.any()):
            return None
        changed = offsets.copy()
        changed[pressed, 0] = -bounce[pressed]
        changed[pushing, 1:] = approach.before[pushing, 1:]
        return changed


def _open(approach: Approach) -> np.ndarray:
    """``s``, the least speed after which the gap is not closed."""
    return -2 * np.maximum(approach.contacts.distance, 0) / approach.h - approach.before[:, 0]


def _bounce(approach: Approach) -> np.ndarray:
    """What an impact asks for."""
    wanted = -approach.contacts.restitution * approach.before[:, 0]
    return np.maximum(wanted, _open(approach))


def _room(approach: Approach) -> np.ndarray:
    """The least speed that leaves room for an impact in the next step, ``g⁺ ≥ −(1−e) h u_N⁺/2``."""
    before, e = approach.before[:, 0], approach.contacts.restitution
    gap = np.maximum(approach.contacts.distance, 0) + approach.h * before / 2
    least = -gap / (approach.h * (1 - e / 2))
    return np.where(before <= 0, np.maximum(least, _open(approach)), _open(approach))


def check_share(owner: str, name: str, value: float) -> None:
    """A number from 0 to 1.

    Raises
    ------
    UnsupportedError
        It is none.
    """
    if not 0 <= value <= 1:
        raise UnsupportedError(f"{owner}({name}={value}): {name} must be from 0 to 1")
