"""Division of steps in which impacts on connected bodies follow each other.

A step has the impulses of all its contacts at once, and instants of impacts have errors of the
order of the step. Where two gaps of connected bodies close within one step, the speeds after it are
those of one impact, which differ from those of the sequence whatever the step; where they close
within a few steps, the second one is that of displaced bodies. Steps are divided until the time
between such impacts is several of them. An impact may act in the step after the one in which its
gap closes, and a correction of positions displaces its bodies between both: the step that closes
the gap is divided, too.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.free_bodies.free_body_loop import FreeBodyLoop
from dalembert.analysis.nonsmooth.step_impacts import (
    LastImpacts,
    PressedContacts,
    connected,
    step_impacts,
)
from dalembert.analysis.nonsmooth.step_log import StepEntries, StepLog
from dalembert.analysis.nonsmooth.step_state import LastImpulses, StepResult
from dalembert.integrators.contact.approach import SLOW

DIVISIONS = 16
"""Upper limit of the divisions of a step in halves; impacts within less are simultaneous."""
RESOLVED = 8.0
"""Least time between impacts on connected bodies, in steps [-]."""
CHUNK = 64
"""Upper limit of the steps that are repeated where one of them has to be divided."""


@dataclass(eq=False)
class ImpactSequence:
    """Steps of a run that are divided where impacts follow each other.

    Parameters
    ----------
    step : ContactStep of the steps that are not divided
    """

    step: ContactStep
    divisions: ClassVar[int] = DIVISIONS
    last: LastImpacts = field(init=False)
    _chunk: int = field(init=False, default=CHUNK)

    def __post_init__(self) -> None:
        self.last = LastImpacts.none(self.step.model.equations.speed_count)

    @property
    def shortest(self) -> float:
        """Length of the shortest parts of steps [s]."""
        return self.step.longest / 2**DIVISIONS

    def march(
        self,
        loop: FreeBodyLoop,
        divided: Callable[[np.ndarray, int, int], np.ndarray | None],
        grid: np.ndarray,
        k: int,
        log: StepLog,
        last: LastImpulses,
        report: Callable[[float], None],
    ) -> tuple[np.ndarray, int, LastImpulses]:
        """Steps in machine code up to one that these cannot do.

        Parameters
        ----------
        divided : returns the grid with a step of this number divided, up to a number of divisions;
            None where it is short enough

        Returns the grid, the number of the instant reached, and the last impulses.
        """
        while k < grid.size - 1:
            stop, sizes, first = min(k + self._chunk, grid.size - 1), log.sizes(), len(log.parts)
            end, impulses = loop.march(grid, k, log, last, report, stop)
            number = self._first(end - k, log, first, last)
            if number is None:
                k, last, self._chunk = end, impulses, min(2 * self._chunk, CHUNK)
                if end < stop:
                    break
                continue
            log.cut(sizes)
            parts = divided(grid, k + number, self.divisions)
            stop = k + number + (parts is None)
            if stop > k:
                k, last = loop.march(grid, k, log, last, report, stop)
            if k < stop:
                break
            grid, self._chunk = grid if parts is None else parts, 1
        return grid, k, last

    def _first(self, count: int, log: StepLog, first: int, last: LastImpulses) -> int | None:
        """Number of the first one of the last ``count`` steps that is divided; None without any."""
        if not count:
            return None
        entries = StepEntries.joined(log.parts[first:], 0, log.parts[first].impulse.shape[1])
        bounds, keys = np.cumsum([0, *entries.count]), last.pressing[0]
        for number in range(count):
            own, place = slice(*bounds[number : number + 2]), len(log.lengths) - count + number
            pressed = PressedContacts.of(entries.key[own], entries.impulse[own], keys)
            states = [
                (log.positions[place], log.speeds[place]),
                (log.uncorrected[place], log.speeds[place + 1]),
            ]
            before = log.uncorrected[place - 1] if place else log.positions[0]
            span = log.times[place], log.lengths[place]
            if self._acts_late(*span, *states[1], log.positions[place + 1]):
                return number
            if pressed.begins.any() and self._divides(*span, states, before, pressed):
                return number
            keys = entries.key[own]
        return None

    def divides(
        self,
        t: float,
        h: float,
        log: StepLog,
        result: StepResult,
        last: LastImpulses | None,
        corrected: np.ndarray,
    ) -> bool:
        """Whether a step after the recorded ones is divided.

        Parameters
        ----------
        last : impulses of the step before; None in the first step
        corrected : position at the end of the step with open gaps
        """
        if self._acts_late(t, h, result.y, result.v, corrected):
            return True
        before = log.uncorrected[-1] if log.uncorrected else log.y
        keys = result.contacts.key[:0] if last is None else last.pressing[0]
        pressed = PressedContacts.of(*result.pressing, keys)
        return self._divides(t, h, [(log.y, log.v), (result.y, result.v)], before, pressed)

    def _divides(
        self,
        t: float,
        h: float,
        states: list[tuple[np.ndarray, np.ndarray]],
        before: np.ndarray,
        pressed: PressedContacts,
    ) -> bool:
        """Whether a step between two states is divided; the impacts of others are stored."""
        start, (y, v) = self.step.begin(t, h, *states[0], False), states[1]
        groups = step_impacts(self.step, start, pressed, before, v, self.shortest)
        for group in groups:
            near = self.shortest < self.last.since(group, h)[0] < RESOLVED * h
            if group.drives or near or group.spread > self.shortest:
                return True
        rebounding = [group for group in groups if group.rebounds]
        speeds = [group.speeds for group in rebounding]
        if rebounding and self._next(t + h, h, y, v, np.concatenate(speeds)) < RESOLVED * h:
            return True
        for group in groups:
            self.last.add(group, h)
        return False

    def _acts_late(
        self, t: float, h: float, y: np.ndarray, v: np.ndarray, corrected: np.ndarray
    ) -> bool:
        """Whether an impact that acts in the next step would have to act in this one.

        A gap that closes in the second half of a step remains closed, and its correction displaces
        the bodies: it may close gaps that the impact would have to close, which then have both
        impacts at once, or other impacts follow from displaced bodies.

        Parameters
        ----------
        y, v : state at the end of the step before the correction
        """
        if np.array_equal(y, corrected):
            return False
        step, t = self.step, t + h
        gaps = step.rigid(step.near(step.at(t, corrected), 2 * h * v[:, None]))
        gaps = gaps.some(gaps.distance <= step.rounded_overlap)
        distance = step.selected(step.at(t, y), gaps.key).distance
        start = step.begin(t, step.longest, corrected, v, False)
        u, slow = gaps.at_start(v)[:, 0], SLOW * start.approach(gaps, step.rounding).nearby
        strikes, rebounds = (distance < -step.rounding) & (-u > slow), gaps.laws.restitution > 0
        if not strikes.any():
            return False
        labels, moved = connected(step, start, gaps)
        closed = distance > self._least(-float(u[strikes].min()))
        if np.isin(labels[closed & rebounds], labels[strikes]).any():
            return True
        rebounding = np.isin(labels, labels[strikes & rebounds])
        if not rebounding.any():
            return False
        rows = np.flatnonzero(strikes & rebounding)
        instants, first = distance[rows] / -u[rows], np.full(labels.max() + 1, np.inf)
        np.minimum.at(first, labels[rows], instants)
        if (instants - first[labels[rows]]).max() > self.shortest:
            return True
        start = step.begin(t, h, corrected, v, False)
        after = step.solved(step.struck(start, gaps), gaps, None).v
        return self._next(t, h, corrected, after, moved[rebounding].indices) < RESOLVED * h

    def _least(self, speed: float) -> float:
        """Gap that an impact with a speed closes at once [m]."""
        return max(self.step.rounded_overlap, 2 * self.shortest * speed)

    def _next(self, t: float, h: float, y: np.ndarray, v: np.ndarray, changed: np.ndarray) -> float:
        """Time until bodies with ``changed`` speeds have the next impact of another gap [s]; zero
        if this gap closes in the step before."""
        step = self.step
        gaps = step.rigid(step.near(step.at(t, y), 2 * RESOLVED * h * v[:, None]))
        u = gaps.at_start(v)[:, 0]
        gaps = gaps.some((u < 0) & (-u * RESOLVED * h > gaps.distance))
        if not gaps.count:
            return np.inf
        start = step.begin(t, step.longest, y, v, False)
        slow = SLOW * start.approach(gaps, step.rounding).nearby
        u, (_, moved) = gaps.at_start(v)[:, 0], connected(step, start, gaps)
        speeds = np.zeros(v.size)
        speeds[changed] = 1.0
        times = -gaps.distance / u
        times = times[(-u > slow) & (moved @ speeds > 0) & (np.abs(times) > self.shortest)]
        return max(float(times.min(initial=np.inf)), 0.0)
