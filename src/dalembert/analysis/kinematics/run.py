"""Execution of a kinematic analysis on one branch, up to its end or a dead centre."""

from __future__ import annotations

import time as clock
from itertools import pairwise
from typing import Any

import numpy as np

from dalembert.analysis.contact.gap_checks import ignored_contacts
from dalembert.analysis.elastic_range import elastic_warnings
from dalembert.analysis.kinematics.kernel import KinematicsRecord, kinematics_kernel
from dalembert.analysis.kinematics.singularities import BranchPoints, Fold, find_fold
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.requirements import constant_states, refuse_moving_states
from dalembert.analysis.residual_check import MOTION, ResidualCheck
from dalembert.analysis.singular_positions import SingularPosition
from dalembert.analysis.timeline import (
    afford_states,
    check_driver_laws,
    run_times,
    uniform_grid,
)
from dalembert.errors import AnalysisError
from dalembert.model.graph.assembly.regularity import left_ahead
from dalembert.model.graph.model import Model
from dalembert.results.motion import Motion
from dalembert.results.recording import EventRecord, Trajectory
from dalembert.results.status import Outcome, Status, reached, stopped

CHUNK = 200
"""Number of steps per call."""
NEAR = 1e-9
"""Difference of times, in steps, below which they are equal."""
LOOK = 1e-3
"""Share of the run before and after its end that is searched for ends of tables."""
TOLERANCE = 1e-10
"""Tolerance of the constraints, relative to the natural sizes of the equations."""
LARGEST_TURN = 0.1
"""Upper limit of the correction of a prediction, relative to the motion of the step."""
SMALL_TURN = 1e-9, 1e-3
"""Corrections that are always accepted: in natural sizes, and per share of the run."""
REGULAR = 1e-5
"""Smallest pivot ratio of a trusted Jacobian: the error of its velocities is ε over its square."""
SMALLEST_FRACTION = 2.0**-30
"""Shortest substep, relative to the step."""
COARSE_STEPS = 64
"""Number of steps of a first pass that determines the number of steps."""
STEP_DISPLACEMENT = 0.1
"""Largest displacement per step, in natural sizes (angles in radians)."""


class KinematicsRun:
    """One execution of a kinematic analysis.

    Parameters
    ----------
    analysis : strategy object with the fields of ``Kinematics``
    model : Model
    parameters : new values, or the whole vector
    """

    def __init__(self, analysis: Any, model: Model, parameters):
        self.analysis, self.model = analysis, model
        refuse_moving_states(model)
        self.p = model.values(parameters)
        self.start, self.end, step, requested = run_times(analysis)
        self.chosen = requested is not None and analysis.step is None and not analysis.efforts
        grid = uniform_grid(self.start, self.end, step)
        e = model.equations
        n = e.speed_count  # matrices of all instants are solved at once
        afford_states(grid.size, 11 * (e.coordinate_count + 2 * n) + 6 * n * n)
        if requested is not None:  # snap times to the grid
            near = grid[np.clip(np.searchsorted(grid, requested - step / 2), 0, grid.size - 1)]
            requested = np.where(abs(near - requested) < NEAR * step, near, requested)
        self.grid = grid if requested is None else np.union1d(grid, requested)
        self.requested = grid if requested is None else requested
        self.kernel = kinematics_kernel(model)
        check_driver_laws(model, self.grid, self.p)
        self.typical = min(step, float(np.median(np.diff(self.grid))))
        self.n, self.sizes = e.coordinate_count, e.scales
        self.manifold = e.manifold
        ends = np.cumsum([0, self.n, e.speed_count, e.speed_count, e.constraint_count])
        self.parts = [slice(*pair) for pair in pairwise(ends)]
        self.fold: Fold | None = None
        self.substeps = 0
        self.message, self.table_end, self.interrupted = "", "", False

    def execute(self, progress) -> Motion:
        begin = clock.perf_counter()
        first = self.first_configuration()
        if self.chosen:
            self.shorten(first)
        with progress_reporter(progress, f"moving {self.model.name}") as report:
            times, table = self.march(first, report)
        path = self.trajectory(times, table)
        trajectory = path.some(np.isin(times, self.requested))
        branches = BranchPoints(self.kernel, self.p, times, table)
        events = [self.singular("branch point", *branch_point) for branch_point in branches]
        if self.fold is not None:
            events.append(self.singular("dead centre", self.fold.time, self.fold.y))
        statistics = {
            "positions": trajectory.t.size,
            "steps": int(times.size - 1),
            "substeps": self.substeps,
            "build time [s]": round(self.model.build_time, 6),
            "computation time [s]": round(clock.perf_counter() - begin, 6),
        }
        return Motion(
            self.model,
            self.analysis,
            self.p,
            trajectory,
            self.status(trajectory, table),
            statistics,
            sorted(events, key=lambda e: e.time),
            warnings=[
                *ignored_contacts(self.model, trajectory, self.p, self.analysis.efforts),
                *elastic_warnings(self.model, trajectory, self.p),
                *constant_states(self.model),
            ],
            record=KinematicsRecord(self.kernel, path),
        )

    def first_configuration(self) -> np.ndarray:
        state = self.model.assemble(self.p, self.start)
        column = np.zeros(self.kernel.single.size1_in(0))
        column[: self.n] = state.y
        first = self.kernel.single(column, self.start, 0.0, self.p).full().ravel()
        if not np.all(np.isfinite(first)) or first[-3] < REGULAR * 1e-3:
            there = SingularPosition(self.model, self.start, state.y, self.p)
            raise AnalysisError(
                f"at t = {self.start:g} s the mechanism stands in a singular position (dead centre "
                f"or branch point){there.drivers}: {there.joints} lose their independence there "
                "and velocities are not determined; begin at another time"
            )
        return first

    # marching ----------------------------------------------------------------------
    def shorten(self, first: np.ndarray) -> None:
        """Reduce the number of steps according to the displacements, if few outputs are requested.

        Uses a coarse first pass; the grid is unchanged if one of its steps is not trusted.
        """
        times = np.linspace(self.start, self.end, COARSE_STEPS + 1)
        h = np.diff(times)
        (out,) = self.kernel.chunk(COARSE_STEPS)(first, times[1:], h, self.p)
        table = np.column_stack([first, out])
        if not self.trusted(table, h).all():
            return
        largest = self.displacements(table).max(initial=0.0)
        count = max(COARSE_STEPS, int(np.ceil(COARSE_STEPS * largest / STEP_DISPLACEMENT)))
        if count + self.requested.size < self.grid.size:
            uniform = np.linspace(self.start, self.end, count + 1)
            self.grid = np.union1d(uniform, self.requested)

    def march(self, first: np.ndarray, report) -> tuple[np.ndarray, np.ndarray]:
        columns, times, done = [first.reshape(-1, 1)], [self.grid[:1]], 0
        h = np.diff(self.grid)
        try:
            while done < h.size:
                count = min(CHUNK, h.size - done)
                part = slice(done, done + count)
                (out,) = self.kernel.chunk(count)(
                    columns[-1][:, -1], self.grid[part] + h[part], h[part], self.p
                )
                good = self.trusted(np.hstack([columns[-1][:, -1:], out]), h[part])
                valid = count if good.all() else int(np.argmin(good))
                columns.append(out[:, :valid])
                times.append(self.grid[done + 1 : done + 1 + valid])
                done += valid
                if valid < count:
                    low, high = map(float, self.grid[done : done + 2])
                    bridge = self.bridge(columns, low, high)
                    if bridge is None:
                        break
                    columns.append(bridge.reshape(-1, 1))
                    times.append(self.grid[done + 1 : done + 2])
                    done += 1
                report(done / h.size)
        except KeyboardInterrupt:
            self.message, self.interrupted = "interrupted", True
        return np.concatenate(times), np.hstack([c for c in columns if c.size])

    def trusted(self, table: np.ndarray, h: np.ndarray) -> np.ndarray:
        """Steps that converged with a correction smaller than the motion of the step."""
        regular, residual, change = table[-3, 1:], table[-2, 1:], table[-1, 1:]
        displacements = self.displacements(table)
        finite = np.all(np.isfinite(table[:, 1:]), axis=0)
        always, share = SMALL_TURN
        small = np.maximum(always, share * np.abs(h) / (self.end - self.start))
        with np.errstate(invalid="ignore"):
            converged = finite & (residual < TOLERANCE) & (regular > REGULAR)
            return converged & (change <= np.maximum(LARGEST_TURN * displacements, small))

    def displacements(self, table: np.ndarray) -> np.ndarray:
        """(k,) largest displacement of each step, in natural sizes."""
        y = table[: self.n]
        relative = self.manifold.lead(y[:, :-1], y[:, 1:]) / self.sizes.displacements[:, None]
        return np.abs(relative).max(axis=0, initial=0.0)

    def bridge(self, columns, low: float, high: float) -> np.ndarray | None:
        """Cross a difficult interval by substeps; None if the motion ends."""
        last = next(c for c in reversed(columns) if c.size)[:, -1]
        crossed = self.cross(last, low, high)
        if crossed is not None:
            return crossed
        now, h, span = low, high - low, high - low
        while now < high:
            target = high if now + h >= high - SMALLEST_FRACTION * span else now + h
            new = self.advance(last, now, target)
            if new is not None:
                last, now, h = new, target, 2 * h
                self.substeps += 1
                continue
            h /= 2
            if h < SMALLEST_FRACTION * span:
                self.end_of_motion(last, now)
                return None
        return last

    def advance(self, last: np.ndarray, now: float, target: float) -> np.ndarray | None:
        """The configuration at ``target`` if it is a trusted continuation, else None."""
        new = self.kernel.single(last, target, target - now, self.p).full().ravel()
        trusted = self.trusted(np.column_stack([last, new]), np.array([target - now]))[0]
        return new if trusted else None

    def cross(self, last: np.ndarray, low: float, high: float) -> np.ndarray | None:
        """Configuration at ``high`` if this instant is a branch point.

        The motion is smooth there but the Jacobian is singular: interpolate between positions
        shortly before and after, with an error of fourth order in their distance. Where the
        Jacobian is regular, as at a knot of a driver law, the constraints correct the result.
        """
        for fraction in (0.1, 0.5, 0.02):
            offset = fraction * self.typical
            if offset > high - low:
                continue
            after = self.advance(last, low, high + offset)
            before = self.advance(last, low, high - offset)
            if after is not None and before is not None:
                return self.corrected(before, after, 2 * offset, high)
        return None

    def corrected(
        self, before: np.ndarray, after: np.ndarray, gap: float, time: float
    ) -> np.ndarray:
        """The interpolation between two positions, corrected if the Jacobian is regular."""
        middle = self.between(before, after, gap)
        displacement = self.displacements(np.column_stack([before, after]))[0]
        new = self.kernel.single(middle, time, 0.0, self.p).full().ravel()
        regular, residual, change = new[-3:]
        converged = np.all(np.isfinite(new)) and regular > REGULAR and residual < TOLERANCE
        return new if converged and change <= LARGEST_TURN * displacement else middle

    def between(self, before: np.ndarray, after: np.ndarray, gap: float) -> np.ndarray:
        """Middle between two positions by cubic Hermite polynomials of positions and speeds."""
        middle = (before + after) / 2
        y, v, a, _ = self.parts
        bend = gap / 8 * (before - after)
        half = self.manifold.lead(before[y], after[y]) / 2
        middle[y] = self.manifold.go(before[y], half + bend[v])
        middle[v] += bend[a]
        return middle

    def end_of_motion(self, last: np.ndarray, now: float) -> None:
        y = last[: self.n]
        self.fold = find_fold(self.kernel, now, y, self.p, self.typical)
        if self.fold is not None:
            there = SingularPosition(self.model, self.fold.time, self.fold.y, self.p)
            self.message = (
                f"dead centre at t = {self.fold.time:.9g} s{there.drivers}: beyond it no position "
                f"satisfies the drivers; joints at their limit: {there.stretched}"
            )
        else:
            there = SingularPosition(self.model, now, y, self.p)
            self.message = f"no continuous position was found after t = {now:.9g} s{there.drivers}"
            v, model = last[self.parts[1]], self.model
            back = LOOK * float(np.ptp(self.grid))
            self.table_end = left_ahead(model.parts, model.all_equations, now, (y, v), back, self.p)
            self.message = self.table_end or self.message

    # results ----------------------------------------------------------------
    def singular(self, name: str, time: float, y: np.ndarray) -> EventRecord:
        """Event at a position with undetermined speeds."""
        return EventRecord(name, time, 0, y, np.full(self.model.equations.speed_count, np.nan))

    def trajectory(self, times: np.ndarray, table: np.ndarray) -> Trajectory:
        y, v, a, effort = self.parts
        multiplier = self.model.all_multipliers(table[effort])
        if not self.analysis.efforts:
            multiplier = np.full_like(multiplier, np.nan)
        return Trajectory(times, table[y], table[v], table[a], multiplier, self.work(times, table))

    def work(self, times: np.ndarray, table: np.ndarray) -> np.ndarray:
        """Dissipated and input energy by integration of the powers over all positions."""
        if not self.analysis.efforts:
            return np.full((2, times.size), np.nan)
        if times.size < 2:
            return np.zeros((2, times.size))
        from scipy.integrate import cumulative_simpson

        p, columns = np.tile(self.p[:, None], times.size), (table[part] for part in self.parts)
        powers = self.kernel.powers.map(times.size)(times, *columns, p).full()
        return cumulative_simpson(powers, x=times, axis=1, initial=0.0)

    def status(self, s: Trajectory, table: np.ndarray) -> Status:
        residual = float(np.nanmax(table[-2])) * self.sizes.length if table.size else 0.0
        time = float(s.t[-1]) if s.t.size else self.start
        if self.interrupted:
            return stopped(time, residual)
        if self.message:
            ended = Outcome.LOCKED if self.fold else Outcome.SINGULAR
            ended = Outcome.DIVERGED if self.table_end else ended
            return Status(ended, self.message, time, residual)
        forces = MOTION if self.analysis.efforts else np.inf
        return ResidualCheck(self.model, s, self.p, motion=forces).verify(reached(time, residual))
