"""Marching a structure through time: start, steps, outputs, status."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from dalembert.analysis.kinematics.branches import Branches, outputs_of
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.structural.linear_range import linear_doubts
from dalembert.analysis.structural.rotation_charts import RotationCharts
from dalembert.analysis.structural.transient_equation import EquationOfMotion, moved
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
from dalembert.integrators.marching.steps import Steps
from dalembert.integrators.newmark.rule import Moving
from dalembert.integrators.schedule import Schedule, told_halves
from dalembert.results.status import Outcome, Status, reached, stopped, unsolved
from dalembert.results.structural.motion import StructuralMotion
from dalembert.structures.evaluation.factors import factors_of
from dalembert.structures.model import StructuralModel
from dalembert.timing import Timing

ROUNDS = 3
"""Rounds of work for each step, as the budget counts them."""


class March:
    """Steps taken, and the states at their ends.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Transient``
    model : StructuralModel, linear or not as the analysis wants it
    p : (np,) values of the parameters
    """

    def __init__(self, analysis: Any, model: StructuralModel, p: np.ndarray):
        case = analysis.case_of(model)
        self.analysis = analysis
        self.equation = EquationOfMotion(model, p, case, analysis.damping, analysis.lumped)
        self.start = TransientStart(self.equation, analysis.start, case)
        self.charts = RotationCharts(self.equation)
        self.shortened: dict[int, np.ndarray] = {}
        """Number of steps taken → rotations whose vectors were replaced after them."""
        self._steps: dict[float, TransientStep] = {}
        self.steps: Steps

    def step(self, h: float) -> TransientStep:
        """Steps of a length; equal lengths share their factors."""
        if h not in self._steps:
            self._steps[h] = TransientStep(self.equation, self.analysis.integrator, h)
        return self._steps[h]

    @property
    def iterations(self) -> int:
        """Of Newton's method, in all steps."""
        return sum(step.iterations for step in self._steps.values())

    @property
    def factorisations(self) -> int:
        """Of matrices of steps."""
        return sum(step.factorisations for step in self._steps.values())

    def run(self, times: np.ndarray, report: Callable[[float], None]) -> Status:
        """Take the steps between the times; how it ended.

        A step in which Newton's method fails is halved, and halved again.
        """
        now = self.start.state()
        recorder = Recorder(np.concatenate(now), steps=times.size - 1)
        lengths, taken = _lengths(times), 0
        none = np.zeros(lengths.size, dtype=int)
        ahead = Schedule(times[:-1], lengths, none > 0, none)
        ended: Status | None = None
        try:
            while taken < ahead.h.size:
                t, h = float(ahead.t[taken]), float(ahead.h[taken])
                end = float(np.append(ahead.t, times[-1])[taken + 1])
                new = self.step(h).advance(now, end)
                if new is None:
                    if ahead.halve(taken):
                        continue
                    ended = unsolved(t, self.step(h).left, 0.0)
                    break
                if not np.all(np.isfinite(new.a)):
                    text = f"no finite state after t = {t:.9g} s; use a shorter step"
                    ended = Status(Outcome.DIVERGED, text)
                    break
                taken += 1
                now = self._short(new, taken)
                recorder.add(np.array([t, end]), np.concatenate(now)[:, None])
                report(taken / ahead.h.size)
        except KeyboardInterrupt:
            ended = stopped(float(np.append(ahead.t, times[-1])[taken]), 0.0)
        x = recorder.states(None)
        whole = Steps(ahead.t, ahead.h, x, ahead.corrected, ahead.mode, ahead.halved)
        self.steps = whole if taken == ahead.h.size else whole.cut(taken)
        end, residual = self.steps.end, self._residual(float(lengths[0]))
        return replace(ended or reached(end, 0.0), time=end, residual=residual)

    def _residual(self, h: float) -> float:
        """Of the equations of motion at the end, relative to their terms."""
        e, end = self.equation, self.steps.end
        last = moved(self.node(self.steps.count))
        where = e.free if self.steps.count else e.massive
        step, sizes = self.step(h), abs(e.tangent(last.u))
        return step.residual(last, e.loads(end), where, sizes).relative(step.settings.tolerance)

    def _short(self, x: Moving, node: int) -> Moving:
        where = self.charts.long(x.u)
        if not where.size:
            return x
        self.shortened[node] = where
        for step in self._steps.values():
            step.kept = None
        return self.charts.shortened(x, where)

    def node(self, k: int) -> Moving:
        """State at the end of step ``k``; the beginning for zero."""
        return Moving(*self.steps.x[:, k].reshape(4, -1))

    def arrived(self, k: int) -> Moving:
        """The same as the step left it, before rotation vectors were replaced."""
        x, where = self.node(k), self.shortened.get(k)
        return x if where is None else self.charts.shortened(x, where)

    def states(self, branches: Branches) -> list[Moving]:
        """States at outputs; between the ends of steps by a step of the length that is needed."""
        ends = branches.ends_of(self.steps)
        return [
            self.node(int(k) + int(end)) if end or not length else self._inside(int(k), length)
            for k, length, end in zip(branches.index, branches.length, ends, strict=True)
        ]

    def _inside(self, k: int, length: float) -> Moving:
        step = TransientStep(self.equation, self.analysis.integrator, length)
        found = step.advance(self.node(k), float(self.steps.t[k]) + length)
        if found is None:
            return Moving(*np.full((4, self.equation.assembly.size), np.nan))
        return found


def _lengths(times: np.ndarray) -> np.ndarray:
    """Lengths of the steps, equal ones to the last bit."""
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
        """March, and take the outputs."""
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
        placed, branches = outputs_of(march.steps, requested)
        statistics = {
            "displacements": march.equation.assembly.size,
            "steps": march.steps.count,
            "rejected steps": march.steps.rejected,
            "iterations": march.iterations,
            "factorisations": march.factorisations,
            "build time [s]": round(model.build_time, 6),
        }
        motion = motion_at(march, a, placed, branches, status, statistics)
        timing.lap("outputs")
        motion.statistics |= timing.statistics
        motion.warnings = told_halves(march.steps.rejected)
        if not a.nonlinear:
            motion.warnings += self._linear_doubts(motion, march)
        return motion

    def _linear_doubts(self, motion: StructuralMotion, march: March) -> list[str]:
        """Displacements that are too large for linear equations, where they are largest."""
        u = motion.displacements
        if not u.size or self.model.linear:
            return []
        k = int(np.argmax(np.abs(u).max(axis=0)))
        assembly = march.equation.assembly
        free, rest = assembly.free, np.zeros(assembly.size)

        def solved(forces: np.ndarray) -> np.ndarray:
            found = np.zeros_like(forces)
            stiffness = assembly.inner(assembly.stiffness(rest, self.p))
            factor = factors_of(stiffness, self.model.degrees, free)
            if factor is not None:
                found[free] = factor.solve(forces[free])
            return found

        name = f"at t = {motion.time[k]:.6g} s"
        return linear_doubts(
            self.model, self.p, [name], u[:, k : k + 1], solved, "use nonlinear=True"
        )


def motion_at(
    march: March,
    analysis: Any,
    times: np.ndarray,
    branches: Branches,
    status: Status,
    statistics: dict[str, Any],
) -> StructuralMotion:
    """The motion at outputs."""
    e, found = march.equation, march.states(branches)
    forces = [e.external_forces(moved(x), float(t)) for x, t in zip(found, times, strict=True)]
    u, v, a = (np.stack(column, axis=1) for column in zip(*(moved(x) for x in found), strict=True))
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
    """What a gradient needs of a run.

    Attributes
    ----------
    march : equations, steps and states
    steps : the steps taken
    branches : where the outputs lie among them
    """

    march: March
    steps: Steps
    branches: Branches
