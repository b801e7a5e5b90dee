"""Execution of a nonsmooth analysis: start, steps, outputs, status."""

from __future__ import annotations

import copy
import time as clock
from dataclasses import replace
from typing import Any

import numpy as np

from dalembert.analysis.contact.gap_checks import touching_model
from dalembert.analysis.elastic_range import elastic_warnings
from dalembert.analysis.nonsmooth.advance import advance
from dalembert.analysis.nonsmooth.between_steps import interpolate
from dalembert.analysis.nonsmooth.checks.contact_check import ContactCheck
from dalembert.analysis.nonsmooth.checks.missing_impacts import (
    largest,
    missing_impact_warnings,
    unsearched_impacts,
)
from dalembert.analysis.nonsmooth.checks.passages import passage_warnings
from dalembert.analysis.nonsmooth.checks.run_accuracy import RunAccuracy, check_speeds
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction import ConsistentSpeeds, correct_position, is_far
from dalembert.analysis.nonsmooth.free_bodies.free_body_march import FreeBodyMarch
from dalembert.analysis.nonsmooth.free_bodies.sleeping_bodies import SleepRule
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.separate_impacts import ImpactSequence
from dalembert.analysis.nonsmooth.smooth_motion import smooth_motion
from dalembert.analysis.nonsmooth.speed_jumps import speeds_after
from dalembert.analysis.nonsmooth.starts.touching_shapes import (
    bodies_of,
    refuse_lonely_shapes,
    refuse_moving_places,
    refuse_start,
)
from dalembert.analysis.nonsmooth.step_log import StepLog
from dalembert.analysis.nonsmooth.step_state import PATH_CHANGE, StepResult, step_lengths
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.timeline import (
    afford_states,
    check_driver_laws,
    run_times,
    step_count,
    uniform_grid,
)
from dalembert.errors import AnalysisError, SingularityError
from dalembert.model.graph.assembly.guesses import AssembledState
from dalembert.model.graph.model import Model
from dalembert.results.nonsmooth_motion import ContactRecord, NonsmoothMotion
from dalembert.results.status import Outcome, Status, Warnings, reached, stopped
from dalembert.sparse.single_thread import single_thread
from dalembert.symbolic.equations.newton import Solution

DIVISIONS = 6
"""Upper limit of the divisions of a step in halves, where its impulses do not converge or its
positions cannot be corrected."""


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
        self.start, self.end, self.h, self.requested = run_times(analysis)
        e = model.equations
        afford_states(
            step_count(self.start, self.end, self.h), 3 * (e.coordinate_count + e.speed_count)
        )
        self.p = model.values(parameters)
        self.closed_gaps, self.divisions = "", 0
        if analysis.integrator.projection:  # otherwise initial gaps are never corrected
            model, self.closed_gaps = touching_model(model, self.p, self.start)
            self.model = model
        model.diagnosis.refuse_massless()
        check_driver_laws(model, np.linspace(self.start, self.end, 1001), self.p)
        refuse_lonely_shapes(list(model.parts.elements.values()))
        sources = gap_sources(model)
        if not sources:
            raise AnalysisError(
                "nothing in the model may touch; add Collisions or another rigid contact, or use "
                "solve_dynamics"
            )
        refuse_moving_places([element for source in sources for element in source.elements])
        smooth, scheme = smooth_motion(model), analysis.integrator
        rest = self.h if analysis.separate_impacts else 0.0
        own = sources, self.p, smooth, scheme, analysis.solver, self.h, rest
        self.step = ContactStep(model, *own)

    def state_at_start(self) -> AssembledState:
        """Assembled state; ``AnalysisError`` where shapes cannot start there."""
        state = self.model.assemble(self.p, self.start)
        refuse_start(self.step, self.start, state.y)
        return state

    def execute(self, progress) -> NonsmoothMotion:
        state = self.state_at_start()
        self.state = state.y, state.v
        log = StepLog(self.step, self.start, *self.state)
        grid = uniform_grid(self.start, self.end, self.h)
        begin = clock.perf_counter()
        with progress_reporter(progress, f"integrating {self.model.name}") as report:
            status = self.march(grid, log, report)
        record = log.record()
        times = record.t if self.requested is None else self.requested
        times = times[times <= record.t[-1]] if times.size else times
        elapsed = clock.perf_counter() - begin
        record = replace(record, accuracy=RunAccuracy(self.step, record, self.repeated))
        check = ContactCheck(self.step, record, self.analysis.balance, log.corrections)
        status = replace(status, residual=max(status.residual, check.residual))
        trajectory = interpolate(self.model, record, times)
        warnings = passage_warnings(log.passages)
        unsearched = unsearched_impacts(self.step, record, np.array(log.compiled, dtype=int))
        missing = largest([*log.missing_impacts, *unsearched])
        warnings += missing_impact_warnings(missing, check.energy.moved) + check.warnings
        warnings += elastic_warnings(self.model, trajectory, self.p)
        status = check.verify(status)
        late = (lambda: record.accuracy.warnings) if status.success else None
        return NonsmoothMotion(
            model=self.model,
            analysis=self.analysis,
            parameters=self.p,
            trajectory=trajectory,
            status=status,
            statistics=self.statistics(record, log, elapsed),
            warnings=Warnings(warnings, late),
            record=record,
        )

    def repeated(self, grid: np.ndarray, fastest: float) -> tuple[np.ndarray, Status]:
        """(n_y, K+1) positions at the times of a grid, in steps between them, and the status;
        ``Diverged`` with speeds above ``fastest``."""
        run = copy.copy(self)
        run.step = replace(self.step, longest=float(np.diff(grid).max()))
        log = StepLog(run.step, self.start, *self.state)
        status = run.march(grid, log, lambda share: check_speeds(log.t, log.v, fastest))
        return np.stack(log.positions, 1)[:, np.isin(log.times, grid)], status

    @single_thread()
    @np.errstate(over="ignore", invalid="ignore")
    def march(self, grid: np.ndarray, log: StepLog, report) -> Status:
        """Steps until the end, or until one fails that is not divided further; numbers that are not
        finite end in a status."""
        result, last, k = None, None, 0
        if self.step.smooth.coupling.orderings is not None:
            self.step.smooth.coupling.orderings.forget()
        loop = FreeBodyMarch.of(self.step, SleepRule.of(self.analysis))
        sequence = ImpactSequence(self.step) if self.analysis.separate_impacts else None
        self.sleeping = loop.sleeping if loop else None
        try:
            while k < grid.size - 1:
                if loop is not None and last is not None:
                    state = grid, k, log, last, report
                    if sequence:
                        grid, k, last = sequence.march(loop, self.divided, *state)
                        self.divisions += grid.size - state[0].size
                    else:
                        k, last = loop.march(*state)
                    if k == grid.size - 1:
                        break
                t, h = float(grid[k]), float(grid[k + 1] - grid[k])
                result = advance(self.step_at(grid, k), t, h, log.y, log.v, last)
                failure = self.failure(t, h, result, log)
                inexact = failure is None and result.path_change > PATH_CHANGE
                divided = self.divided(grid, k) if inexact else None
                goes_on = failure is None and divided is None
                position = self.corrected(t + h, h, result) if goes_on else None
                own = None if inexact else sequence
                if position and own and own.divides(t, h, log, result, last, position.x):
                    divided = self.divided(grid, k, own.divisions)
                if divided is not None:
                    grid, self.divisions = divided, self.divisions + 1
                    continue
                if position:
                    if not position.accepted:
                        failure = self.not_corrected(t, h, str(position), position.residual)
                    elif self.is_far(t + h, log.y, result.y, position.x):
                        far = "the nearest such position is farther than the motion of the step"
                        failure = self.not_corrected(t, h, far, position.residual)
                if failure is not None:
                    divided = self.divided(grid, k)
                    if failure.outcome is not Outcome.NOT_CONVERGED or divided is None:
                        return failure
                    grid, self.divisions = divided, self.divisions + 1
                    continue
                assert position is not None
                speeds, result = self.speeds(t, h, position.x, result)
                log.add(t + h, h, position.x, speeds, result)
                k, last = k + 1, result.last
                report((grid[k] - self.start) / (self.end - self.start))
        except KeyboardInterrupt:
            return stopped(log.t, log.open_by)
        except SingularityError as error:
            if result is None:
                raise
            return Status(Outcome.SINGULAR, f"{error} (t = {log.t:.9g} s)", log.t, log.open_by)
        return reached(log.t, log.open_by)

    def corrected(self, t: float, h: float, result: StepResult) -> Solution[np.ndarray]:
        """Position with joints closed and, if the scheme corrects gaps, gaps open."""
        travel, projection = h * result.v[:, None], self.analysis.integrator.projection
        return correct_position(self.step, t, result.y, projection, travel)

    def free_position(self, t: float, h: float, log: StepLog) -> Solution[np.ndarray] | None:
        """Position with joints closed after a step without impulses; None without joints."""
        if not self.step.smooth.has_joints:
            return None
        theta, start = self.step.scheme.theta, self.step.begin(t, h, log.y, log.v, False)
        travel = h * (theta * start.free + (1 - theta) * log.v)
        y = self.model.equations.manifold.go(log.y, travel)
        return correct_position(self.step, t + h, y, False, travel[:, None])

    def speeds(
        self, t: float, h: float, y: np.ndarray, result: StepResult
    ) -> tuple[ConsistentSpeeds, StepResult]:
        """Speeds consistent with the joints at a position, and the result with their impulses."""
        if not self.step.smooth.has_joints:
            return ConsistentSpeeds(result.v), result
        return speeds_after(self.step, t, h, y, result)

    def is_far(self, t: float, start: np.ndarray, end: np.ndarray, corrected: np.ndarray) -> bool:
        """Whether gaps are opened by more than the motion of a step from ``start`` to ``end``.

        The start is a position with open gaps, and near. A correction is linear in the gaps, and
        moves bodies without bounds where their directions turn normal to the motion.
        """
        if not is_far(self.step, end, corrected, start):
            return False
        return self.step.deepest(self.step.at(t, end)) < -self.step.rounding

    def not_corrected(self, t: float, h: float, reason: str, residual: float) -> Status:
        """Status of a run in which the correction of positions failed."""
        text = "joints could not be closed nor gaps opened"
        if not self.analysis.integrator.projection:
            text = "joints could not be closed"
        text = f"{text} at t = {t + h:.9g} s ({reason}); use a shorter step"
        return Status(Outcome.NOT_CONVERGED, text, t, residual * self.step.length)

    def step_at(self, grid: np.ndarray, k: int) -> ContactStep:
        """Functions of the step ``k``."""
        longest = step_lengths(grid, k, self.step.longest)[2]
        return self.step if longest == self.step.longest else replace(self.step, longest=longest)

    def divided(self, grid: np.ndarray, k: int, divisions: int = DIVISIONS) -> np.ndarray | None:
        """The grid with the step ``k`` divided in halves, or the next one if that is longer: a step
        may fail as it leaves room for an impact in a long next one. None where both are short."""
        h, following, _ = step_lengths(grid, k, self.step.longest)
        if following > 1.5 * h:
            return np.insert(grid, k + 2, grid[k + 1] + following / 2)
        if h > 1.5 * self.step.longest / 2**divisions:
            return np.insert(grid, k + 1, grid[k] + h / 2)
        return None

    def failure(self, t: float, h: float, result: StepResult, log: StepLog) -> Status | None:
        """Status of a run whose last step failed; None if it succeeded."""
        impulses = result.impulses
        if not (np.isfinite(result.y).all() and np.isfinite(result.v).all()):
            text = f"no finite state after t = {t:.9g} s; use a shorter step"
            return Status(Outcome.DIVERGED, text, t, np.inf)
        if not impulses.accepted:
            position = self.free_position(t, h, log)
            if position is not None and not position.accepted:
                return self.not_corrected(t, h, str(position), position.residual)
            text = (
                f"the impulses of {result.contacts.count} contacts at t = {t:.9g} s did not "
                f"converge (residual {impulses.residual:.3g} m/s after {impulses.rounds} rounds, "
                f"in a step of {h:.3g} s), the largest of {self.largest_impulse(result)}; use a "
                f"shorter step{self.further_remedies()}; "
                "there may be no solution with much friction, or where joints and drivers leave "
                "bodies no way to part"
            )
            return Status(Outcome.NOT_CONVERGED, text, t, impulses.residual)
        return None

    def largest_impulse(self, result: StepResult) -> str:
        """Names of the bodies of the contact with the largest normal impulse."""
        row = int(np.argmax(np.nan_to_num(np.abs(result.impulses.impulses[:, 0]))))
        return bodies_of(self.model, result.contacts, row)

    def further_remedies(self) -> str:
        """Remedies besides a shorter step where impulses do not converge."""
        scheme = ", integrator=MoreauJean()" if self.analysis.integrator.anticipates else ""
        return f"{scheme} or ContactSolver with more max_iterations"

    def statistics(self, record: ContactRecord, log: StepLog, elapsed: float) -> dict[str, Any]:
        count = max(record.loss.size, 1)
        closed, depth = self.closed_gaps, float(record.penetration[0])
        if not closed and depth > self.step.rounding:
            closed = f"up to {depth:.3g} m"
        own: dict[str, Any] = {"initial overlaps removed": closed} if closed else {}
        if self.step.force_laws.elements:
            deepest = float(record.compression.max(initial=0.0))
            own["maximum penetration of compliant contacts [m]"] = deepest
        if self.sleeping and self.analysis.sleep_after is not None:
            own["bodies that sleep, on average"] = round(self.sleeping.count / count, 3)
        return own | {
            "integrator": type(self.analysis.integrator).__name__,
            "steps": record.loss.size,
            "divisions of steps": self.divisions,
            "integration time [s]": round(elapsed, 6),
            "time per step [ms]": round(1e3 * elapsed / count, 3),
            "maximum active contacts": int(record.pressing.max(initial=0)),
            "proximal iterations": int(record.rounds.sum()),
            "maximum residual [m/s]": float(record.residual.max(initial=0.0)),
            "maximum penetration [m]": float(record.penetration.max(initial=0.0)),
            "energy dissipated in contacts [J]": float(record.loss.sum()),
            "energy dissipated by friction of contacts [J]": log.friction,
            "energy dissipated by the scheme [J]": float(log.scheme_losses[-1]),
            "work of corrections of positions [J]": log.corrections.total,
            "maximum energy gained in contacts [J]": float((-record.loss).max(initial=0.0)),
        }
