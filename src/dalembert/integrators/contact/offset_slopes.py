"""Derivatives of the velocity offsets of contacts on the branches taken."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.errors import AnalysisError
from dalembert.integrators.contact.approach import Approach

TIED = 1e-12
"""Rounding error of the speed after an impact without restitution, relative to the speed before
[-]."""


@dataclass(frozen=True, eq=False)
class OffsetSlopes:
    """Derivatives (n,) of the velocity offsets, ``u⁺ + offset`` satisfying the conditions.

    Attributes
    ----------
    gap, speed, restitution : of the normal offset, by ``g``, ``u_N⁻``, ``e``
    forced : of the normal offset, by the largest change of a normal speed by forces in the step
    change : this change [m/s] of contacts whose offsets depend on it, as their offsets state it
    struck : of the normal offset, by the normal speed after impacts at the start of the step
    idle : (n, k − 1) mask of the tangential components whose offsets are ``u_T⁻``; others follow
        Newton's law
    bounces : mask of the contacts that follow Newton's law, or stop in time to remain open
    """

    gap: np.ndarray
    speed: np.ndarray
    restitution: np.ndarray
    forced: np.ndarray
    change: np.ndarray
    struck: np.ndarray
    idle: np.ndarray
    bounces: np.ndarray

    def some(self, selected: np.ndarray) -> OffsetSlopes:
        """Those of the selected contacts."""
        return OffsetSlopes(*(getattr(self, field.name)[selected] for field in fields(self)))


def newton_slopes(approach: Approach, offsets: np.ndarray) -> OffsetSlopes:
    """Derivatives of Newton's law, ``e u_N⁻`` and ``e_T u_T⁻``, or of the speeds after impacts at
    the start; or of ``u_N⁻`` if that is the offset."""
    zero, u = np.zeros(approach.contacts.count), approach.before[:, 0]
    value, *slopes = _rebound(approach)
    parts = np.abs(offsets[:, 0] - u) < np.abs(offsets[:, 0] - value)
    speed, restitution, struck = (np.where(parts, 0.0, slope) for slope in slopes)
    idle = idle_components(approach, offsets)
    return OffsetSlopes(zero, speed + parts, restitution, zero, zero, struck, idle, ~parts)


def idle_components(approach: Approach, offsets: np.ndarray) -> np.ndarray:
    """(n, k − 1) mask of the tangential components whose offsets are ``u_T⁻``; others follow
    Newton's law: slip, and rotations, of a contact each have one of both."""
    before, law = approach.before[:, 1:], approach.newton()[:, 1:]
    idle, slips = np.zeros(before.shape, dtype=bool), approach.contacts.linear - 1
    for part in (slice(0, slips), slice(slips, None)):
        lengths = (_lengths((offsets[:, 1:] - other)[:, part]) for other in (before, law))
        idle[:, part] = np.less(*lengths)[:, None]
    return idle


def _rebound(approach: Approach) -> tuple[np.ndarray, ...]:
    """``−Approach.rebound``, and its derivatives by ``u_N⁻``, ``e`` and the speed after impacts at
    the start."""
    u, e = approach.before[:, 0], approach.contacts.laws.restitution
    hit, speed, restitution, struck = np.broadcast_to(approach.hit, u.shape), e, u, 0 * u
    if approach.struck is not None:
        after = approach.struck[:, 0]
        free = (after > TIED * u) & (after < -u)
        speed = np.where(hit, (after >= -u) & (u < 0), speed)
        restitution, struck = np.where(hit, 0.0, restitution), np.where(hit & free, -1.0, 0.0)
    return -approach.rebound, speed, restitution, struck


def anticipated_slopes(
    approach: Approach, offsets: np.ndarray, closing: float, rounding: float | np.ndarray
) -> OffsetSlopes:
    """Derivatives of the branch of ``AnticipatedImpacts`` that an offset equals.

    Where branches tie, as at rest, closed contacts remain closed. A contact on no other branch
    approaches by less than the fraction of its gap, as forces change its speed, or a share of
    that; the caller verifies this change.

    Parameters
    ----------
    offsets : (n, k)
    closing : fraction of a gap that a resting contact closes per step
    rounding : difference of speeds that counts as rounding [m/s]

    Raises
    ------
    AnalysisError
        An offset follows no branch.
    """
    contacts, before, h = approach.contacts, approach.before, approach.h
    gap, u = np.maximum(contacts.distance, 0), before[:, 0]
    newton = contacts.laws.follows(ImpactLaw.NEWTON)
    e = np.where(newton, contacts.laws.restitution, 0.0)
    bounce, *bounced, struck = _rebound(approach)
    overlaps = contacts.distance < -rounding * h
    room, stop = (h + (1 - e) * approach.longest) / 2, (h + approach.longest) / 2
    zero = np.zeros(u.size)
    one = np.where(overlaps, 0.0, 1.0)
    margin = (gap + h * u / 2) / room
    by_restitution = margin * approach.longest / 2 / room
    factor, closes = contacts.laws.restitution, (gap + h * u / 2) / stop
    reversed_by = (1 - factor) / stop * one, (1 - factor) * h / 2 / stop + factor
    opens = [2 * contacts.distance / h + u, 2 / h + zero, 1 + zero, zero, zero]
    rests = [closing * gap / h, closing / h * one, zero, zero, zero]
    separates = [closes, one / stop, h / 2 / stop + zero, zero, zero]
    reversing = [(1 - factor) * closes + factor * u, *reversed_by, u - closes, zero]
    branches = np.array(  # value, derivatives by g, u and e, by the change of speed by forces
        [
            rests,
            opens,  # remains open
            [bounce, zero, *bounced, zero],  # impact
            separates,
            [margin, one / room, h / 2 / room, newton * by_restitution, zero],  # room for impacts
            [u, zero, 1 + zero, zero, zero],  # no work
            opens,  # remains open while it separates
            reversing,
            [offsets[:, 0], zero, zero, zero, 1 + zero],  # approaches as forces change its speed
        ]
    )
    tied = np.abs(branches[:, 0] - offsets[:, 0]) <= rounding
    tied[0] &= ~tied[2] | (np.abs(u) <= rounding)
    tied[1] &= (u <= 0) | overlaps
    tied[2] &= u <= 0
    tied[-2] &= (u >= 0) & (u < closes)
    tied[-1] &= (u <= rounding - branches[0, 0]) & (offsets[:, 0] >= 0)
    tied[-1] &= offsets[:, 0] <= branches[0, 0]
    parting = np.array([(1 - factor) * closes, *reversed_by, -closes, zero])
    parting[2] -= factor
    at_rest = np.array([rests, separates])
    slow, slows, slow_change = _slow(offsets[:, 0], u, at_rest, parting, rounding)
    tied[3:6] &= ~(tied[-2] | slows.any(axis=0))  # equal with e = 0 or 1 alone
    branches, tied = np.concatenate([branches, slow]), np.concatenate([tied, slows])
    lost = ~tied.any(axis=0)
    if lost.any():
        speed = -offsets[np.argmax(lost), 0]
        raise AnalysisError(
            f"the normal speed {speed:.6g} m/s at the end of a step follows no branch of "
            "AnticipatedImpacts with a derivative; use integrator=da.MoreauJean()"
        )
    number = np.argmax(tied, axis=0)
    _, by_gap, speed, restitution, forced = branches[number, :, np.arange(u.size)].T
    idle = idle_components(approach, offsets)
    bounces = ((number == 1) | (number == 2)) & (u < -rounding)
    struck = np.where(number == 2, struck, 0.0)
    change = np.where(number == branches.shape[0] - 1, slow_change, offsets[:, 0])
    change = np.where(forced != 0, change, 0.0)
    return OffsetSlopes(by_gap, speed, restitution, forced, change, struck, idle, bounces)


def _slow(
    offset: np.ndarray,
    u: np.ndarray,
    at_rest: np.ndarray,
    parting: np.ndarray,
    rounding: float | np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Branches (3, 5, n) of slow approach, ``(1 − w) rest + w parting`` with ``w = 1 + u/c``, where
    ``c`` is the speed by which a resting contact closes its gap; masks of the contacts on these;
    and the change of speed by forces of the last branch.

    At rest, contacts close their gaps gradually, stop in time to remain open (2, 5, n), or approach
    as forces change their speed.
    """
    rests, separates = at_rest
    slow = (u < 0) & (u > -rests[0])
    limit = np.where(slow, rests[0], 1.0)
    share = np.where(slow, 1 + u / limit, 0.0)
    slow &= share < 1  # others are at rest within rounding
    share = np.where(slow, share, 0.0)
    forced = np.zeros_like(rests)
    forced[0] = (offset - share * parting[0]) / (1 - share)
    forced[4] = 1.0
    resting = np.stack([*at_rest, forced])
    branches = (1 - share) * resting + share * parting
    change = (parting[0] - resting[:, 0]) / limit
    branches[:, 2] += change
    branches[:, 1] += change * (1 - share) * rests[1]
    tied = slow & (np.abs(branches[:, 0] - offset) <= rounding)
    least = np.minimum(rests[0], separates[0])
    tied[0] &= rests[0] <= separates[0]
    tied[1] &= separates[0] <= rests[0]
    tied[2] &= (forced[0] >= 0) & (forced[0] <= least)
    return branches, tied, forced[0]


def _lengths(vectors: np.ndarray) -> np.ndarray:
    return np.asarray(np.linalg.norm(vectors, axis=1))
