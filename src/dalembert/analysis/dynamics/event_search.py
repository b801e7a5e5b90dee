"""Events of a dynamic run, found among its steps and located inside them."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from dalembert.analysis.dynamics.flow import Flow
from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.analysis.events import Event, locate
from dalembert.integrators.marching.checkpoints import States
from dalembert.integrators.marching.steps import Steps
from dalembert.results.recording import EventRecord
from dalembert.symbolic.formulas.expression import Expression

SHORTEST = 1e-12
"""Share left of a step that ends where it begins."""


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

    @cached_property
    def measures(self) -> dict[str, Expression]:
        model = self.kernel.model
        return {name: model.expression(event.measure) for name, event in self.events.items()}

    def values(self, name: str, times: np.ndarray, states: States, modes: np.ndarray) -> np.ndarray:
        """Values of an event's measure."""
        measure = self.measures[name]
        found = self.kernel.mapped(
            lambda variant: variant.measured(measure).function,
            modes,
            times,
            states,
            self.p,
        )
        return found[0].ravel()

    def terminal_crossing(self, times: np.ndarray, states: np.ndarray, modes: np.ndarray) -> bool:
        """Whether a terminal event happens between these states, by the modes of the steps."""
        modes = np.append(modes, modes[-1:])
        return any(
            event.terminal and event.crossings(self.values(name, times, states, modes)).size
            for name, event in self.events.items()
        )

    def crossings(self, name: str, steps: Steps) -> np.ndarray:
        """Steps in which an event happens."""
        if not steps.count:
            return np.zeros(0, dtype=int)
        times = np.append(steps.t[: steps.count], steps.end)
        modes = np.append(steps.mode, steps.mode[-1:])
        return self.events[name].crossings(self.values(name, times, steps.x, modes))

    def locate(self, name: str, steps: Steps, k: int) -> float:
        """Time from the beginning of step ``k`` to the crossing inside it [s]."""
        flow, measure = Flow(self.kernel, steps, self.p), self.measures[name]
        return locate(lambda length: flow.value(measure, k, length), 0.0, float(steps.h[k]))

    def find(self, steps: Steps) -> tuple[list[EventRecord], tuple[int, float] | None]:
        """All crossings up to the first terminal one; its step and length, if there is one."""
        found: list[tuple[float, str, int, float]] = []
        for name in self.events:
            for k in self.crossings(name, steps):
                length = self.locate(name, steps, int(k))
                found.append((steps.t[k] + length, name, int(k), length))
        found.sort()
        for i, (_, name, k, length) in enumerate(found):
            if self.events[name].terminal:
                return [self._record(*event[1:], steps) for event in found[: i + 1]], (k, length)
        return [self._record(*event[1:], steps) for event in found], None

    def _record(self, name: str, k: int, length: float, steps: Steps) -> EventRecord:
        flow, time = Flow(self.kernel, steps, self.p), float(steps.t[k] + length)
        y, v = flow.bodies(k, length)
        return EventRecord(name, time, -int(np.sign(flow.value(self.measures[name], k, 0.0))), y, v)

    def cut(self, steps: Steps, k: int, length: float) -> Steps:
        """The steps up to the ``k``-th, which is shortened."""
        return Flow(self.kernel, steps, self.p).ended(k, max(length, SHORTEST * float(steps.h[k])))
