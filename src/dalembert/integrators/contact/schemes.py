"""Contact schemes: active contacts of a step and their velocity conditions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.contact.approach import CLOSING, Approach, Offsets
from dalembert.options import options

if TYPE_CHECKING:
    from dalembert.integrators.contact.offset_slopes import OffsetSlopes


class ContactScheme(ABC):
    """Treatment of contacts in a step.

    A new scheme selects the active contacts (``acting``), states their velocity offsets
    (``first``) and, if these depend on the impulses, updated offsets (``again``), and derivatives
    of the offsets on the branches taken (``slopes``).
    """

    theta: float
    projection: bool
    anticipates: ClassVar[bool] = False
    """True if the scheme keeps gaps open, so that no position correction is needed."""

    @abstractmethod
    def acting(self, approach: Approach) -> np.ndarray:
        """(n,) mask of the active contacts."""

    def striking(self, approach: Approach) -> np.ndarray:
        """(n,) mask of the active contacts that take part in impacts at the start of the step."""
        return np.ones(approach.contacts.count, dtype=bool)

    @abstractmethod
    def first(self, approach: Approach) -> Offsets:
        """Velocity offsets of the active contacts, by Newton's law of impact."""

    def again(
        self, approach: Approach, offsets: Offsets, impulses: np.ndarray, after: np.ndarray
    ) -> Offsets:
        """Updated offsets for the computed impulses and velocities."""
        return offsets

    @abstractmethod
    def slopes(
        self, approach: Approach, offsets: Offsets, rounding: float | np.ndarray
    ) -> OffsetSlopes:
        """Derivatives of the last offsets of a step.

        Where branches tie within ``rounding`` of a speed, as at rest, closed contacts remain
        closed.
        """


@options
class MoreauJean(ContactScheme):
    """Moreau–Jean scheme: a gap that would close within half a step has its impact in the step.

        M (v⁺ − v) = h F_θ + Wᵀ P,   y⁺ = y ⊕ h (θ v⁺ + (1−θ) v)
        g + γ h u_N⁻ ≤ 0  ⇒  0 ≤ u_N⁺ + e u_N⁻ ⟂ P_N ≥ 0

    (Moreau 1988; Jean 1999; Acary & Brogliato 2008, 10.2). Gaps close by up to half a step's
    motion; ``projection`` opens them again, along ``M⁻¹``, without a change of speeds. Gaps that
    would then be opened act in the step, too, so that resting bodies are not lifted (combined
    projection: Acary 2013), those that part with ``u_N⁺ ≥ −u_N⁻``, which does no work, unless
    their friction supplies more than a hundredth of the work of lifting the bodies. Lifted bodies
    and impacts with friction (Kane's paradox) may add energy; a warning states how much.
    With ``theta=0.5``, friction of spatial contacts that slide throughout a step opposes
    ``u_T⁺ + u_T⁻`` (``mean_slip``).

    Parameters
    ----------
    theta : 0.5 conserves energy, 1 is implicit [-]
    gamma : fraction of a step over which a gap is extrapolated [-]
    projection : whether positions with penetrating gaps are corrected

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("clack", gravity=(0, 0))
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.3), velocity=(0, -2)))
    >>> contact = planar.contact
    >>> shapes = [contact.Circle(ball.center, 0.1), contact.HalfPlane(system.ground.center)]
    >>> hits = system.add(planar.Collisions("hits", shapes, restitution=0.5))
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
        return approach.contacts.distance + ahead <= approach.rounding

    def first(self, approach: Approach) -> Offsets:
        offsets, parting = approach.newton(), approach.before[:, 0]
        if self.projection:
            offsets[:, 0] = np.maximum(offsets[:, 0], parting)
        hit = np.broadcast_to(approach.hit, parting.shape)
        lower = np.where(parting > 0, offsets[:, 0], -np.inf)
        offsets[hit, 0] = np.maximum(-approach.rebound, lower)[hit]
        return offsets

    def slopes(
        self, approach: Approach, offsets: Offsets, rounding: float | np.ndarray
    ) -> OffsetSlopes:
        from dalembert.integrators.contact.offset_slopes import newton_slopes

        return newton_slopes(approach, offsets)


ROUNDING = 1e-10
"""Tolerance of the total work of contacts, relative to the sum of its magnitudes [-]."""


@options
class AnticipatedImpacts(ContactScheme):
    """Scheme that keeps gaps open at the end of every step, without penetration.

    With the midpoint rule, ``y⁺ = y ⊕ δ``, ``δ = h (v⁺ + v)/2``, a gap stays open where

        u_N⁺ ≥ s = −2 g/h − u_N⁻,      u⁻ + u⁺ = W_m (v + v⁺) + 2 w_m

    (gaps at the end of the step: Stewart & Trinkle 1996, Anitescu & Potra 1997), with directions in
    the middle of the step, but for ``O(h³)``. Where directions turn, ``g`` is less a clearance of
    up to 2e-7 of the size of the bodies, which is smaller where they hardly turn. For gaps that are
    closed at ``y⁺`` nevertheless, the step is repeated with means over its path

        W̄ = ∫ W(y ⊕ s δ) (d(y ⊕ s δ)/ds / δ) ds,      ḡ = g(y⁺) − W̄ δ − h w̄,      0 ≤ s ≤ 1

    in place of ``W``, ``g`` and ``w``, until ``g(y⁺) ≥ 0``: the converged step satisfies the
    condition for the gap itself, and impulses along ``W̄`` do the work ``P_N (g(y⁺) − g)/h``, which
    is not positive (discrete gradient: Gonzalez 1996). Along tangents, ``W̄`` is the mean of ``W``
    alone, by which a body that rolls without slip does so in both kinds of steps. An impact needs
    part of the gap for the half step before it, so it is applied one step early, while the gap is
    large enough: ``u_N⁺ ≥ max(−e u_N⁻, s)``; not if its directions turn so that it remains open
    by itself, as of a corner that swings past a wall. A contact whose speed after the fall over
    the gap is within 1.9 times the change of speed by forces in a step comes to rest: it closes
    its gap gradually, and leaves room to stop. A contact that parts and is pressed by an impact
    elsewhere may close its gap without restitution, and reverses its speed with ``e = 1``;
    between both, the least speed after the step varies linearly with that before. An impact in the
    first step may penetrate; the gap is opened after the step. The work ``P·(u⁺ +
    u⁻)/2`` of an impact is not positive. A contact may do positive work if a force reverses the
    motion within the step; if the work of all contacts is positive, ``u⁺ + u⁻`` replaces ``u⁺``
    there, which does no work, so that contacts never create energy. Contacts with static friction
    above that of sliding stop instead, which may create energy of the order of the squared step.
    Friction of spatial contacts that slide throughout a step opposes ``u_T⁺ + u_T⁻``
    (``mean_slip``).

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("bounce", gravity=(0, -10))
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.3)))
    >>> contact = planar.contact
    >>> shapes = [contact.Circle(ball.center, 0.1), contact.HalfPlane(system.ground.center)]
    >>> hits = system.add(planar.Collisions("hits", shapes, restitution=1.0))
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

    def striking(self, approach: Approach) -> np.ndarray:
        closed = approach.contacts.distance <= approach.rounding
        return np.asarray(closed | (approach.free[:, 0] < approach.least.room))

    def first(self, approach: Approach) -> Offsets:
        offsets = approach.newton()
        margin = approach.least.room
        impact = (approach.free[:, 0] < margin) | approach.hit
        offsets[:, 0] = -np.where(impact, approach.least.bounce, margin)
        return offsets

    def again(
        self, approach: Approach, offsets: Offsets, impulses: np.ndarray, after: np.ndarray
    ) -> Offsets:
        bounce = approach.least.bounce
        pressed = (impulses[:, 0] > 0) & (-offsets[:, 0] < bounce)
        parting = approach.before[:, 0]
        pressed &= (parting <= 0) | (offsets[:, 0] != parting)  # excludes idle contacts
        work = (impulses * (after + approach.before)).sum(axis=1)
        supplied = float(work.sum())
        if not pressed.any() and supplied <= 0:
            return offsets
        changed = offsets.copy()
        changed[pressed, 0] = -bounce[pressed]
        if supplied > 0 and supplied > _inexact_work(approach, impulses, after):
            idle = changed.copy()
            idle[:, 0] = np.maximum(changed[:, 0], approach.before[:, 0])
            slips = ~approach.contacts.laws.higher_at_rest  # the others stop
            idle[slips, 1:] = approach.before[slips, 1:]
            changed[work > 0] = idle[work > 0]
        return changed

    def slopes(
        self, approach: Approach, offsets: Offsets, rounding: float | np.ndarray
    ) -> OffsetSlopes:
        from dalembert.integrators.contact.offset_slopes import anticipated_slopes

        return anticipated_slopes(approach, offsets, CLOSING, rounding)


def _inexact_work(approach: Approach, impulses: np.ndarray, after: np.ndarray) -> float:
    """Total work of contacts that results from rounding and opens overlaps of rounding."""
    magnitude = np.abs(impulses) * (np.abs(after) + np.abs(approach.before))
    overlap = np.maximum(-approach.contacts.distance, 0.0)
    opening = (2 * impulses[:, 0] * overlap / approach.h).sum()
    return float(ROUNDING * magnitude.sum() + opening)


def check_share(owner: str, name: str, value: float) -> None:
    """Raise unless the value is between 0 and 1.

    Raises
    ------
    UnsupportedError
        Names the option and its value.
    """
    if not 0 <= value <= 1:
        raise UnsupportedError(f"{owner}({name}={value}): {name} must be from 0 to 1")
