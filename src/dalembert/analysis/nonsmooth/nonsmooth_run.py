"""Running a motion with contacts: start, steps, outputs, status."""

from __future__ import annotations

import time as clock
from typing import Any

import numpy as np

from dalembert.analysis.nonsmooth.collision_gaps import CollisionGaps
from dalembert.analysis.nonsmooth.contact_step import ContactStep, StepResult
from dalembert.analysis.nonsmooth.correction import consistent, corrected
from dalembert.analysis.nonsmooth.gap_source import FormulaGaps, GapSource
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
from dalembert.elements.contact.collisions import Collisions
from dalembert.elements.contact.unilateral import Unilateral
from dalembert.errors import AnalysisError, SingularityError
from dalembert.model.model import Model
from dalembert.results.contact_record import ContactRecord
from dalembert.results.nonsmooth_motion import NonsmoothMotion
from dalembert.results.recording import Trajectory
from dalembert.results.status import Outcome, Status
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
        if model.diagnosis.massless:
            raise SingularityError(
                f"{', '.join(model.diagnosis.massless)}: can move without any mass moving; "
                "give mass and inertia to the bodies that move there, or constrain them"
            )
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
        return NonsmoothMotion(
            model=self.model,
            analysis=self.analysis,
            parameters=self.p,
            trajectory=sampled(self.model, record, times),
            status=status,
            statistics=self.statistics(record, clock.perf_counter() - begin),
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
                log.add(t + h, h, *self.opened(t + h, taken), taken)
                report((grid[k + 1] - self.start) / (self.end - self.start))
        except KeyboardInterrupt:
            return Status(Outcome.INTERRUPTED, f"stopped at t = {log.t:g} s", log.t, log.open_by)
        text = f"reached t = {log.t:g} s"
        return Status(Outcome.COMPLETED, text, log.t, log.open_by)

    def opened(self, t: float, taken: StepResult) -> tuple[np.ndarray, np.ndarray]:
        """Position and speeds with joints closed and, where the scheme asks for it, gaps open."""
        y, v = taken.y, taken.v
        joints, gaps = self.step.smooth.has_joints, self.analysis.integrator.projection
        if joints or gaps:
            y = corrected(self.step, t, y, v, gaps)
        return y, consistent(self.step, t, y, v) if joints else v

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
        return {
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


@once
def gap_sources(model: Model) -> list[GapSource]:
    """Where gaps of a model come from."""
    elements = list(model.parts.elements.values())
    stated = [e for e in elements if isinstance(e, Unilateral) and e.impact() is not None]
    sources: list[GapSource] = [FormulaGaps(model, stated)] if stated else []
    return sources + [CollisionGaps(model, e) for e in elements if isinstance(e, Collisions)]


def sampled(model: Model, record: ContactRecord, times: np.ndarray) -> Trajectory:
    """States at times within the steps: straight between their ends."""
    k = np.clip(np.searchsorted(record.t, times) - 1, 0, max(record.loss.size - 1, 0))
    if not record.loss.size:
        none = np.zeros((record.v.shape[0], times.size))
        multiplier = np.zeros((record.multiplier.shape[0], times.size))
        y, v, work = (
            np.repeat(s[:, :1], times.size, axis=1) for s in (record.y, record.v, record.work)
        )
        return Trajectory(times, y, v, none, multiplier, work)
    share = (times - record.t[k]) / (record.t[k + 1] - record.t[k])
    manifold = model.equations.manifold
    way = manifold.lead(record.y[:, k], record.y[:, k + 1])
    v, work = (s[:, k] + share * (s[:, k + 1] - s[:, k]) for s in (record.v, record.work))
    y = np.where(share == 1, record.y[:, k + 1], manifold.go(record.y[:, k], share * way))
    return Trajectory(times, y, v, record.a[:, k], record.multiplier[:, k], work)
