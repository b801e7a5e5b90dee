"""Integrating the equations of motion: start, march, events, outputs, status."""

from __future__ import annotations

import time as clock
from functools import cached_property, partial
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.choices import doubts
from dalembert.analysis.dynamics_kernel import (
    Branches,
    DynamicsRecord,
    Variant,
    place_outputs,
)
from dalembert.analysis.dynamics_status import Ending, statistics
from dalembert.analysis.events import as_events, locate
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.timeline import (
    check_driver_laws,
    checked_span,
    checked_step,
    output_times,
    uniform_grid,
)
from dalembert.errors import AssemblyError, SingularityError
from dalembert.formulations.kkt import Kkt
from dalembert.integrators.steps import Steps, Switch, Watch
from dalembert.model.model import Model
from dalembert.results.motion import Motion
from dalembert.results.recording import EventRecord, Trajectory
from dalembert.results.status import Status

SHORTEST = 1e-12
"""Step length, relative to the time, at which an adaptive run is asked why it ended."""


class DynamicsRun:
    """One execution of a dynamic analysis.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Dynamics``
    model : Model
    parameters : new values, or the whole vector
    """

    def __init__(self, analysis: Any, model: Model, parameters):
        self.analysis, self.model = analysis, model
        self.start, self.end = checked_span(analysis.duration, analysis.t_span)
        self.step = checked_step(analysis.step, self.start, self.end)
        self.requested = output_times(analysis.outputs, self.start, self.end)
        self.p = parameters if isinstance(parameters, np.ndarray) else model.values(parameters)
        self.events = as_events(analysis.events)
        if model.diagnosis.massless:
            raise SingularityError(
                f"{', '.join(model.diagnosis.massless)}: can move without any mass moving; "
                "give mass and inertia to the bodies that move there, or constrain them"
            )
        check_driver_laws(model, np.linspace(self.start, self.end, 1001), self.p)
        self._refuse_lost_mass()
        self.kernel = analysis.kernel(model)

    def _refuse_lost_mass(self) -> None:
        """A mass that was not zero when the model was built must not become zero."""
        mass = np.diag(self.model.mass_matrix(self.p))
        lost = set(np.flatnonzero(mass == 0)) - set(self.model.equations.massless)
        if lost and not isinstance(self.analysis.formulation, Kkt):
            names = ", ".join(self.model.guesses.names[k] for k in sorted(lost))
            raise SingularityError(
                f"the inertia of {names} is zero with these parameters but was not when the model "
                "was built; build it with this value, or use formulation=Kkt()"
            )

    def initial_state(self) -> tuple[np.ndarray, int]:
        state = self.model.assemble(self.p, self.start)
        if self.analysis.strict and state.projected_speeds:
            raise AssemblyError(
                "initial speeds are inconsistent with the joints: "
                + ", ".join(
                    f"{n} changed by {c:.3g}" for n, c in state.velocity_corrections.items()
                )
            )
        return self.kernel.initial(state, self.start, self.p)

    def doubts(self, motion: Motion) -> list[str]:
        """Warnings about the choices made; an exchange of energy below round-off counts as none."""
        a = self.analysis
        exchanged = float(np.max(np.abs(motion.trajectory.work), initial=0.0))
        if exchanged <= 1e-9 * np.max(motion.values("kinetic_energy"), initial=0.0):
            exchanged = 0.0
        freedom = self.model.diagnosis.free
        return doubts(a.formulation, a.stabilization, a.integrator, self.step, freedom, exchanged)

    def execute(self, progress) -> Motion:
        begin = clock.perf_counter()
        x0, mode = self.initial_state()
        self.prepare(mode)
        prepared, begin = clock.perf_counter() - begin, clock.perf_counter()
        with progress_reporter(progress, f"integrating {self.model.name}") as report:
            steps = self.march(x0, mode, Watch(report, self.terminal_crossing, self.switch))
        elapsed = clock.perf_counter() - begin
        happened, ends = self.find_events(steps)
        if ends is not None:
            steps = self.cut_at(steps, ends)
        times, branches = self.outputs(steps)
        trajectory = self.kernel.trajectory(times, steps, branches, self.p)
        motion = Motion(
            model=self.model,
            analysis=self.analysis,
            parameters=self.p,
            trajectory=trajectory,
            status=self.status(steps, trajectory, happened if ends is not None else []),
            statistics=statistics(self.kernel, steps, trajectory, self.p, (prepared, elapsed)),
            events=happened,
            record=DynamicsRecord(self.kernel, steps, branches),
        )
        motion.warnings = self.doubts(motion)
        return motion

    def prepare(self, mode: int) -> None:
        """Compile the march, so that its time is its own."""
        if self.kernel.adaptive is not None:
            self.kernel.adaptive.prepare(mode)
        else:
            count = uniform_grid(self.start, self.end, self.step).size - 1
            self.kernel.fixed.prepare(count, mode)

    # marching ----------------------------------------------------------------------
    def march(self, x0: np.ndarray, mode: int, watch: Watch) -> Steps:
        kernel = self.kernel
        if kernel.adaptive is None:
            grid = uniform_grid(self.start, self.end, self.step)
            return kernel.fixed.run(grid, x0, self.p, mode, watch)
        longest = kernel.integrator.longest_step or (self.end - self.start) / 4
        first = min(self.step, longest) if self.analysis.step else 1e-4 * (self.end - self.start)
        return kernel.adaptive.run(self.start, self.end, x0, self.p, first, longest, mode, watch)

    def switch(self, times: np.ndarray, states: np.ndarray, mode: int) -> Switch:
        return self.kernel.switch(times, states, mode, self.p)

    # events ------------------------------------------------------------------------
    def terminal_crossing(self, times: np.ndarray, states: np.ndarray) -> bool:
        # any variant will do: all give the same accelerations
        modes = np.full(times.size, len(self.kernel.variants) - 1)
        return any(
            event.terminal and event.crossings(self.event_values(name, times, states, modes)).size
            for name, event in self.events.items()
        )

    def event_values(
        self, name: str, times: np.ndarray, states: np.ndarray, modes: np.ndarray
    ) -> np.ndarray:
        """Values of an event's measure, accelerations and multipliers included."""
        functions = self.event_functions[name]

        def function_of(variant: Variant) -> ca.Function:
            if variant not in functions:
                functions[variant] = variant.measured([self.measures[name]], "event").function
            return functions[variant]

        return self.kernel.mapped(function_of, modes, times, states, self.p)[0].ravel()

    @cached_property
    def measures(self) -> dict[str, ca.SX]:
        return {
            name: self.model.at_ground(event.expression(self.model).sx)
            for name, event in self.events.items()
        }

    @cached_property
    def event_functions(self) -> dict[str, dict[Variant, ca.Function]]:
        return {name: {} for name in self.events}

    def find_events(self, steps: Steps) -> tuple[list[EventRecord], tuple[int, float] | None]:
        """All crossings up to the first terminal one; its step and length, if there is one."""
        found: list[tuple[float, str, int, float]] = []
        times = np.append(steps.t[: steps.count], steps.end)
        for name, event in self.events.items() if steps.count else ():
            modes = np.append(steps.mode, steps.mode[-1:])
            values = self.event_values(name, times, steps.x, modes)
            for k in event.crossings(values):
                inside = partial(self.value_inside, name, steps, int(k))
                length = locate(inside, 0.0, float(steps.h[k]))
                found.append((steps.t[k] + length, name, int(k), length))
        found.sort()
        for i, (_, name, k, length) in enumerate(found):
            if self.events[name].terminal:
                return [EventRecord(n, float(t)) for t, n, _, _ in found[: i + 1]], (k, length)
        return [EventRecord(n, float(t)) for t, n, _, _ in found], None

    def value_inside(self, name: str, steps: Steps, k: int, length: float) -> float:
        x, step = steps.x[:, k], self.kernel.variants[steps.mode[k]].step
        if length > 0:
            x = step.function(steps.t[k], length, x, self.p).full().ravel()
        time = np.array([steps.t[k] + length])
        return float(self.event_values(name, time, x[:, None], steps.mode[k : k + 1])[0])

    def cut_at(self, steps: Steps, end: tuple[int, float]) -> Steps:
        """Shorten the step in which the terminal event happens."""
        k, length = end
        cut = steps.cut(k + 1)
        cut.h = cut.h.copy()
        cut.h[k] = max(length, 1e-15)
        cut.corrected[k] = True
        step = self.kernel.variants[steps.mode[k]].step
        last = step.function(steps.t[k], cut.h[k], steps.x[:, k], self.p).full()
        cut.x = np.hstack([cut.x[:, :-1], last])
        return cut

    # outputs -----------------------------------------------------------------------
    def outputs(self, steps: Steps) -> tuple[np.ndarray, Branches]:
        count = steps.count
        if self.requested is None or count == 0:
            times = np.append(steps.t[:count], steps.end)
            index = np.minimum(np.arange(count + 1), max(count - 1, 0))
            length = np.zeros(count + 1)
            if count:
                length[-1] = steps.h[-1]
            return times, Branches(index, length)
        slack = 1e-12 * max(1.0, abs(steps.end))
        times = self.requested[self.requested <= steps.end + slack]
        if steps.end < self.requested[-1] - slack and (not times.size or times[-1] < steps.end):
            times = np.append(times, steps.end)  # where the run ended early is an output too
        return times, place_outputs(steps, times)

    def status(self, steps: Steps, s: Trajectory, ended_by: list[EventRecord]) -> Status:
        """How the run ended; ``ended_by`` are the events up to a terminal one."""
        ending = Ending(self.kernel, steps, s, self.p, self.following_length(steps))
        if ended_by:
            return ending.terminated(ended_by[-1].name, ended_by[-1].time)
        return ending.status

    def following_length(self, steps: Steps) -> float:
        """Length of the step that comes, or would have come, after the last one."""
        if self.kernel.adaptive is not None:
            return SHORTEST * max(1.0, abs(steps.end))
        lengths = np.diff(uniform_grid(self.start, self.end, self.step))
        return float(lengths[min(steps.count, lengths.size - 1)])
