"""The steps a march has taken, and who watches it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dalembert.integrators.marching.checkpoints import Recorder, States, cut_states
from dalembert.integrators.marching.method_choice import MethodChoice


@dataclass
class Steps:
    """Steps taken: ``x[:, k]`` at ``t[k]``, then a step of length ``h[k]``.

    ``corrected[k]`` tells whether the step ended with the correction, ``mode[k]`` which variant of
    the step was taken. The last column of ``x`` is the end of the last step. ``message`` is empty
    when the end was reached; ``explained`` where it says all there is to say. Of long marches ``x``
    holds few states and repeats the others.
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
        """Numbers of the steps that have a length; transitions at switches have none."""
        return np.flatnonzero(self.h)

    @property
    def end(self) -> float:
        return float(self.t[-1] + self.h[-1]) if self.count else float(self.t[0])

    @property
    def instant(self) -> float:
        """Times that differ by less are the same."""
        return 1e-12 * max(abs(float(self.t[0])), abs(self.end))

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
        """The same march, to be repeated with each step in so many equal parts.

        Transitions, which have no length, stay as they are.
        """
        each = np.where(self.h > 0, parts, 1)
        h = np.repeat(self.h / each, each)
        first = np.repeat(np.cumsum(each) - each, each)
        t = np.repeat(self.t[: self.count], each) + h * (np.arange(h.size) - first)
        corrected, mode = (np.repeat(column, each) for column in (self.corrected, self.mode))
        return Steps(t, h, self.x[:, :1], corrected, mode, rejected=self.rejected)


def standstill(time: float, x0: np.ndarray, message: str) -> Steps:
    """No step at all."""
    none = np.zeros(0)
    column = x0.reshape(-1, 1)
    return Steps(np.array([time]), none, column, none > 0, none.astype(int), message=message)


def run_length(mode: np.ndarray, begin: int, longest: int) -> int:
    """How many steps from ``begin`` on are of one mode, ``longest`` at most."""
    part = mode[begin : begin + longest]
    different = np.flatnonzero(part != part[0])
    return int(different[0]) if different.size else part.size


EVEN = 1e-6
"""Difference of lengths, relative, of steps that are taken as equal."""


def even_length(h: np.ndarray) -> int:
    """How many steps from the first on are as long as it."""
    different = np.flatnonzero(np.abs(h - h[0]) > EVEN * h[0])
    return int(different[0]) if different.size else h.size


class Switch(NamedTuple):
    """What to do with the steps of a chunk: how many to keep, and the mode after them.

    With a ``reason`` the march ends there.
    """

    kept: int
    mode: int
    reason: str = ""


class Crossing(NamedTuple):
    """A switch that the last step of a chunk went across, and what is put in place of that step.

    ``kept`` steps stay as they are; the columns ``x`` at the ends of steps from ``t`` of lengths
    ``h`` in these modes follow. The march goes on with steps of length ``following``, in the mode
    ``after`` if there is one; with a ``reason`` it ends there.
    """

    kept: int
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
    """What to do after each chunk of states ``(t, x)``.

    Attributes
    ----------
    progress : told the fraction done
    stop : asked whether to end the march; told the modes of the steps as well
    switch : ``(times, states, mode)`` → Switch
    cross : ``(times, states, mode)`` → Crossing, or None
    choice : which of two methods goes on; None where there is one only
    memory : bytes of states that are kept before they are thinned to checkpoints
    outputs : (K,) times around which states are kept in any case [s]
    """

    progress: Callable[[float], None] = lambda fraction: None
    stop: Callable[[np.ndarray, np.ndarray, np.ndarray], bool] = lambda times, states, modes: False
    switch: Callable[[np.ndarray, np.ndarray, int], Switch] = _never_switch
    cross: Callable[[np.ndarray, np.ndarray, int], Crossing | None] = _never_cross
    choice: MethodChoice | None = None
    memory: float = np.inf
    outputs: np.ndarray | None = None

    def recorder(self, x0: np.ndarray, steps: int = 0) -> Recorder:
        """Takes the states of a march that begins here."""
        return Recorder(x0, self.memory, self.outputs, steps)
