"""Events of a dynamic run, found among its steps and located inside them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property, partial

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics_kernel import DynamicsKernel
from dalembert.analysis.events import Event, locate
from dalembert.analysis.variant import Variant
from dalembert.integrators.steps import Steps
from dalembert.results.recording import EventRecord
from dalembert.symbolic.kernel import Kernel

SHORTEST = 1e-15
"""Length [s] left to a step that ends where it begins."""


class EventSearch:
    """Looks for the crossings of measures, accelerations and multipliers included.

    Parameters
    ----------
    kernel : DynamicsKernel of the run
    events : name → Event
    p : (np,) parameters
    """

    def __init__(self, kernel: DynamicsKernel, events: Mapping[str, Event], p: np.ndarray):
        self.kernel, self.events, self.p = kernel, events, p
        self._functions: dict[tuple[str, Variant], ca.Function] = {}

    @cached_property
    def measures(self) -> dict[str, ca.SX]:
        model = self.kernel.model
        return {n: model.at_ground(e.expression(model).sx) for n, e in self.events.items()}

    def values(
        self, name: str, times: np.ndarray, states: np.ndarray, modes: np.ndarray
    ) -> np.ndarray:
        """Values of an event's measure."""

        def function_of(variant: Variant) -> ca.Function:
            key = (name, variant)
            if key not in self._functions:
                self._functions[key] = variant.measured([self.measures[name]], "event").function
            return self._functions[key]

        return self.kernel.mapped(function_of, modes, times, states, self.p)[0].ravel()

    def terminal_crossing(self, times: np.ndarray, states: np.ndarray) -> bool:
        """Whether a terminal event happens between these states."""
        # any variant will do: all give the same accelerations
        modes = np.full(times.size, len(self.kernel.variants) - 1)
        return any(
            event.terminal and event.crossings(self.values(name, times, states, modes)).size
            for name, event in self.events.items()
        )

    def find(self, steps: Steps) -> tuple[list[EventRecord], tuple[int, float] | None]:
        """All crossings up to the first terminal one; its step and length, if there is one."""
        found: list[tuple[float, str, int, float]] = []
        times = np.append(steps.t[: steps.count], steps.end)
        for name, event in self.events.items() if steps.count else ():
            modes = np.append(steps.mode, steps.mode[-1:])
            for k in event.crossings(self.values(name, times, steps.x, modes)):
                inside = partial(self._inside, name, steps, int(k))
                length = locate(inside, 0.0, float(steps.h[k]))
                found.append((steps.t[k] + length, name, int(k), length))
        found.sort()
        for i, (_, name, k, length) in enumerate(found):
            if self.events[name].terminal:
                return [EventRecord(n, float(t)) for t, n, _, _ in found[: i + 1]], (k, length)
        return [EventRecord(n, float(t)) for t, n, _, _ in found], None

    def _inside(self, name: str, steps: Steps, k: int, length: float) -> float:
        x = steps.x[:, k]
        if length > 0:
            x = self._stepped(steps, k, length).ravel()
        time = np.array([steps.t[k] + length])
        return float(self.values(name, time, x[:, None], steps.mode[k : k + 1])[0])

    def _stepped(self, steps: Steps, k: int, length: float) -> np.ndarray:
        """State after the part of step ``k`` that has this length."""
        step = Kernel(self.kernel.variants[steps.mode[k]].step.function)
        return step(steps.t[k], length, steps.x[:, k], self.p)[0]

    def cut(self, steps: Steps, k: int, length: float) -> Steps:
        """The steps up to the ``k``-th, which is shortened."""
        made = steps.cut(k + 1)
        made.h = made.h.copy()
        made.h[k] = max(length, SHORTEST)
        made.corrected[k] = True
        made.x = np.hstack([made.x[:, :-1], self._stepped(steps, k, made.h[k])])
        return made
