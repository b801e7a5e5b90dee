"""Kinematic simulation: positions, velocities and accelerations of a driven mechanism.

At each time ``Φ(y, t) = 0``, ``C v = −Φ_t`` and ``C v̇ = ξ`` are solved with one square Jacobian
(1.32–1.41). Each position starts from the Taylor prediction of the one before, and the steps are
short enough for Newton's corrections to stay small against the motion, so the branch is kept.
"""

from __future__ import annotations

import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.critical import Fold, find_fold
from dalembert.analysis.progress import progress_reporter
from dalembert.analysis.timeline import (
    check_driver_laws,
    checked_span,
    checked_step,
    output_times,
    uniform_grid,
)
from dalembert.errors import AnalysisError
from dalembert.model.equations import Equations
from dalembert.model.model import Model
from dalembert.results.motion import EventRecord, Motion, Trajectory
from dalembert.results.status import Outcome, Status
from dalembert.symbolic.factor import QrFactor
from dalembert.symbolic.implicit import ImplicitFunction, Stage
from dalembert.symbolic.kernel import Kernel

ITERATIONS = 5
CHUNK = 200
TOLERANCE = 1e-10
LARGEST_TURN = 0.1
"""Longest correction of a prediction, relative to the scale of the coordinates."""
REGULAR = 1e-5
"""Smallest pivot ratio of a trusted Jacobian: the error of its velocities is ε over its square."""
SMALLEST_FRACTION = 2.0**-30


class KinematicsKernel:
    """Compiled functions of one fully driven model."""

    def __init__(self, model: Model):
        self.model = model
        self.e: Equations = model.equations
        free = model.diagnosis.free
        if free:
            n = "degree" if free == 1 else "degrees"
            raise AnalysisError(
                f"the drivers leave {free} {n} of freedom undetermined; add {free} driver(s), "
                "or use solve_dynamics"
            )

    @cached_property
    def configuration(self) -> ImplicitFunction:
        """``(t, y_near, p) → (y, v, v̇, λ)``, every stage with its exact derivative."""
        e = self.e
        near = ca.SX.sym("y_near", e.coordinate_count)
        c = e.jacobian
        by_y = ca.jacobian(e.constraints, e.y)
        position_factor = QrFactor(by_y)
        factor = QrFactor(c)
        value = near
        for _ in range(ITERATIONS):
            step = position_factor.solve(e.constraints)
            value = value - ca.substitute(step, e.y, value)
        psi0 = ca.substitute(e.velocity_constraints, e.v, ca.SX.zeros(e.speed_count))
        stages = [
            Stage(
                e.y, e.constraints, value, position_factor.solve, position_factor.solve_transposed
            ),
            Stage(
                e.v,
                e.velocity_constraints,
                factor.solve(-psi0),
                factor.solve,
                factor.solve_transposed,
            ),
            Stage(
                e.a,
                ca.mtimes(c, e.a) - e.constraint_acceleration,
                factor.solve(e.constraint_acceleration),
                factor.solve,
                factor.solve_transposed,
            ),
            Stage(
                e.multiplier,
                ca.mtimes(e.mass, e.a) + e.bias - self._force(e) + ca.mtimes(c.T, e.multiplier),
                factor.solve_transposed(self._force(e) - e.bias - ca.mtimes(e.mass, e.a)),
                factor.solve_transposed,
                factor.solve,
            ),
        ]
        return ImplicitFunction(
            "configuration", [e.t, near, e.p], stages, [e.y, e.v, e.a, e.multiplier]
        )

    @staticmethod
    def _force(e: Equations) -> ca.SX:
        return e.force

    def measured(self, measure: ca.SX) -> ImplicitFunction:
        """A measure of the configuration."""
        found = self.configuration
        return ImplicitFunction("measured", found.inputs, found.stages, [measure])

    def near(self, s: Trajectory) -> np.ndarray:
        """Where the configuration is differentiated."""
        return s.y

    @cached_property
    def single(self) -> ca.Function:
        """``([y; v; v̇; …], t, h, p) → next; regularity, residual, prediction error``."""
        e = self.e
        n, m = e.speed_count, e.constraint_count
        last, h = ca.SX.sym("last", 3 * n + m + 3), ca.SX.sym("h")
        y, v, a = last[:n], last[n : 2 * n], last[2 * n : 3 * n]
        predicted = y + h * v + h**2 / 2 * a
        new = self.configuration.function(e.t, predicted, e.p)
        residual = ca.norm_inf(ca.Function("r", [e.t, e.y, e.p], [e.constraints])(e.t, new[0], e.p))
        change = ca.norm_inf(new[0] - predicted)
        pivots = ca.fabs(QrFactor(e.jacobian).pivots)
        regular = ca.mmin(pivots) / ca.mmax(pivots)
        regular = ca.Function("s", [e.t, e.y, e.p], [regular])(e.t, new[0], e.p)
        return ca.Function(
            "kinematic_step",
            [last, e.t, h, e.p],
            [ca.vertcat(*new, regular, residual, change)],
            {"cse": True},
        )

    def chunk(self, count: int) -> Kernel:
        """``count`` steps in one call."""

        def make() -> Kernel:
            last = ca.MX.sym("last", self.single.size1_in(0))
            t, h = ca.MX.sym("t", 1, count), ca.MX.sym("h", 1, count)
            p = ca.MX.sym("p", self.e.p.numel())
            out = self.single.mapaccum(count)(last, t, h, ca.repmat(p, 1, count))
            return Kernel(ca.Function("kinematic_chunk", [last, t, h, p], [out]))

        return self.model.compiled(("kinematic_chunk", count), make)

    @cached_property
    def jacobian(self) -> ca.Function:
        """``(t, y, p) → Φ, ∂Φ/∂y, ∂Φ/∂t``."""
        e = self.e
        return ca.Function(
            "driven",
            [e.t, e.y, e.p],
            [e.constraints, ca.jacobian(e.constraints, e.y), ca.jacobian(e.constraints, e.t)],
        )


@dataclass(frozen=True)
class KinematicsRecord:
    """What a gradient needs: the kernel; each output stands for itself."""

    kernel: KinematicsKernel


class _Run:
    """One execution of a kinematic analysis."""

    def __init__(self, analysis: Kinematics, model: Model, parameters):
        self.analysis, self.model = analysis, model
        self.p = parameters if isinstance(parameters, np.ndarray) else model.values(parameters)
        self.start, self.end = checked_span(analysis.duration, analysis.t_span)
        requested = output_times(analysis.outputs, self.start, self.end)
        step = checked_step(analysis.step, self.start, self.end)
        grid = uniform_grid(self.start, self.end, step)
        self.grid = grid if requested is None else np.union1d(grid, requested)
        self.requested = grid if requested is None else requested
        self.kernel = model.compiled("kinematics", lambda: KinematicsKernel(model))
        check_driver_laws(model, self.grid, self.p)
        self.typical = min(step, float(np.median(np.diff(self.grid))))
        self.n = model.equations.coordinate_count
        self.fold: Fold | None = None
        self.substeps = 0
        self.message, self.interrupted = "", False

    def execute(self, progress) -> Motion:
        begin = clock.perf_counter()
        first = self.first_configuration()
        with progress_reporter(progress, f"moving {self.model.name}") as report:
            times, table = self.march(first, report)
        keep = np.isin(times, self.requested)
        trajectory = self.trajectory(times, table, keep)
        events = self.branch_points(times, table)
        if self.fold is not None:
            events.append(EventRecord("dead centre", self.fold.time))
        statistics = {
            "positions": int(keep.sum()),
            "steps": int(times.size - 1),
            "substeps": self.substeps,
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
            KinematicsRecord(self.kernel),
        )

    def first_configuration(self) -> np.ndarray:
        state = self.model.assemble(self.p, self.start)
        column = np.zeros(self.kernel.single.size1_in(0))
        column[: self.n] = state.y
        first = self.kernel.single(column, self.start, 0.0, self.p).full().ravel()
        if not np.all(np.isfinite(first)) or first[-3] < REGULAR * 1e-3:
            raise AnalysisError(
                f"at t = {self.start:g} s the mechanism stands in a singular position (dead centre "
                "or branch point): its velocities are not determined; begin at another time"
            )
        return first

    # marching ----------------------------------------------------------------------
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
                    bridge = self.bridge(
                        columns, times, float(self.grid[done]), float(self.grid[done + 1])
                    )
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
        """Steps that converged with a correction small against the motion of the step."""
        regular, residual, change = table[-3, 1:], table[-2, 1:], table[-1, 1:]
        moved = np.abs(np.diff(table[: self.n], axis=1)).max(axis=0)
        finite = np.all(np.isfinite(table[:, 1:]), axis=0)
        small = change <= np.maximum(LARGEST_TURN * moved, 1e-9)
        with np.errstate(invalid="ignore"):
            sound = finite & (residual < TOLERANCE) & (regular > REGULAR)
            return sound & (small | (change < 1e-3 * np.abs(h)))

    def bridge(self, columns, times, low: float, high: float) -> np.ndarray | None:
        """Cross a difficult interval; None where the motion ends."""
        last = next(c for c in reversed(columns) if c.size)[:, -1]
        crossed = self.cross(last, low, high)
        if crossed is not None:
            return crossed
        now, h, span = low, high - low, high - low
        while now < high:
            target = high if now + h >= high - 1e-15 else now + h
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
        """Configuration at ``high`` where just this instant is a branch point.

        The motion is smooth there but the Jacobian singular: step a little over it and
        interpolate, which is exact to the fourth power of that little.
        """
        for fraction in (0.1, 0.5, 0.02):
            little = fraction * self.typical
            if little > high - low:
                continue
            after = self.advance(last, low, high + little)
            before = self.advance(last, low, high - little)
            if after is not None and before is not None:
                return self.between(before, after, 2 * little)
        return None

    def between(self, before: np.ndarray, after: np.ndarray, gap: float) -> np.ndarray:
        n = self.n
        middle = (before + after) / 2
        for low in (0, n):  # positions, then speeds: cubic Hermite at the middle
            rate = slice(low + n, low + 2 * n)
            middle[low : low + n] += gap / 8 * (before[rate] - after[rate])
        return middle

    def end_of_motion(self, last: np.ndarray, now: float) -> None:
        y = last[: self.n]
        self.fold = find_fold(self.kernel.jacobian, now, y, self.p)
        if self.fold is not None:
            self.message = (
                f"dead centre at t = {self.fold.time:.9g} s: beyond it no position satisfies the "
                "drivers"
            )
        else:
            self.message = f"no continuous position was found after t = {now:.9g} s"

    # what was found ----------------------------------------------------------------
    def branch_points(self, times: np.ndarray, table: np.ndarray) -> list[EventRecord]:
        """Times at which the Jacobian's determinant changes sign: branches meet there."""
        if times.size < 2 or self.n > 400:
            return []
        mapped = self.kernel.jacobian.map(times.size)
        p = np.tile(self.p[:, None], times.size)
        flat = np.asarray(mapped(times, table[: self.n], p)[1].full())
        stack = flat.reshape(self.n, times.size, self.n).transpose(1, 0, 2)
        signs = np.linalg.slogdet(stack)[0]
        found = []
        for k in np.flatnonzero(signs[:-1] * signs[1:] < 0):
            found.append(EventRecord("branch point", self.locate_branch(times, table, int(k))))
        return found

    def locate_branch(self, times: np.ndarray, table: np.ndarray, k: int) -> float:
        low, high = times[k], times[k + 1]
        sign = None
        for _ in range(60):
            middle = (low + high) / 2
            new = self.kernel.single(table[:, k], middle, middle - times[k], self.p).full().ravel()
            jac = self.kernel.jacobian(middle, new[: self.n], self.p)[1].full()
            if not np.all(np.isfinite(jac)):
                break
            here = np.linalg.slogdet(jac)[0]
            if sign is None:
                base = self.kernel.jacobian(times[k], table[: self.n, k], self.p)[1].full()
                sign = np.linalg.slogdet(base)[0]
            low, high = (middle, high) if here == sign else (low, middle)
            if high - low < 1e-12:
                break
        return float((low + high) / 2)

    def trajectory(self, times: np.ndarray, table: np.ndarray, keep: np.ndarray) -> Trajectory:
        n, m = self.n, self.model.equations.constraint_count
        rows = table[:, keep]
        multiplier = rows[3 * n : 3 * n + m]
        if not self.analysis.efforts:
            multiplier = np.full_like(multiplier, np.nan)
        work = self.work(times, table)[:, keep]
        return Trajectory(
            times[keep], rows[:n], rows[n : 2 * n], rows[2 * n : 3 * n], multiplier, work
        )

    def work(self, times: np.ndarray, table: np.ndarray) -> np.ndarray:
        """Energy dissipated and put in, by integrating the powers over the positions computed."""
        if not self.analysis.efforts:
            return np.full((2, times.size), np.nan)
        if times.size < 2:
            return np.zeros((2, times.size))
        from scipy.integrate import cumulative_simpson

        e, n, m = self.model.equations, self.n, self.model.equations.constraint_count
        function = self.model.compiled(
            "powers",
            lambda: ca.Function("powers", [e.t, e.y, e.v, e.a, e.multiplier, e.p], [e.powers]),
        )
        powers = function.map(times.size)(
            times,
            table[:n],
            table[n : 2 * n],
            table[2 * n : 3 * n],
            table[3 * n : 3 * n + m],
            np.tile(self.p[:, None], times.size),
        ).full()
        return cumulative_simpson(powers, x=times, axis=1, initial=0.0)

    def status(self, s: Trajectory, table: np.ndarray) -> Status:
        residual = float(np.nanmax(table[-2])) if table.size else 0.0
        time = float(s.t[-1]) if s.t.size else self.start
        if self.interrupted:
            return Status(Outcome.INTERRUPTED, f"stopped at t = {time:g} s", time, residual)
        if self.fold is not None:
            return Status(Outcome.LOCKED, self.message, time, residual)
        if self.message:
            return Status(Outcome.SINGULAR, self.message, time, residual)
        return Status(Outcome.COMPLETED, f"reached t = {time:g} s", time, residual)


@dataclass(frozen=True)
class Kinematics:
    """Kinematic simulation as a strategy object.

    Parameters
    ----------
    duration : length of the run from t = 0 [s]; this or ``t_span``
    t_span : (start, end) of the run [s]
    step : time between positions, by default a thousandth of the run [s]
    outputs : number of equally spaced times, or the times [s]; default every step
    """

    duration: float | None = None
    step: float | None = None
    outputs: int | Sequence[float] | None = None
    t_span: tuple[float, float] | None = None

    @property
    def efforts(self) -> bool:
        """Whether multipliers are part of the result."""
        return False

    def run(
        self,
        model: Model,
        parameters: Mapping[str, float] | np.ndarray | None = None,
        progress: bool | Callable[[float], None] = False,
    ) -> Motion:
        """Move the mechanism; where it locks, keep what was found and say when.

        Raises
        ------
        AnalysisError
            The mechanism is not fully driven, or a wrong step, duration or outputs.
        AssemblyError
            It cannot be assembled at the start.
        """
        return _Run(self, model, parameters).execute(progress)

    def resample(self, motion: Motion, times: np.ndarray) -> Motion:
        """The motion at other times, each reached from the nearest one computed."""
        s = motion.trajectory
        nearest = np.abs(s.t[None, :] - times[:, None]).argmin(axis=1)
        ahead = times - s.t[nearest]
        near = s.y[:, nearest] + ahead * s.v[:, nearest] + ahead**2 / 2 * s.a[:, nearest]
        return self.solve_at(motion, times, near, motion.parameters)

    def replay(self, motion: Motion, p: np.ndarray) -> Motion:
        """The same instants at other parameter values, on the same branch."""
        return self.solve_at(motion, motion.time, motion.trajectory.y, p)

    def solve_at(
        self, motion: Motion, times: np.ndarray, near: np.ndarray, p: np.ndarray
    ) -> Motion:
        """Configurations at given times near given positions."""
        function = motion.record.kernel.configuration.function
        parts = function.map(times.size)(times, near, np.tile(p[:, None], times.size))
        y, v, a, multiplier = (part.full() for part in parts)
        if not self.efforts:
            multiplier = np.full_like(multiplier, np.nan)
        work = np.full((2, times.size), np.nan)
        if self.efforts and motion.time.size > 3:
            from scipy.interpolate import CubicSpline

            work = CubicSpline(motion.time, motion.trajectory.work, axis=1)(times)
        trajectory = Trajectory(times, y, v, a, multiplier, work)
        return replace(motion, parameters=p, trajectory=trajectory)


def solve_kinematics(
    model: Model,
    duration: float | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    progress: bool | Callable[[float], None] = False,
    **options: Any,
) -> Motion:
    """Positions, velocities and accelerations of a driven mechanism over time (Fig. 1.12).

    Parameters
    ----------
    model : fully driven Model; masses are not needed
    duration : [s]
    parameters : new values of parameters, without rebuilding
    progress : True for a bar, or a function of the fraction done
    **options : fields of ``Kinematics``: step, outputs, t_span

    Raises
    ------
    AnalysisError
        Not fully driven, a singular start, or wrong options; ``AssemblyError`` where the mechanism
        cannot be put together.
    """
    try:
        analysis = Kinematics(duration=duration, **options)
    except TypeError as error:
        raise AnalysisError(f"solve_kinematics: {error}") from None
    return analysis.run(model, parameters, progress)
