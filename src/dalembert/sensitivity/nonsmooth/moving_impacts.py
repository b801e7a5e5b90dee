"""Derivatives of impact times, which steps at fixed times do not include.

With ``x⁺ = S(x⁻)`` over the step and rates ``ẋ⁻`` before and ``ẋ⁺`` after it, an impact whose
instant moves by ``dt* = −dg/ġ⁻`` adds

    dx⁺ = S' dx⁻ + (S' ẋ⁻ + ∂S/∂t − ẋ⁺) dt*

(jump of the sensitivities: Hiskens and Pai 2000). So the gradient is that of the motion to the
order of the step, whereas the derivative of steps at fixed times lacks a term of its own size.
Gaps on the same bodies that close at one instant make one impact, which moves by the mean of their
shifts: exact for all changes that keep them simultaneous. Impacts of different gaps on connected
bodies within the length of a step have no gradient: their order is uncertain.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dalembert.analysis.nonsmooth.active_contacts import ActiveContacts
from dalembert.integrators.contact.approach import SLOW, SLOWEST, largest_nearby
from dalembert.sensitivity.nonsmooth.break_away import BreakAways, break_aways
from dalembert.sensitivity.nonsmooth.contact_changes import MARGIN, ContactChanges, near_change
from dalembert.sensitivity.nonsmooth.contact_equations import ContactEquations
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps
from dalembert.sensitivity.nonsmooth.impact_groups import closed_after, moving_parts
from dalembert.sensitivity.nonsmooth.instant_shifts import InstantShifts
from dalembert.sensitivity.nonsmooth.linear_map import MapAt
from dalembert.sensitivity.nonsmooth.near_impacts import UNRESOLVED, unresolved


@dataclass(frozen=True, eq=False)
class Closing:
    """Newly pressing gaps of a step that may close by an impact.

    Attributes
    ----------
    rows : (n,) numbers among the pressing contacts
    speed, forced : (n,) speeds at the contact, and changes of speeds by forces in a step by which
        impacts are distinguished from rest
    """

    rows: np.ndarray
    speed: np.ndarray
    forced: np.ndarray

    @property
    def impacting(self) -> np.ndarray:
        """Rows of the gaps that close by an impact."""
        return self.rows[self.speed > SLOW * self.forced]


@dataclass(frozen=True, eq=False)
class MovingImpacts:
    """Contribution of moving impacts to the changes of a step.

    Attributes
    ----------
    contacts : pressing contacts of the step
    groups : rows of the contacts of each impact
    jumps : (n, impacts) derivatives of the state at the end of the step by the instants
    """

    contacts: ContactEquations
    groups: list[np.ndarray]
    jumps: np.ndarray

    def push(self, dq: np.ndarray) -> np.ndarray:
        """Change of the state at the end."""
        shifts = -self.contacts.gaps.push(dq)[0].distance / self._speeds
        instants = [shifts[rows].mean(axis=0) for rows in self.groups]
        return self.jumps @ np.array(instants).reshape(len(instants), dq.shape[1])

    def pull(self, weights: np.ndarray) -> np.ndarray:
        """Weights of ``q``."""
        gaps = self.contacts.gaps
        own = gaps.values.like(weights.shape[1])
        for rows, instant in zip(self.groups, self.jumps.T @ weights, strict=True):
            own.distance[rows] -= instant / rows.size
        own.distance[:] /= self._speeds
        return gaps.pull(own, np.zeros((gaps.directions.shape[1], weights.shape[1])))

    @property
    def _speeds(self) -> np.ndarray:
        speeds = self.contacts.gaps.values.before[:, :1]
        return np.where(speeds != 0, speeds, 1.0)


@dataclass(frozen=True, eq=False)
class StepTangent:
    """Linearised step of a nonsmooth run.

    Attributes
    ----------
    maps : sequence of maps of the step
    shifts : contributions of moving impacts, and of contacts that break away
    """

    maps: list[MapAt]
    shifts: list[MovingImpacts | BreakAways | InstantShifts]

    def push(self, dx: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """Change of the state at the end."""
        change = push_maps(self.maps, dx, 0.0, dp)
        dq = np.vstack([dx, np.zeros((1, dx.shape[1])), dp])
        for shift in self.shifts:
            change = change + shift.push(dq)
        return change

    def pull(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the state at the start, and of the parameters."""
        shifted = [shift.pull(weights) for shift in self.shifts]
        total: Any = 0.0
        for one_map in reversed(self.maps):
            weights, p_bar = one_map.pull(weights)
            total = total + p_bar
        n = weights.shape[0]
        for q_bar in shifted:
            weights, total = weights + q_bar[:n], total + q_bar[n + 1 :]
        return weights, total


def push_maps(maps: list[MapAt], dx: np.ndarray, dt: float, dp: np.ndarray) -> np.ndarray:
    """Change of the state after a sequence of maps."""
    for one_map in maps:
        dx = one_map.push(dx, dt, dp)
    return dx


def step_tangent(steps: ContactSteps, k: int) -> StepTangent:
    """Linearisation of step ``k`` of a run.

    Raises
    ------
    SingularityError
        Impacts on the same bodies come one after the other within the length of a step.
    UnsupportedError
        The load of a contact with static friction does not grow evenly until it breaks away.
    """
    if steps.times_between[k] < UNRESOLVED:
        raise unresolved(steps.span(k)[0], steps.step.rest > 0)
    if (impacts := steps.stacked_impacts(k)) is not None:
        stacked, place = impacts
        maps, shifts = steps.at(k, whole=True), stacked.at(place)
        steps.changes[k] = replace(stacked.changes(place), redundant=not maps[0].consistent)
        return StepTangent(maps, [] if shifts is None else [shifts])
    return single_tangent(steps, k)


def single_tangent(steps: ContactSteps, k: int) -> StepTangent:
    """Linearisation of one step, with impacts that are its own."""
    maps = steps.at(k)
    closing, before = _closing(steps, k, maps[0].contacts)
    impacts = _impacts(steps, k, maps, closing, before) if closing.impacting.size else None
    breaks = break_aways(steps, k, maps[0])
    changes = contact_changes(steps, k, maps[0], closing, impacts)
    steps.changes[k] = replace(changes, breaks=breaks.count if breaks else 0)
    moved = impacts if impacts and impacts.groups else None
    return StepTangent(maps, [shift for shift in (moved, breaks) if shift is not None])


def contact_changes(
    steps: ContactSteps,
    k: int,
    step_map: MapAt,
    closing: Closing,
    impacts: MovingImpacts | None,
) -> ContactChanges:
    """Changes of contact states in a step and near it."""
    contacts = step_map.contacts
    if contacts is None:
        return ContactChanges()
    moving = [rows.size for rows in impacts.groups] if impacts else []
    margin = np.abs(closing.speed - SLOW * closing.forced)
    impulses, v = steps.active(k).impulses, steps.x[steps.size :, k : k + 2]
    change = float(np.abs(v[:, 1] - v[:, 0]).max())
    return ContactChanges(
        sum(moving),
        max(moving, default=0) > 1,
        closing.impacting.size - sum(moving),
        bool((margin <= MARGIN * closing.speed).any()),
        bool(near_change(contacts, impulses, steps.step.groups, change).any()),
        not step_map.consistent,
        contacts.impact is not None and contacts.impact.inelastic,
    )


def _persistent(steps: ContactSteps, k: int) -> ActiveContacts:
    """Contacts that press before step ``k``: in the step before, and in step ``k`` or in the one
    before both, so that those that an impact opens count."""
    last = steps.active(k - 1)
    lasting = np.isin(last.keys, steps.active(k).keys)
    if k > 1:
        lasting |= np.isin(last.keys, steps.active(k - 2).keys)
    return last.some(lasting)


def _closing(
    steps: ContactSteps, k: int, contacts: ContactEquations | None
) -> tuple[Closing, np.ndarray]:
    """Gaps that close in step ``k``, and accelerations before."""
    none = np.zeros(0)
    if contacts is None:
        return Closing(np.zeros(0, dtype=int), none, none), none
    keys, values = steps.active(k).keys, contacts.gaps.values
    (t, h), width = steps.span(k), values.before.shape[1]
    begins = contacts.slopes.bounces & ~np.isin(keys, steps.active(k - 1).keys)
    closes = -values.before[:, 0] > SLOWEST * values.distance / h
    rows = np.flatnonzero(begins & closes)
    if not rows.size:
        return Closing(rows, none, none), none
    state = steps.x[:, k], t, h
    before, alone = steps.accelerations(*state, _persistent(steps, k))
    v, directions = steps.x[steps.size :, k : k + 2], contacts.gaps.directions
    normals, turning = directions[::width], contacts.gaps.turning(v[:, 1] - v[:, 0])[:, 0]
    own, nearby = (np.abs(h * (normals @ a) + turning) for a in (before, alone))
    forced = np.maximum(own, nearby)[rows]
    fall = 2 * forced / h * np.maximum(values.distance[rows], 0.0)
    forced = np.maximum(forced, largest_nearby(directions, nearby)[rows])
    forced = max(1.0, steps.step.rest / h) * forced
    return Closing(rows, np.sqrt(values.before[rows, 0] ** 2 + fall), forced), before


def _impacts(
    steps: ContactSteps, k: int, maps: list[MapAt], closing: Closing, before: np.ndarray
) -> MovingImpacts:
    (t, h), active, size = steps.span(k), steps.active(k), steps.size
    begin, end, contacts = steps.x[:, k], steps.x[:, k + 1], maps[0].contacts
    assert contacts is not None
    parts = moving_parts(steps, k, contacts, closing.impacting)
    if not parts:
        return MovingImpacts(contacts, [], np.zeros((begin.size, 0)))
    closed = closed_after(steps, k, contacts)
    after = steps.acceleration(end, t + h, h, active.some(closed))
    rates = steps.maps.equations.rates
    here, there = (t, begin[:size], begin[size:]), (t + h, end[:size], end[size:])
    rate_before, rate_after = (
        np.concatenate([rates(*state, steps.p)[0], change])
        for state, change in ((here, before), (there, after))
    )
    impact = [maps[0].impact_law(contacts.keys[closing.impacting]), *maps[1:]]
    jump = push_maps(impact, rate_before[:, None], 1.0, np.zeros((steps.p.size, 1))).ravel()
    masks = np.array([part for _, part in parts]).T
    return MovingImpacts(
        contacts, [rows for rows, _ in parts], masks * (jump - rate_after)[:, None]
    )
