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
    begins : whether it is the first step, so that none before could anticipate an impact
    """

    contacts: Contacts
    before: np.ndarray
    free: np.ndarray
    h: float
    begins: bool = False

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

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("clack", gravity=(0, 0))
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.3), velocity=(0, -2)))
    >>> floor = (system.ground.center, (0, 1))
    >>> hits = system.add(planar.Collisions("hits", [(ball.center, 0.1)], [floor], restitution=0.5))
    >>> scheme = da.MoreauJean(theta=0.5)
    >>> motion = da.solve_nonsmooth(system.build(), 0.2, step=0.01, integrator=scheme)
    >>> round(motion["ball.vy"][-1].item(), 9)  # e times as fast
    1.0
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


SLOW, CLOSING = 2.0, 0.5
"""Approach, by what forces change in a step, that counts as rest; share of a gap closed in one."""
ROUNDING = 1e-10
"""Share of the energy that goes through contacts by which its sum is uncertain."""


@options
class AnticipatedImpacts(ContactScheme):
    """Gaps are kept open at the end of every step, so that nothing passes through anything.

    With the midpoint rule, ``y⁺ = y ⊕ h (v⁺ + v)/2``, a linear or convex gap stays open where

        u_N⁺ ≥ s = −2 g/h − u_N⁻

    (gaps at the end of the step: Stewart & Trinkle 1996, Anitescu & Potra 1997). An impact, which
    would leave no room for the half step it still goes on, is taken while there is room:
    ``u_N⁺ ≥ max(−e u_N⁻, s)``. What comes no faster than forces can change in two steps rests, and
    is let on to the surface slowly. An impact at the very start, before which there is no step, may
    close its gap within the first step; the gap is opened after it. The work ``P·(u⁺ + u⁻)/2`` of
    an impact is not positive. A contact does work where it stops what a force turns back within the
    step; if all contacts together would, ``u⁺ + u⁻`` takes the place of ``u⁺`` there, against which
    they do none, so that contacts never create energy.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("bounce", gravity=(0, -10))
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.3)))
    >>> floor = (system.ground.center, (0, 1))
    >>> hits = system.add(planar.Collisions("hits", [(ball.center, 0.1)], [floor], restitution=1.0))
    >>> scheme = da.AnticipatedImpacts()
    >>> motion = da.solve_nonsmooth(system.build(), 1.0, step=0.01, integrator=scheme)
    >>> bool(motion["ball.y"].min() > 0.1 - 1e-12), bool(abs(motion["energy"] - 3).max() < 1e-9)
    (True, True)
    """

    theta: ClassVar[float] = 0.5  # type: ignore[misc]
    projection: ClassVar[bool] = True  # type: ignore[misc]
    anticipates: ClassVar[bool] = True

    def acting(self, approach: Approach) -> np.ndarray:
        return np.ones(approach.contacts.count, dtype=bool)

    def first(self, approach: Approach) -> Offsets:
        offsets = approach.newton()
        room = _room(approach, approach.contacts.restitution)
        impact = approach.free[:, 0] < room
        offsets[:, 0] = -np.where(impact, _bounce(approach), room)
        return offsets

    def again(
        self, approach: Approach, offsets: Offsets, impulses: np.ndarray, after: np.ndarray
    ) -> Offsets | None:
        bounce = _bounce(approach)
        pressed = (impulses[:, 0] > 0) & (-offsets[:, 0] < bounce)
        parting = approach.before[:, 0]
        pressed &= (parting <= 0) | (offsets[:, 0] < parting)  # others have been made idle
        changed = offsets.copy()
        changed[pressed, 0] = -bounce[pressed]
        taking_part = np.abs(impulses) * (np.abs(after) + np.abs(approach.before))
        work = (impulses * (after + approach.before)).sum(axis=1)
        if work.sum() > ROUNDING * taking_part.sum():
            idle = np.maximum(changed, approach.before)
            idle[:, 1:] = approach.before[:, 1:]
            changed[work > 0] = idle[work > 0]
        return changed if (changed != offsets).any() else None


def _open(approach: Approach) -> np.ndarray:
    """``s``, the least speed after which the gap is not closed."""
    return -2 * np.maximum(approach.contacts.distance, 0) / approach.h - approach.before[:, 0]


def _room(approach: Approach, restitution: np.ndarray | float) -> np.ndarray:
    """The least speed that leaves room for an impact in the next step, ``g⁺ ≥ −(1−e) h u_N⁺/2``."""
    gap = np.maximum(approach.contacts.distance, 0) + approach.h * approach.before[:, 0] / 2
    return np.maximum(-gap / (approach.h * (1 - restitution / 2)), _open(approach))


def _bounce(approach: Approach) -> np.ndarray:
    """The least speed of what is pressed: after an impact, of what rests, of what parts."""
    before, e = approach.before[:, 0], approach.contacts.restitution
    forced = float(np.abs(approach.free[:, 0] - before).max(initial=0.0))
    closing = CLOSING * np.maximum(approach.contacts.distance, 0) / approach.h
    resting = np.where(before > 0, _room(approach, 0.0), -np.minimum(closing, forced))
    impact = before < -SLOW * forced
    least = np.where(impact & approach.begins, -np.inf, _open(approach))  # opened after the step
    return np.maximum(np.where(impact, -e * before, resting), least)


def check_share(owner: str, name: str, value: float) -> None:
    """A number from 0 to 1.

    Raises
    ------
    UnsupportedError
        It is none.
    """
    if not 0 <= value <= 1:
        raise UnsupportedError(f"{owner}({name}={value}): {name} must be from 0 to 1")
