"""Scheduled and recorded steps of a march, and the callbacks after each chunk of steps."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dalembert.integrators.marching.checkpoints import Recorder, States, cut_states
from dalembert.integrators.marching.method_choice import MethodChoice

HALVINGS = 6
"""Maximum number of times a step is halved before the march stops."""
CLOSE = 1e-9
"""Shortest remainder of a step after an event, relative to the longest step [-]."""


def halving_warnings(count: int) -> list[str]:
    """Warnings of a run that has halved ``count`` steps."""
    steps = f"{count} step{'s' if count > 1 else ''}"
    text = f"Newton's method failed in {steps}, taken in halves instead; use a shorter step"
    return [text] if count else []


@dataclass(frozen=True)
class Samples:
    """Transitions of zero length at fixed times of a march.

    Attributes
    ----------
    times : (K,) increasing, from the start of the march to before its end [s]
    due : (K,) numbers of the samples
    mode : (mode of the steps before and after, number) → mode of the transition
    """

    times: np.ndarray
    due: np.ndarray
    mode: Callable[[int, int], int]


class Schedule:
    """Scheduled steps of length ``h`` from ``t``, in order.

    Parameters
    ----------
    t, h : [s]
    corrected, mode : of each step
    """

    def __init__(self, t: np.ndarray, h: np.ndarray, corrected: np.ndarray, mode: np.ndarray):
        self.t, self.h, self.corrected, self.mode = t.copy(), h.copy(), corrected, mode.copy()
        self.shortest, self.longest = shortest(h), float(np.max(h, initial=0.0))
        self.halved = 0

    @classmethod
    def on_grid(cls, times: np.ndarray, period: int, mode: int, samples: Samples | None = None):
        """Steps between the times of a grid, every ``period``-th corrected, and samples.

        Times of samples are added to the grid unless they are part of it. Modes of samples follow
        from those of the steps before; until then they are ``−1 − due``.
        """
        if samples is not None and samples.times.size:
            near = np.searchsorted(times, samples.times - CLOSE * np.max(np.diff(times)))
            gap = times[near] - samples.times
            added = samples.times[gap > CLOSE * np.max(np.diff(times))]
            times = np.insert(times, np.searchsorted(times, added), added)
        h = np.diff(times)
        number = np.arange(1, h.size + 1)
        corrected = (number % period == 0) | (number == h.size)
        t, modes = times[: max(h.size, 1)], np.full(h.size, mode)
        if samples is not None and samples.times.size:
            before = np.searchsorted(times, samples.times - CLOSE * np.max(h))
            t, h = np.insert(t, before, times[before]), np.insert(h, before, 0.0)
            corrected = np.insert(corrected, before, True)
            modes = np.insert(modes, before, -1 - samples.due)
        return cls(t, h, corrected, modes)

    def part(self, begin: int, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """``t``, ``h``, ``corrected`` of ``count`` steps from ``begin``."""
        part = slice(begin, begin + count)
        return self.t[part], self.h[part], self.corrected[part]

    def halve(self, k: int) -> bool:
        """Replace step k by two halves; False if it is too short to be halved again.

        The second half ends with the correction of the original step. The first half does so
        only if all steps are corrected.
        """
        half = self.h[k] / 2
        if half < self.shortest[k]:
            return False
        self.t = np.insert(self.t, k + 1, self.t[k] + half)
        self.h = np.insert(self.h, k, half)
        self.h[k + 1] = half
        self.corrected = np.insert(self.corrected, k, bool(self.corrected.all()))
        self.mode = np.insert(self.mode, k, self.mode[k])
        self.shortest = np.insert(self.shortest, k, self.shortest[k])
        self.halved += 1
        return True

    def resume(self, k: int, time: float) -> int:
        """Continue from a time inside step ``k``; the number of the next step.

        It ends with step ``k``, or with the step after that if hardly anything remains.
        """
        remainder = self._end(k) - time
        following = self.mode[k + 1] if k + 1 < self.h.size else -1
        if remainder <= 0 or (remainder < CLOSE * self.longest and following >= 0):
            k += 1
        if k < self.h.size and self.mode[k] >= 0:
            self.t[k], self.h[k] = time, self._end(k) - time
        return k

    def _end(self, k: int) -> float:
        """Time at the end of a step."""
        return float(self.t[k + 1] if k + 1 < self.h.size else self.t[k] + self.h[k])


def shortest(h: np.ndarray) -> np.ndarray:
    """Minimum lengths of the parts of halved steps."""
    return h / (1.5 * 2**HALVINGS)


@dataclass
class Steps:
    """Steps taken: ``x[:, k]`` at ``t[k]``, then a step of length ``h[k]``.

    ``corrected[k]`` is True if the step ended with the correction, ``mode[k]`` is the variant of
    the step. The last column of ``x`` is the end of the last step. ``message`` is empty when the
    end was reached; ``explained`` is True if it is a complete explanation. In long marches ``x``
    stores checkpoints and recomputes the other states.
    """

    t: np.ndarray
    h: np.ndarray
    x: States
    corrected: np.ndarray
    mode: np.ndarray
    rejected: int = 0
    message: str = ""
    interrupted: bool = False
    explained: bool = False

    @property
    def count(self) -> int:
        return self.h.size

    @property
    def lasting(self) -> np.ndarray:
        """Indices of the steps of nonzero length; transitions at switches have length zero."""
        return np.flatnonzero(self.h)

    @property
    def end(self) -> float:
        return float(self.t[-1] + self.h[-1]) if self.count else float(self.t[0])

    @property
    def instant(self) -> float:
        """Smallest difference of distinct times [s]."""
        return 1e-12 * max(abs(float(self.t[0])), abs(self.end))

    def schedule(self, begin: int = 0, end: int | None = None) -> Schedule:
        """These steps, or some of them, to be repeated."""
        part = slice(begin, end)
        return Schedule(self.t[part], self.h[part], self.corrected[part], self.mode[part])

    def cut(self, count: int, message: str = "") -> Steps:
        """The first ``count`` steps."""
        t = self.t[: max(count, 1)] if count else self.t[:1]
        return Steps(
            t,
            self.h[:count],
            cut_states(self.x, count),
            self.corrected[:count],
            self.mode[:count],
            self.rejected,
            message or self.message,
            self.interrupted,
        )

    def divided(self, parts: int | np.ndarray) -> Steps:
        """The march with each step divided into ``parts`` equal parts, to be repeated.

        Transitions, which have zero length, are not divided.
        """
        counts = np.where(self.h > 0, parts, 1)
        h = np.repeat(self.h / counts, counts)
        first = np.repeat(np.cumsum(counts) - counts, counts)
        t = np.repeat(self.t[: self.count], counts) + h * (np.arange(h.size) - first)
        corrected, mode = (np.repeat(column, counts) for column in (self.corrected, self.mode))
        return Steps(t, h, self.x[:, :1], corrected, mode, rejected=self.rejected)


def standstill(time: float, x0: np.ndarray, message: str) -> Steps:
    """A march without steps."""
    empty = np.zeros(0)
    column = x0.reshape(-1, 1)
    return Steps(np.array([time]), empty, column, empty > 0, empty.astype(int), message=message)


def run_length(mode: np.ndarray, begin: int, longest: int) -> int:
    """Number of steps from ``begin`` with the same mode, at most ``longest``."""
    part = mode[begin : begin + longest]
    different = np.flatnonzero(part != part[0])
    return int(different[0]) if different.size else part.size


EVEN = 1e-6
"""Relative difference below which step lengths count as equal [-]."""


def even_length(h: np.ndarray) -> int:
    """Number of leading steps of equal length."""
    different = np.flatnonzero(np.abs(h - h[0]) > EVEN * h[0])
    return int(different[0]) if different.size else h.size


class Switch(NamedTuple):
    """Number of accepted steps of a chunk, and the mode after them.

    With a ``reason`` the march ends there.
    """

    accepted: int
    mode: int
    reason: str = ""


class Crossing(NamedTuple):
    """Crossing of a switch by the last step of a chunk, and the steps that replace that step.

    ``accepted`` steps are unchanged; then come steps from ``t`` of lengths ``h`` in these modes,
    with states ``x`` at their ends. The march continues with steps of length ``following``, in the
    mode ``after`` if there is one; with a ``reason`` it ends there.
    """

    accepted: int
    t: np.ndarray
    h: np.ndarray
    x: np.ndarray
    mode: np.ndarray
    following: float
    reason: str = ""
    after: int | None = None


def _never_cross(times: np.ndarray, states: np.ndarray, mode: int) -> Crossing | None:
    return None


def _never_switch(times: np.ndarray, states: np.ndarray, mode: int) -> Switch:
    return Switch(times.size - 1, mode)


@dataclass
class Watch:
    """Callbacks after each chunk of states ``(t, x)``, and storage of the states.

    Attributes
    ----------
    progress : called with the completed fraction
    stop : ``(times, states, modes)`` → whether to end the march
    switch : ``(times, states, mode)`` → Switch
    cross : ``(times, states, mode)`` → Crossing, or None
    choice : choice between two methods; None for a single method
    memory : upper limit of stored states before they are thinned to checkpoints [bytes]
    outputs : (K,) times around which states are stored in any case [s]
    """

    progress: Callable[[float], None] = lambda fraction: None
    stop: Callable[[np.ndarray, np.ndarray, np.ndarray], bool] = lambda times, states, modes: False
    switch: Callable[[np.ndarray, np.ndarray, int], Switch] = _never_switch
    cross: Callable[[np.ndarray, np.ndarray, int], Crossing | None] = _never_cross
    choice: MethodChoice | None = None
    memory: float = np.inf
    outputs: np.ndarray | None = None

    def recorder(self, x0: np.ndarray, steps: int = 0) -> Recorder:
        """Recorder of the states of a march from ``x0``."""
        return Recorder(x0, self.memory, self.outputs, steps)
