"""Impacts that a step misses, as gaps close and open again within it.

Both schemes evaluate gaps and their directions at few positions of a step. Where directions turn, a
gap may be open at all of these and closed in between, as of a corner that swings through the
surface of a wall. Candidates are gaps of shapes without impulses that close at the start of the
step and open at its end, for which the cubic by both gaps and rates becomes negative. Their shapes
are followed through the step. The energy of the missing impact is that of the effective mass along
the normal where the shapes touch first.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from dalembert.analysis.nonsmooth.between_steps import between
from dalembert.analysis.nonsmooth.checks.passages import Passage, crossing, lowest
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.mobility import delassus
from dalembert.analysis.nonsmooth.starts.touching_shapes import bodies_of
from dalembert.analysis.nonsmooth.step_state import StepStart
from dalembert.integrators.contact.contacts import Contacts, among
from dalembert.results.nonsmooth_motion import ContactRecord

SHARE = 0.01
"""Energy of a missing impact, relative to the energy in the motion, that causes a warning [-]."""
MOST = 100
"""Upper limit of the number of recorded impacts, those with the largest energies, and of the steps
in machine code that are searched, those with the largest rotations."""
TURN = 0.2
"""Minimum rotation of a body in a step in machine code that is searched [rad]. A point that swings
through a surface touches it half of this before its path is parallel to it: its speed along the
normal has at most the share ``(TURN/2)²``, ``SHARE``, of the energy of its rotation."""


class Ends(Protocol):
    """A step: positions and speeds at its end, contacts that press, and gaps that may be missed."""

    @property
    def y(self) -> np.ndarray: ...
    @property
    def v(self) -> np.ndarray: ...
    @property
    def pressing(self) -> tuple[np.ndarray, np.ndarray]: ...
    @property
    def returning(self) -> Contacts | None: ...


@dataclass(frozen=True)
class RecordedStep:
    """``Ends`` of a step of a record."""

    y: np.ndarray
    v: np.ndarray
    pressing: tuple[np.ndarray, np.ndarray]
    returning: Contacts | None = None


@dataclass(frozen=True)
class MissingImpact(Passage):
    """Two shapes that overlap within a step, and are apart at both of its ends.

    Attributes
    ----------
    speed : with which the shapes touch first [m/s]
    energy : of the motion along the normal; infinite if drivers prescribe it [J]
    """

    speed: float
    energy: float


def returning_gaps(start: StepStart, near: Contacts, result: Ends, rounding: float) -> Contacts:
    """Gaps without impulses that their rate at the start of a step would close.

    Parameters
    ----------
    near : gaps with their directions at the start
    rounding : gap that counts as closed [m]
    """
    ends = near.distance + start.h * near.speeds(start.v)[:, 0]
    pressed = among(near.key, result.pressing[0])
    return near.some((near.distance > rounding) & (ends < -rounding) & ~pressed)


def find_missing_impact(
    step: ContactStep, t: float, h: float, y: np.ndarray, v: np.ndarray, result: Ends
) -> MissingImpact | None:
    """The first one in a step from ``t``, ``y``, ``v``; None without any."""
    if result.returning is None or not (gaps := step.rigid(result.returning)).count:
        return None
    end, travel = result.y, step.model.equations.manifold.lead(y, result.y)
    after = step.near(step.at(t + h, end), travel[:, None])
    pairs, pairs_after = step.pairs(gaps.key), step.pairs(after.key)
    rates, rates_after = (h * of.speeds(w)[:, 0] for of, w in ((gaps, v), (after, result.v)))
    pressed = step.pairs(result.pressing[0])
    for pair in np.setdiff1d(np.intersect1d(pairs, pairs_after), pressed):
        first, last = np.flatnonzero(pairs == pair), np.flatnonzero(pairs_after == pair)
        row = first[np.argmin(gaps.distance[first])]
        beyond = last[np.argmin(after.distance[last])]
        ends = gaps.distance[row], rates[row], after.distance[beyond], rates_after[beyond]
        if ends[2] < 0 or ends[3] <= 0 or not _closes(*ends):
            continue

        def nearest(s: float, pair: int = pair) -> Contacts:
            near = step.near(step.at(t + s * h, between(step.model, y, end, s)), travel[:, None])
            own = np.flatnonzero(step.pairs(near.key) == pair)
            return near.some(own[np.argsort(near.distance[own])][:1])

        def gap(s: float) -> float:
            return float(nearest(s).distance.min(initial=np.inf))

        deepest = lowest(gap)
        if (depth := -gap(deepest)) <= step.rounding:
            continue
        entry, leaving = (crossing(gap, deepest, limit) for limit in (0.0, 1.0))
        contact = nearest(entry)
        speed = max(-float(contact.speeds(travel / h)[0, 0]), 0.0)
        mobility = step.begin(t, h, y, v, False).motion.mobility
        inverse = float(delassus(contact.directions[:1], mobility).diagonal()[0])
        energy = speed**2 / (2 * inverse) if inverse > 0 else np.inf
        names = f"{bodies_of(step.model, gaps, row)} of {step.names[gaps.owner[row]]}"
        return MissingImpact(t, names, depth, h * (leaving - entry), speed, energy)
    return None


def _closes(gap: float, rate: float, gap_after: float, rate_after: float) -> bool:
    """Whether the cubic by both ends of a step is negative within it; rates by its length."""
    s = np.linspace(0, 1, 65)
    start = (1 + 2 * s) * (1 - s) ** 2 * gap + s * (1 - s) ** 2 * rate
    end = s**2 * (3 - 2 * s) * gap_after - s**2 * (1 - s) * rate_after
    return bool((start + end).min() < 0)


def unsearched_impacts(
    step: ContactStep, record: ContactRecord, compiled: np.ndarray
) -> list[MissingImpact]:
    """Impacts that steps in machine code missed, of those with the largest rotations.

    Parameters
    ----------
    compiled : numbers of these steps
    """
    units = [unit for group in step.model.coordinates for unit in group.speed_units]
    angular = np.array([unit == "rad" for unit in units])
    if not compiled.size or not angular.any():
        return []
    mean = (record.ends.v[angular, 1:] + record.ends.v[angular, :-1]) / 2
    turns = (np.diff(record.t) * np.abs(mean).max(axis=0))[compiled]
    quick = compiled[turns > TURN][np.argsort(-turns[turns > TURN])][:MOST]
    missing = (_recorded(step, record, int(k)) for k in quick)
    return [impact for impact in missing if impact is not None]


def _recorded(step: ContactStep, record: ContactRecord, k: int) -> MissingImpact | None:
    """The first impact that step ``k`` of a record missed; None without any."""
    t, y, v = float(record.t[k]), record.ends.y[:, k], record.ends.v[:, k]
    h, own = float(record.t[k + 1]) - t, np.flatnonzero(record.step == k)
    own = own[np.argsort(record.key[own])]
    start = step.begin(t, h, y, v, k == 0)
    near = step.near(step.at(t, y), h * np.column_stack([v, start.free]))
    pressing = record.key[own], record.impulse[own]
    ends = RecordedStep(record.ends.y[:, k + 1], record.ends.v[:, k + 1], pressing)
    gaps = returning_gaps(start, near, ends, step.rounding)
    return find_missing_impact(step, t, h, y, v, replace(ends, returning=gaps))


def largest(impacts: list[MissingImpact]) -> list[MissingImpact]:
    """Those with the largest energies, in descending order."""
    return sorted(impacts, key=lambda impact: -impact.energy)[:MOST]


def missing_impact_warnings(impacts: list[MissingImpact], moved: float) -> list[str]:
    """Warning about a run with missing impacts.

    Parameters
    ----------
    impacts : in descending order of their energies
    moved : energy that took part in the motion [J]
    """
    impacts = [impact for impact in impacts if impact.energy > SHARE * moved]
    if not impacts:
        return []
    worst, shortest = impacts[0], min(impact.duration for impact in impacts)
    number = len(impacts)
    more = "" if number == 1 else f", and in {number - 1}{' or more' * (number >= MOST)} others"
    return [
        f"{worst.names} overlap within the step at t = {worst.t:.9g} s{more}, by "
        f"{worst.depth:.3g} m for {worst.duration:.2g} s, and are apart at its ends: their impact "
        f"at {worst.speed:.3g} m/s is missing, with {worst.energy:.3g} J, where {moved:.3g} J took "
        f"part in the motion; use step={shortest / 3:.1g} or shorter"
    ]
