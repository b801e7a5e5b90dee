"""Execution of a nonsmooth analysis: start, steps, outputs, check of the result, status."""

from __future__ import annotations

import time as clock
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from dalembert.analysis.contact.gap_checks import ROUNDED, touching_model
from dalembert.analysis.dynamics.residual_check import DRIFT, DRIFT_WARNING, EnergyBalance
from dalembert.analysis.elastic_range import elastic_warnings
from dalembert.analysis.model_residuals import Violation
from dalembert.analysis.nonsmooth.advance import advance
from dalembert.analysis.nonsmooth.alternating_forces import alternation_warnings
from dalembert.analysis.nonsmooth.between_steps import interpolate
from dalembert.analysis.nonsmooth.contact_durations import duration_warnings
from dalembert.analysis.nonsmooth.contact_step import ContactStep
from dalembert.analysis.nonsmooth.correction import (
    ConsistentSpeeds,
    consistent_speeds,
    correct_position,
)
from dalembert.analysis.nonsmooth.free_bodies.free_body_march import FreeBodyMarch
from dalembert.analysis.nonsmooth.gaps.collision_gaps import gap_sources
from dalembert.analysis.nonsmooth.lifted_bodies import lifting_warnings
from dalembert.analysis.nonsmooth.missing_rebounds import rebound_warnings
from dalembert.analysis.nonsmooth.smooth_motion import smooth_motion
from dalembert.analysis.nonsmooth.step_log import StepLog
from dalembert.analysis.nonsmooth.step_state import StepResult
from dalembert.analysis.nonsmooth.touching_shapes import (
    bodies_of,
    refuse_concentric,
    refuse_lonely_shapes,
    refuse_moving_places,
)
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.residual_check import EXACT, ResidualCheck
from dalembert.analysis.timeline import (
    afford_states,
    check_driver_laws,
    run_times,
    step_count,
    uniform_grid,
)
from dalembert.errors import AnalysisError, SingularityError
from dalembert.formulations.base import Level
from dalembert.model.graph.model import Model
from dalembert.results.nonsmooth_motion import ContactRecord, NonsmoothMotion
from dalembert.results.status import Outcome, Status, reached, stopped
from dalembert.symbolic.equations.newton import Solution


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
        self.closed_gaps = ""
        if analysis.integrator.projection:  # otherwise initial gaps are never corrected
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
        elements = [element for source in sources for element in source.elements]
        refuse_lonely_shapes(elements)
        refuse_moving_places(elements)
        self.step = ContactStep(
            model, smooth_motion(model), sources, analysis.integrator, analysis.solver, self.p
        )

    def execute(self, progress) -> NonsmoothMotion:
        state = self.model.assemble(self.p, self.start)
        refuse_concentric(self.step, self.start, state.y)
        log = StepLog(self.step, self.start, state.y, state.v)
        grid = uniform_grid(self.start, self.end, self.h)
        begin = clock.perf_counter()
        with progress_reporter(progress, f"integrating {self.model.name}") as report:
            status = self.march(grid, log, report)
        record = log.record()
        times = record.t if self.requested is None else self.requested
        times = times[times <= record.t[-1]] if times.size else times
        elapsed = clock.perf_counter() - begin
        check = ContactCheck(self.step, record, self.analysis.balance, log.correction_work)
        status = replace(status, residual=max(status.residual, check.residual))
        trajectory = interpolate(self.model, record, times)
        return NonsmoothMotion(
            model=self.model,
            analysis=self.analysis,
            parameters=self.p,
            trajectory=trajectory,
            status=check.verify(status),
            statistics=self.statistics(record, log, elapsed),
            warnings=[*check.warnings, *elastic_warnings(self.model, trajectory, self.p)],
            record=record,
        )

    def march(self, grid: np.ndarray, log: StepLog, report) -> Status:
        """Steps until the end or until one fails."""
        result, last, k = None, None, 0
        balls = FreeBodyMarch.of(self.step)
        try:
            while k < grid.size - 1:
                if balls is not None and last is not None:
                    k, last = balls.march(grid, k, log, last, report)
                    if k == grid.size - 1:
                        break
                t, h = float(grid[k]), float(grid[k + 1] - grid[k])
                result = advance(self.step, t, h, log.y, log.v, last)
                if failure := self.failure(t, result):
                    return failure
                position = self.corrected(t + h, h, result)
                if not position.accepted:
                    return self.not_corrected(t, h, position)
                log.add(t + h, h, position.x, self.speeds(t + h, position.x, result), result)
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

    def speeds(self, t: float, y: np.ndarray, result: StepResult) -> ConsistentSpeeds:
        """Speeds consistent with the joints at a position."""
        if not self.step.smooth.has_joints:
            return ConsistentSpeeds(result.v)
        return consistent_speeds(self.step, t, y, result.v)

    def not_corrected(self, t: float, h: float, position: Solution[np.ndarray]) -> Status:
        """Status of a run in which the correction of positions failed."""
        text = "joints could not be closed nor gaps opened"
        if not self.analysis.integrator.projection:
            text = "joints could not be closed"
        text = f"{text} at t = {t + h:.9g} s ({position}); use a shorter step"
        residual = position.residual * self.model.scales.length
        return Status(Outcome.NOT_CONVERGED, text, t, residual)

    def failure(self, t: float, result: StepResult) -> Status | None:
        """Status of a run whose last step failed; None if it succeeded."""
        impulses = result.impulses
        if not (np.isfinite(result.y).all() and np.isfinite(result.v).all()):
            text = f"no finite state after t = {t:.9g} s; use a shorter step"
            return Status(Outcome.DIVERGED, text, t, np.inf)
        if not impulses.accepted:
            text = (
                f"the impulses of {result.contacts.count} contacts at t = {t:.9g} s did not "
                f"converge (residual {impulses.residual:.3g} m/s after {impulses.rounds} rounds); "
                "with much friction there may be no solution, else give ContactSolver more "
                "max_iterations"
            )
            return Status(Outcome.NOT_CONVERGED, text, t, impulses.residual)
        return None

    def statistics(self, record: ContactRecord, log: StepLog, elapsed: float) -> dict[str, Any]:
        count = max(record.loss.size, 1)
        key = "initial overlaps removed"
        overlaps = {key: self.closed_gaps} if self.closed_gaps else {}
        return overlaps | {
            "integrator": type(self.analysis.integrator).__name__,
            "steps": record.loss.size,
            "integration time [s]": round(elapsed, 6),
            "time per step [ms]": round(1e3 * elapsed / count, 3),
            "maximum active contacts": int(record.pressing.max(initial=0)),
            "proximal iterations": int(record.rounds.sum()),
            "maximum residual [m/s]": float(record.residual.max(initial=0.0)),
            "maximum penetration [m]": float(record.penetration.max(initial=0.0)),
            "energy dissipated in contacts [J]": float(record.loss.sum()),
            "energy dissipated by friction of contacts [J]": log.friction,
            "energy dissipated by the scheme [J]": float(log.scheme_losses[-1]),
            "work of corrections of positions [J]": log.correction_work,
            "maximum energy gained in contacts [J]": float((-record.loss).max(initial=0.0)),
        }


class ContactCheck(ResidualCheck):
    """Check of joints and gaps at the ends of all steps; forces, means over steps, are not checked.

    Parameters
    ----------
    step : ContactStep of the run
    record : ContactRecord of the run
    balance : largest error of the energy, relative to the exchanged energy
    correction_work : work of the corrections of positions [J]
    """

    def __init__(
        self, step: ContactStep, record: ContactRecord, balance: float, correction_work: float = 0.0
    ):
        super().__init__(step.model, record.ends, step.p, (Level.POSITION, Level.SPEED), np.inf)
        self.step, self.record, self.balance = step, record, balance
        self.correction_work = correction_work

    def verify(self, status: Status) -> Status:
        """As of every run; a failure of the first step names an overlap at the start."""
        overlaps = self.record.t.size == 1 and self.deepest.share > DRIFT
        if status.success or not overlaps:
            return super().verify(status)
        return replace(status, message=f"{self.deepest.text}{self.cure(DRIFT)}")

    @property
    def residual(self) -> float:
        """The largest violation of a joint or a gap [m]."""
        joints = self.residuals.violations.max(initial=0.0)
        return float(max(joints, self.record.penetration.max()))

    @cached_property
    def deepest(self) -> Violation:
        """The deepest penetration, by the natural length, except rounding of the start."""
        model, penetration = self.step.model, np.array(self.record.penetration)
        if penetration[0] <= ROUNDED * model.scales.length:
            penetration[0] = 0.0
        k = int(np.argmax(penetration))
        depth = float(penetration[k])
        if depth == 0:
            return Violation(0.0)
        t, none = float(self.record.t[k]), np.zeros((model.equations.speed_count, 1))
        at = self.step.at(t, self.record.ends.y[:, k])
        contacts = self.step.rigid(self.step.near(at, none))
        deepest = int(np.argmin(contacts.distance))
        name, bodies = (
            self.record.names[contacts.owner[deepest]],
            bodies_of(model, contacts, deepest),
        )
        text = f"a gap of {name} is {-depth:.3g} m at t = {t:.9g} s, between {bodies}"
        if k == 0:
            text = f"{bodies} of {name} overlap by {depth:.3g} m at the start"
        return Violation(depth / model.scales.length, text)

    @cached_property
    def energy(self) -> EnergyBalance:
        """Energies at the ends of the steps, and the dissipation of contacts."""
        record = self.record
        energies, natural = self.residuals.energies.copy(), self.step.model.scales.energy
        energies[1] += record.stored
        return EnergyBalance(energies, record.ends.work, record.t, natural)

    @property
    def limit(self) -> float:
        """Largest accepted penetration; larger where the scheme does not correct positions."""
        return EXACT[Level.POSITION] if self.step.scheme.projection else DRIFT

    def cure(self, limit: float) -> str:
        if self.starts_open:
            return "; use a shorter step"
        return "; move them apart by this depth along the normal of the contact"

    @property
    def starts_open(self) -> bool:
        """Whether the deepest penetration is not that of the start."""
        depths = self.record.penetration
        rounded = depths[0] <= ROUNDED * self.step.model.scales.length
        return bool(rounded or depths.max() > depths[0])

    @property
    def objection(self) -> tuple[Outcome, str] | None:
        """Outcome and reason where the run does not count as completed; None otherwise."""
        if violated := super().objection:
            return violated
        if not self.deepest.share <= self.limit:
            text = f"{self.deepest.text}, {self.deepest.share:.2g} of the natural length"
            return Outcome.VIOLATED, text + self.cure(self.limit)
        work = f"corrections of positions did {self.correction_work:.3g} J of work"
        return self.energy.objection(self.balance, f"{work}; use a shorter step")

    @property
    def warnings(self) -> list[str]:
        """Warnings about a run that counts as completed."""
        warnings = self.energy.warnings(self.balance)
        balanced = self.energy.objection(self.balance, "") is None
        if balanced and self.starts_open and not warnings:
            energies = self.correction_work, self.energy.moved
            warnings = lifting_warnings(*energies, self.step.scheme)
        if DRIFT_WARNING < self.deepest.share <= self.limit:
            warnings.append(
                f"{self.deepest.text}: positions are not corrected{self.cure(self.limit)}, "
                "or use projection=True"
            )
        record = self.record
        missed = np.flatnonzero(~record.converged)
        if missed.size:
            worst = missed[np.argmax(record.residual[missed])]
            warnings.append(
                f"in {missed.size} of {record.converged.size} steps the impulses have residuals "
                f"above the tolerance, at most {record.residual[worst]:.2g} m/s at "
                f"t = {record.t[worst]:.9g} s; give ContactSolver a larger tolerance, or a smaller "
                "value of acceptable to end such runs"
            )
        warnings += duration_warnings(record, self.energy.moved)
        if self.step.scheme.anticipates:
            warnings += alternation_warnings(record)
        return [*warnings, *rebound_warnings(self.step, record, self.energy.moved)]
