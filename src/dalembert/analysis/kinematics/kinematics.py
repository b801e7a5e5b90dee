"""Kinematic simulation: positions, velocities and accelerations of a driven mechanism.

At each time ``Φ(y, t) = 0``, ``C v = −Φ_t`` and ``C v̇ = ξ`` are solved with one square Jacobian
(1.32–1.41). Each position starts from the Taylor prediction of the previous one. Steps are so short
that Newton's corrections remain small relative to the motion, which stays on its branch.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Unpack, overload

import numpy as np

from dalembert.analysis.batch.kinematics_batch import KinematicsBatch
from dalembert.analysis.batch.solve import run_analysis
from dalembert.analysis.events import Occurrence, locate, locate_again
from dalembert.analysis.keywords import OverTimeKeywords
from dalembert.analysis.kinematics.run import TOLERANCE, KinematicsRun
from dalembert.analysis.timeline import OverTime
from dalembert.analysis.times import Time, analysis_of
from dalembert.errors import AnalysisError
from dalembert.model.graph.model import Model
from dalembert.options import options
from dalembert.results.batch.batch import Batch
from dalembert.results.live import LiveFunctions
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.results.sources import Row
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once
from dalembert.text.arguments import check_arguments

if TYPE_CHECKING:
    from dalembert.results.batch.designs import ManyDesigns


@options
class Kinematics(OverTime[Motion]):
    """Kinematic simulation as a strategy object.

    Parameters
    ----------
    step : time between positions [s]; by default a thousandth of the run, or, with outputs and
        without efforts, the longest step with displacements below a tenth of a radian

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("crank")
    >>> r = system.parameter("r", 0.1, unit="m", bounds=(0.05, 0.2))
    >>> crank = system.add(planar.Bar("crank", length=r))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, crank.start))
    >>> motor = system.add(planar.RotationalDriver("motor", system.ground, crank, 10 * da.t))
    >>> motion = da.Kinematics(duration=0.1, step=0.05).run(system.build(), {"r": 0.2})
    >>> motion["crank.end.speed"].values.round(6)  # r ω
    array([2., 2., 2.])
    """

    display_name = "kinematics"
    kinds = ("mechanism",)
    instead = "use solve_statics"
    executions = {"mechanism": KinematicsRun}
    batched = KinematicsBatch

    @property
    def efforts(self) -> bool:
        """Whether multipliers are part of the result."""
        return False

    def live_obstacle(self, result: Motion) -> str:
        from dalembert.analysis.live.kinematics_module import obstacle

        return obstacle(result)

    def live_functions(
        self, result: Motion, rows: Sequence[Row], times: np.ndarray
    ) -> LiveFunctions:
        from dalembert.analysis.live.kinematics_module import kinematics_functions

        return kinematics_functions(result, rows, times)

    def resample(self, motion: Motion, times: np.ndarray) -> Motion:
        """The motion at other times, each computed from the nearest position of the run.

        Raises
        ------
        AnalysisError
            A time is outside the run, or needs shorter steps.
        """
        if motion.record.origin is not None:
            near = self.resample(motion.record.origin, times).trajectory.y
            return self.solve_at(motion, times, near, motion.parameters)
        s = motion.record.path
        refuse_outside(times, s.t)
        nearest = np.searchsorted((s.t[1:] + s.t[:-1]) / 2, times)
        delay = times - s.t[nearest]
        displacement = delay * s.v[:, nearest] + delay**2 / 2 * s.a[:, nearest]
        near = motion.model.equations.manifold.go(s.y[:, nearest], displacement)
        return self.solve_at(motion, times, near, motion.parameters)

    def replay(self, motion: Motion, p: np.ndarray) -> Motion:
        """The same instants at other parameter values, on the same branch.

        Raises
        ------
        AnalysisError
            The values differ too much.
        """
        repeated = self.solve_at(motion, motion.time, motion.trajectory.y, p)
        repeated.record = replace(motion.record, origin=motion)
        return repeated

    def at_event(self, motion: Motion, occurrence: Occurrence) -> Motion:
        """The motion at the instant of an event, located between the positions of the run.

        Raises
        ------
        AnalysisError
            A name instead of an Event, or fewer occurrences.
        """
        return self.resample(motion, np.array([driven_instant(motion, occurrence)]))

    def solve_at(
        self, motion: Motion, times: np.ndarray, near: np.ndarray, p: np.ndarray
    ) -> Motion:
        """Configurations at given times near given positions.

        Raises
        ------
        AnalysisError
            No configuration exists so near.
        """
        function = motion.record.kernel.configuration.function
        values = np.tile(p[:, None], times.size)
        y, v, a, multiplier = Kernel(function.map(times.size))(times, near, values)
        violation = motion.record.kernel.jacobian.map(times.size)(times, y, values)[0].full()
        sizes = motion.model.equations.scales.rows
        refuse_open(times, np.abs(violation / sizes[:, None]).max(axis=0, initial=0.0))
        multiplier = motion.model.all_multipliers(multiplier)
        if not self.efforts:
            multiplier = np.full_like(multiplier, np.nan)
        work = np.full((2, times.size), np.nan)
        path = motion.record.path
        if self.efforts and path.t.size > 3:
            from scipy.interpolate import CubicSpline

            work = CubicSpline(path.t, path.work, axis=1)(times)
        trajectory = Trajectory(times, y, v, a, multiplier, work)
        return replace(motion, parameters=p, trajectory=trajectory)


@overload
def solve_kinematics(
    model: Model,
    duration: Time | None = None,
    *,
    parameters: Mapping[str, float] | None = None,
    progress: bool | Callable[[float], None] = False,
    **options: Unpack[OverTimeKeywords],
) -> Motion: ...


@overload
def solve_kinematics(
    model: Model,
    duration: Time | None = None,
    *,
    parameters: ManyDesigns,
    progress: bool | Callable[[float], None] = False,
    workers: int | None = None,
    **options: Unpack[OverTimeKeywords],
) -> Batch: ...


@check_arguments
def solve_kinematics(
    model: Model,
    duration: Time | None = None,
    *,
    parameters: Any = None,
    progress: bool | Callable[[float], None] = False,
    workers: int | None = None,
    **options: Unpack[OverTimeKeywords],
) -> Motion | Batch:
    """Positions, velocities and accelerations of a driven mechanism over time (Fig. 1.12).

    Parameters
    ----------
    model : fully driven Model; masses are not needed
    duration : [s]
    parameters : new values of parameters, without rebuilding; arrays of them, a table or a list
        of dicts for a batch
    progress : True for a progress bar, or a function of the completed fraction
    workers : number of workers of a batch, by default one for each core
    **options : fields of ``Kinematics``: step, outputs, t_span

    Raises
    ------
    AnalysisError
        Not fully driven, a singular start, or wrong options; ``AssemblyError`` where the mechanism
        cannot be assembled.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("slider-crank")
    >>> crank = system.add(planar.Bar("crank", length=0.1))
    >>> rod = system.add(planar.Bar("rod", length=0.3))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, crank.start))
    >>> pin = system.add(planar.Revolute("A", crank.end, rod.start))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, rod.end))
    >>> motor = system.add(planar.RotationalDriver("motor", system.ground, crank, da.t))
    >>> motion = da.solve_kinematics(system.build(), "pi", step="pi")
    >>> motion["rod.end.x"].values.round(6)  # dead centres: l + r, l - r
    array([0.4, 0.2])
    """
    analysis = analysis_of(
        Kinematics, "solve_kinematics", model, parameters, duration=duration, **options
    )
    return run_analysis(analysis, model, parameters, progress, workers)  # type: ignore[no-any-return]


def refuse_outside(times: np.ndarray, run: np.ndarray) -> None:
    """Refuse times outside a run."""
    slack = 1e-12 * max(abs(run[0]), abs(run[-1]))
    inside = (times >= run[0] - slack) & (times <= run[-1] + slack)
    if not inside.all():
        raise AnalysisError(
            f"t = {times[~inside][0]:g} s is outside the run {run[0]:g}…{run[-1]:g} s"
        )


def refuse_open(times: np.ndarray, residual: np.ndarray) -> None:
    """Refuse positions that violate the constraints."""
    violated = ~(residual < TOLERANCE)
    if violated.any():
        raise AnalysisError(
            f"no position was found at t = {times[violated][0]:.9g} s near the previous one "
            f"(relative residual {residual[violated][0]:.2g}); use shorter steps",
            float(residual[violated][0]),
        )


@once
def driven_instant(motion: Motion, occurrence: Occurrence) -> float:
    """Time of an event [s], located between the positions of the run.

    Raises
    ------
    AnalysisError
        The event is a name, or has fewer occurrences.
    """
    event = occurrence.declared({})
    measure = motion.model.expression(event.measure)

    def value(time: float) -> float:
        return float(motion.at(np.array([time])).values(measure)[0])

    def rate(time: float) -> float:
        return measure_rate(motion.at(np.array([time])), measure)

    if motion.record.origin is not None:
        original = driven_instant(motion.record.origin, occurrence)
        span = float(np.ptp(motion.record.path.t))
        return locate_again(value, rate, original, str(occurrence), span)
    path = replace(motion, trajectory=motion.record.path)
    k = occurrence.among(event.crossings(path.values(measure)).tolist())
    return locate(value, float(path.time[k]), float(path.time[k + 1]))


def measure_rate(motion: Motion, measure: Expression, k: int = -1) -> float:
    """``ṁ`` at the ``k``-th instant, the total derivative along the driven motion."""
    s, p = motion.trajectory, motion.parameters
    y = motion.record.kernel.near(s)[:, k]
    tangent = motion.record.kernel.measured(measure).tangent
    return float(tangent(s.t[k], y, p, 1.0, np.zeros(y.size), np.zeros(p.size)))
