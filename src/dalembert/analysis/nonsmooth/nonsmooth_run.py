"""Running a motion with contacts: start, steps, outputs, status."""

from __future__ import annotations

import time as clock
from dataclasses import replace
from typing import Any

import numpy as np

from dalembert.analysis.contact.start import touching_model
from dalembert.analysis.elastic_range import elastic_doubts
from dalembert.analysis.nonsmooth.contact_step import ContactStep, StepResult
from dalembert.analysis.nonsmooth.contact_truth import ContactTruth
from dalembert.analysis.nonsmooth.correction import consistent, corrected
from dalembert.analysis.nonsmooth.gap_sources import gap_sources
from dalembert.analysis.nonsmooth.sampling import sampled
from dalembert.analysis.nonsmooth.smooth_motion import SmoothMotion
from dalembert.analysis.nonsmooth.step_log import StepLog
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.timeline import (
    afford_states,
    check_driver_laws,
    checked_span,
    checked_step,
    output_times,
    step_count,
    uniform_grid,
)
from dalembert.errors import AnalysisError, SingularityError
from dalembert.model.model import Model
from dalembert.results.nonsmooth_motion import ContactRecord, NonsmoothMotion
from dalembert.results.status import Outcome, Status, reached, stopped
from dalembert.symbolic.equations.newton import Solution
from dalembert.symbolic.once import once


class NonsmoothRun:
    """One execution of an analysis with contacts.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Nonsmooth``
    model : Model
    parameters : new values, or the whole vector
    """

    def __init__(self, analysis: Any, model: Model, parameters):
        self.analysis, self.model = analysis, model
        self.start, self.end = checked_span(analysis.duration, analysis.t_span)
        self.h = checked_step(analysis.step, self.start, self.end)
        self.requested = output_times(analysis.outputs, self.start, self.end)
        e = model.equations
        afford_states(
            step_count(self.start, self.end, self.h), 3 * (e.coordinate_count + e.speed_count)
        )
        self.p = model.values(parameters)
        self.closed_gaps = ""
        if analysis.integrator.projection:  # else gaps stay as they are throughout
            model, self.closed_gaps = touching_model(model, self.p, self.start)
            self.model = model
        model.diagnosis.refuse_massless()
        check_driver_laws(model, np.linspace(self.start, self.end, 1001), self.p)
        sources = gap_sources(model)
        if not sources:
            raise AnalysisError(
                "nothing in the model may touch; add Collisions or another rigid contact, or use "
                "solve_dynamics"
            )
        self.step = ContactStep(
            model, smooth_motion(model), sources, analysis.integrator, analysis.solver, self.p
        )

    def execute(self, progress) -> NonsmoothMotion:
        state = self.model.assemble(self.p, self.start)
        log = StepLog(self.step, self.start, state.y, state.v)
        grid = uniform_grid(self.start, self.end, self.h)
        begin = clock.perf_counter()
        with progress_reporter(progress, f"integrating {self.model.name}") as report:
            status = self.march(grid, log, report)
        record = log.record()
        times = record.t if self.requested is None else self.requested
        times = times[times <= record.t[-1]] if times.size else times
        elapsed = clock.perf_counter() - begin
        truth = ContactTruth(self.step, record, self.analysis.balance)
        status = replace(status, residual=max(status.residual, truth.residual))
        trajectory = sampled(self.model, record, times)
        return NonsmoothMotion(
            model=self.model,
            analysis=self.analysis,
            parameters=self.p,
            trajectory=trajectory,
            status=truth.judged(status),
            statistics=self.statistics(record, elapsed),
            warnings=[*truth.doubts, *elastic_doubts(self.model, trajectory, self.p)],
            record=record,
        )

    def march(self, grid: np.ndarray, log: StepLog, report) -> Status:
        """Step to the end, or to where a step fails."""
        taken: StepResult | None = None
        try:
            for k in range(grid.size - 1):
                t, h = float(grid[k]), float(grid[k + 1] - grid[k])
                taken = self.step.take(t, h, log.y, log.v, taken)
                if trouble := self.trouble(t, taken):
                    return trouble
                place = self.opened(t + h, taken)
                if not place.accepted:
                    return self.unopened(t, h, place)
                log.add(t + h, h, place.x, self.speeds(t + h, place.x, taken), taken)
                report((grid[k + 1] - self.start) / (self.end - self.start))
        except KeyboardInterrupt:
            return stopped(log.t, log.open_by)
        except SingularityError as error:
            if taken is None:
                raise
            return Status(Outcome.SINGULAR, f"{error} (t = {log.t:.9g} s)", log.t, log.open_by)
        return reached(log.t, log.open_by)

    def opened(self, t: float, taken: StepResult) -> Solution[np.ndarray]:
        """Position with joints closed and, where the scheme asks for it, gaps open."""
        return corrected(self.step, t, taken.y, self.analysis.integrator.projection)

    def speeds(self, t: float, y: np.ndarray, taken: StepResult) -> np.ndarray:
        """Speeds that joints allow at that position."""
        joints = self.step.smooth.has_joints
        return consistent(self.step, t, y, taken.v) if joints else taken.v

    def unopened(self, t: float, h: float, place: Solution[np.ndarray]) -> Status:
        """Why no position could be found that a step leads to."""
        what = "joints could not be closed nor gaps opened"
        if not self.analysis.integrator.projection:
            what = "joints could not be closed"
        text = f"{what} at t = {t + h:.9g} s ({place}); use a shorter step"
        left = place.residual * self.model.scales.length
        return Status(Outcome.NOT_CONVERGED, text, t, left)

    def trouble(self, t: float, taken: StepResult) -> Status | None:
        """Why a step cannot count, if so."""
        found = taken.impulses
        if not (np.isfinite(taken.y).all() and np.isfinite(taken.v).all()):
            text = f"no finite state after t = {t:.9g} s; use a shorter step"
            return Status(Outcome.DIVERGED, text, t, np.inf)
        if not found.converged:
            text = (
                f"the impulses of {taken.contacts.count} contacts at t = {t:.9g} s were not found "
                f"(residual {found.residual:.3g} m/s after {found.rounds} rounds); with much "
                "friction there may be none, else give ContactSolver more max_iterations"
            )
            return Status(Outcome.NOT_CONVERGED, text, t, found.residual)
        return None

    def statistics(self, record: ContactRecord, elapsed: float) -> dict[str, Any]:
        count = max(record.loss.size, 1)
        key = "overlaps closed at the start"
        told = {key: self.closed_gaps} if self.closed_gaps else {}
        return told | {
            "integrator": type(self.analysis.integrator).__name__,
            "steps": record.loss.size,
            "integration time [s]": round(elapsed, 6),
            "time per step [ms]": round(1e3 * elapsed / count, 3),
            "most contacts pressing": int(record.pressing.max(initial=0)),
            "proximal rounds": int(record.rounds.sum()),
            "largest residual [m/s]": float(record.residual.max(initial=0.0)),
            "deepest penetration [m]": float(record.penetration.max(initial=0.0)),
            "energy lost in contacts [J]": float(record.loss.sum()),
            "largest energy gained in contacts [J]": float((-record.loss).max(initial=0.0)),
        }


@once
def smooth_motion(model: Model) -> SmoothMotion:
    """Functions of a model, made once."""
    return SmoothMotion(model)
