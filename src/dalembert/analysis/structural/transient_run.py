"""Time integration of a structure: start, steps, outputs, status."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dalembert.analysis.equilibrium.linear_range import linear_range_warnings
from dalembert.analysis.kinematics.branches import Branches, outputs_of
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.structural.rotation_charts import RotationCharts
from dalembert.analysis.structural.transient_equation import EquationOfMotion, motion_of
from dalembert.analysis.structural.transient_start import TransientStart
from dalembert.analysis.structural.transient_step import TransientStep
from dalembert.analysis.timeline import (
    afford_states,
    checked_span,
    checked_step,
    output_times,
    step_count,
    uniform_grid,
)
from dalembert.budget import check_budget
from dalembert.integrators.marching.checkpoints import Recorder
from dalembert.integrators.marching.steps import Schedule, Steps, halving_warnings
from dalembert.integrators.newmark.rule import Moving
from dalembert.model.assembled.evaluation.stiffness_solvers import factors_of, free_displacements
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.status import Outcome, Status, reached, stopped, unsolved
from dalembert.results.structural.motion import StructuralMotion
from dalembert.timing import Timing

ROUNDS = 3
"""Cost of a step in rounds of the budget."""


class March:
    """Accepted steps, and the states at their ends.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Transient``
    model : StructuralModel, linear or not as in the analysis
    p : (np,) values of the parameters
    """

    def __init__(self, analysis: Any, model: StructuralModel, p: np.ndarray):
        case = analysis.case_of(model)
        self.analysis = analysis
        self.equation = EquationOfMotion(model, p, case, analysis.damping, analysis.lumped)
        self.start = TransientStart(self.equation, analysis.start, case)
        self.charts = RotationCharts(self.equation)
        self.shortened: dict[int, np.ndarray] = {}
        """Number of steps → rotations whose vectors were replaced after them."""
        self._steps: dict[float, TransientStep] = {}
        self.steps: Steps

    def step(self, h: float) -> TransientStep:
        """Step of a length; equal lengths share their factors."""
        if h not in self._steps:
            self._steps[h] = TransientStep(self.equation, self.analysis.integrator, h)
        return self._steps[h]

    @property
    def iterations(self) -> int:
        """Number of Newton iterations in all steps."""
        return sum(step.iterations for step in self._steps.values())

    @property
    def factorisations(self) -> int:
        """Number of factorisations in all steps."""
        return sum(step.factorisations for step in self._steps.values())

    def run(self, times: np.ndarray, report: Callable[[float], None]) -> Status:
        """Take the steps between the times; returns the status.

        A step in which Newton's method fails is halved, repeatedly if necessary.
        """
        state = self.start.state()
        recorder = Recorder(np.concatenate(state), steps=times.size - 1)
        lengths, accepted = _lengths(times), 0
        no_halvings = np.zeros(lengths.size, dtype=int)
        schedule = Schedule(times[:-1], lengths, no_halvings > 0, no_halvings)
        status: Status | None = None
        try:
            while accepted < schedule.h.size:
                t, h = float(schedule.t[accepted]), float(schedule.h[accepted])
                end = float(np.append(schedule.t, times[-1])[accepted + 1])
                result = self.step(h).advance(state, end)
                if result is None:
                    if schedule.halve(accepted):
                        continue
                    status = unsolved(t, self.step(h).relative_residual, 0.0)
                    break
                if not np.all(np.isfinite(result.a)):
                    text = f"no finite state after t = {t:.9g} s; use a shorter step"
                    status = Status(Outcome.DIVERGED, text)
                    break
                accepted += 1
                state = self._shorten(result, accepted)
                recorder.add(np.array([t, end]), np.concatenate(state)[:, None])
                report(accepted / schedule.h.size)
        except KeyboardInterrupt:
            status = stopped(float(np.append(schedule.t, times[-1])[accepted]), 0.0)
        x = recorder.states(None)
        steps = Steps(schedule.t, schedule.h, x, schedule.corrected, schedule.mode, schedule.halved)
        self.steps = steps if accepted == schedule.h.size else steps.cut(accepted)
        end, residual = self.steps.end, self._residual(float(lengths[0]))
        return replace(status or reached(end, 0.0), time=end, residual=residual)

    def _residual(self, h: float) -> float:
        """Residual of the equations of motion at the end, relative to their terms."""
        e, end = self.equation, self.steps.end
        last = motion_of(self.node(self.steps.count))
        rows = e.free if self.steps.count else e.massive
        step, sizes = self.step(h), abs(e.tangent(last.u))
        return step.residual(last, e.loads(end), rows, sizes).relative(step.settings.tolerance)

    def _shorten(self, x: Moving, node: int) -> Moving:
        rotations = self.charts.long(x.u)
        if not rotations.size:
            return x
        self.shortened[node] = rotations
        for step in self._steps.values():
            step.previous = None
        return self.charts.shorten(x, rotations)

    def node(self, k: int) -> Moving:
        """State at the end of step ``k``; the start for zero."""
        return Moving(*self.steps.x[:, k].reshape(4, -1))

    def arrived(self, k: int) -> Moving:
        """State at the end of step ``k`` before rotation vectors were replaced."""
        x, rotations = self.node(k), self.shortened.get(k)
        return x if rotations is None else self.charts.shorten(x, rotations)

    def states(self, branches: Branches) -> list[Moving]:
        """States at outputs; between the ends of steps by a shorter step."""
        ends = branches.ends_of(self.steps)
        return [
            self.node(int(k) + int(end)) if end or not length else self._inside(int(k), length)
            for k, length, end in zip(branches.index, branches.length, ends, strict=True)
        ]

    def _inside(self, k: int, length: float) -> Moving:
        step = TransientStep(self.equation, self.analysis.integrator, length)
        state = step.advance(self.node(k), float(self.steps.t[k]) + length)
        if state is None:
            return Moving(*np.full((4, self.equation.assembly.size), np.nan))
        return state


def _lengths(times: np.ndarray) -> np.ndarray:
    """Lengths of the steps; nearly equal ones become identical."""
    h = np.diff(times)
    same = np.isclose(h, h[0], rtol=1e-9, atol=0)
    return np.where(same, h[0], h)


@dataclass
class TransientRun:
    """One execution of a transient analysis.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Transient``
    model : StructuralModel
    p : (np,) values of the parameters
    """

    analysis: Any
    model: StructuralModel
    p: np.ndarray

    def execute(self, progress: Any = False) -> StructuralMotion:
        """Integrate and evaluate the outputs."""
        a, timing = self.analysis, Timing()
        start, end = checked_span(a.duration, None)
        step, n = checked_step(a.step, start, end), len(self.model.degrees)
        count = step_count(start, end, step)
        cure = "use a longer step or a shorter run"
        check_budget(f"{count} steps of a structure", rounds=ROUNDS * count, cure=cure)
        afford_states(count, 4 * n)
        times = uniform_grid(start, end, step)
        requested = output_times(a.outputs, start, end)
        afford_states(times.size if requested is None else requested.size, 8 * n)
        model = self.model if a.nonlinear else self.model.linearized
        march = March(a, model, self.p)
        with progress_reporter(progress, f"integrating {model.name}") as report:
            status = march.run(times, report)
        timing.lap("integration")
        if requested is None and march.steps.rejected:
            requested = times
        times_of_outputs, branches = outputs_of(march.steps, requested)
        statistics = {
            "displacements": march.equation.assembly.size,
            "steps": march.steps.count,
            "rejected steps": march.steps.rejected,
            "iterations": march.iterations,
            "factorisations": march.factorisations,
            "build time [s]": round(model.build_time, 6),
        }
        motion = motion_at(march, a, times_of_outputs, branches, status, statistics)
        timing.lap("outputs")
        motion.statistics |= timing.statistics
        motion.warnings = halving_warnings(march.steps.rejected)
        if not a.nonlinear:
            motion.warnings += self._range_warnings(motion, march)
        return motion

    def _range_warnings(self, motion: StructuralMotion, march: March) -> list[str]:
        """Warning where the largest displacements exceed the range of linear equations."""
        u = motion.displacements
        if not u.size or self.model.linear:
            return []
        k = int(np.argmax(np.abs(u).max(axis=0)))
        assembly = march.equation.assembly
        free, rest = assembly.free, np.zeros(assembly.size)

        def solve(forces: np.ndarray) -> np.ndarray:
            stiffness = assembly.inner(assembly.stiffness(rest, self.p))
            factor = factors_of(stiffness, self.model.degrees, free)
            return free_displacements(factor, free, forces)

        name = f"at t = {motion.time[k]:.6g} s"
        return linear_range_warnings(
            self.model, self.p, [name], u[:, k : k + 1], solve, "use nonlinear=True"
        )


def motion_at(
    march: March,
    analysis: Any,
    times: np.ndarray,
    branches: Branches,
    status: Status,
    statistics: dict[str, Any],
) -> StructuralMotion:
    """The motion at output times."""
    e, states = march.equation, march.states(branches)
    forces = [e.external_forces(motion_of(x), float(t)) for x, t in zip(states, times, strict=True)]
    u, v, a = (
        np.stack(column, axis=1) for column in zip(*(motion_of(x) for x in states), strict=True)
    )
    return StructuralMotion(
        model=e.model,
        analysis=analysis,
        parameters=e.p,
        time=times,
        displacements=u,
        velocities=v,
        accelerations=a,
        forces=np.stack(forces, axis=1),
        mass=e.mass,
        status=status,
        statistics=statistics,
        record=TransientRecord(march, march.steps, branches),
    )


@dataclass(frozen=True)
class TransientRecord:
    """Data of a run for gradients.

    Attributes
    ----------
    march : equations, steps and states
    steps : accepted steps
    branches : positions of the outputs within the steps
    """

    march: March
    steps: Steps
    branches: Branches
