"""Trajectory optimisation: simultaneous search for controls, motion and dimensions.

``min J(x(t), u(t), p, T)`` subject to the equations of motion, path constraints and boundary
conditions (Betts 2010; Kelly, *An introduction to trajectory optimization*, SIAM Review 2017).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.analysis.requirements import need_mechanism
from dalembert.design.limit import Limit
from dalembert.design.methods.search_options import OnIteration, iteration_callback
from dalembert.design.quantity import Objective
from dalembert.design.trajectory.collocation import DirectCollocation
from dalembert.design.trajectory.control import Control
from dalembert.design.trajectory.guess import Guess, from_plan, initial_guess
from dalembert.design.trajectory.ipopt import Programme, Solution
from dalembert.design.trajectory.method import TrajectoryMethod
from dalembert.design.trajectory.physics import Physics, speed_basis
from dalembert.design.trajectory.quantities import (
    Conditions,
    check_conditions,
    condition_rows,
    cyclic_rows,
    limit_rows,
    response_value,
    unit_of,
)
from dalembert.design.trajectory.trajectory_result import TrajectoryResult
from dalembert.design.trajectory.transcription import Rows, Transcription
from dalembert.design.trajectory.verification import (
    REFINEMENTS,
    ROUGHNESS_WEIGHT,
    agrees,
    exploits_nodes,
    roughness,
    verify_plan,
    with_final_status,
)
from dalembert.errors import AnalysisError
from dalembert.interrupts import interruptible
from dalembert.model.graph.model import Model
from dalembert.model.graph.scheduled import ScheduledModel
from dalembert.options import is_number
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.results.status import Status
from dalembert.text.wording import unknown


@interruptible
def optimize_trajectory(
    model: Model,
    minimize: Objective,
    controls: Sequence[str],
    duration: float | tuple[float, float],
    *,
    begin: Conditions | None = None,
    end: Conditions | None = None,
    cyclic: Sequence[str] = (),
    subject_to: Sequence[Limit] = (),
    vary: Sequence[str] = (),
    parameters: Mapping[str, float] | None = None,
    guess: Motion | str | None = None,
    method: TrajectoryMethod | None = None,
    verify: bool = True,
    accuracy: float = 1e-3,
    progress: bool | OnIteration = False,
) -> TrajectoryResult:
    """Optimal motion of a mechanism and the controls that produce it.

    Parameters
    ----------
    model : Model; closed loops are enforced by their constraints
    minimize : ``integral``, ``mean``, ``rms``, ``maximum`` or ``final`` of a measure, or
        ``combined`` of these; ``da.final("time")`` for the shortest time
    controls : parameters of forces and moments that become functions of time, within their bounds
    duration : of the motion, or its bounds [s]
    begin, end : measure → value or (lower, upper), None for an open side; by default the motion
        starts at the initial state of the model
    cyclic : measures with equal values at both ends
    subject_to : limits; those on ``maximum`` and ``minimum`` are path constraints
    vary : parameters that are optimised together with the motion, within their bounds
    parameters : values of other parameters
    guess : a motion, ``"simulate"``, or ``"line"``, a straight line to the positions prescribed at
        the end; by default the line if there are such positions
    method : ``DirectCollocation(intervals=...)`` or ``MultipleShooting(...)``
    verify : run forward under the controls; success requires a run that agrees with the plan
    accuracy : upper limit of the distance of plan and run, in natural sizes (lengths of the
        mechanism, radians). A plan beyond it is refined, up to eight times the intervals; if a
        control chatters, a small penalty on the second differences of the controls is added
    progress : True prints each iteration, or a function of its number and objective

    Raises
    ------
    AnalysisError
        A name is unknown, there is nothing to control, or the guess fails; ``UnsupportedError``
        for rigid contacts, and for controls that change masses or lengths.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("cart")
    >>> push = system.parameter("push", 0.0, "N", bounds=(-20, 20))
    >>> cart = system.add(planar.Particle("cart", mass=1.0))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, cart.center))
    >>> force = system.add(planar.Force("force", cart.center, (push, 0)))
    >>> best = da.optimize_trajectory(system.build(), da.integral("push**2"), controls=["push"],
    ...     duration=1.0, end={"cart.x": 1, "cart.vx": 0}, method=da.DirectCollocation(intervals=4))
    >>> best.success, round(best.fun, 6)  # 12 x²/T³
    (True, 12.0)
    """
    need_mechanism(model, "optimize_trajectory", "optimise it by da.optimize")
    method = method or DirectCollocation()
    span = duration_of(duration)
    for name, listed in (("controls", controls), ("vary", vary)):
        if isinstance(listed, str):
            raise AnalysisError(f"{name} is {listed!r}; give a list of names, [{listed!r}]")
    _check_names(model, [*controls, *vary])
    if not controls and not vary:
        raise AnalysisError("nothing to find; name controls=[...], parameters of forces")
    check_conditions(begin, "begin")
    check_conditions(end, "end")
    if not (is_number(accuracy) and accuracy > 0):
        raise AnalysisError(f"accuracy is {accuracy!r}; give a number above zero, such as 1e-3")
    physics = Physics(model, controls, vary, model.values(parameters))
    task = _Task(
        physics, minimize, span, begin, end or {}, cyclic, subject_to, iteration_callback(progress)
    )
    first = initial_guess(physics, guess, end or {}, span, method.intervals)
    plan = task.plan(method, first, 0.0)
    if not verify:
        plan.warnings.append("no run under the controls has verified the plan (verify=False)")
    if not verify or not plan.success:
        return plan
    return _refine(task, method, verify_plan(plan, physics, method, begin is None), accuracy)


@dataclass
class _Task:
    """A trajectory optimisation task, independent of the intervals."""

    physics: Physics
    minimize: Objective
    span: tuple[float, float]
    begin: Conditions | None
    end: Conditions
    cyclic: Sequence[str]
    subject_to: Sequence[Limit]
    report: OnIteration | None

    def plan(self, method: TrajectoryMethod, guess: Guess, penalty: float) -> TrajectoryResult:
        """Optimal plan from an initial guess, with a penalty on rough controls."""
        transcription = method.transcription(self.physics, self.span)
        begin, n = self.begin, method.intervals
        rows = [
            *transcription.equations(),
            *(_at_start(transcription) if begin is None else []),
            *condition_rows(transcription, begin or {}, 0, "at the beginning"),
            *condition_rows(transcription, self.end, n, "at the end"),
            *cyclic_rows(transcription, self.cyclic),
            *limit_rows(transcription, self.subject_to),
        ]
        objective = response_value(transcription, self.minimize)
        smooth = penalty * roughness(transcription) if penalty else 0.0
        programme = Programme(transcription, objective, [*rows, *transcription.peaks], smooth)
        x0 = transcription.pack(guess)
        plan = _plan_from(programme, programme.solve(x0, method, self.report), method)
        plan.label = getattr(self.minimize, "label", plan.label)
        plan.unit = unit_of(self.physics.model, self.minimize)
        plan.intervals = n
        return plan


def _refine(
    task: _Task, method: TrajectoryMethod, plan: TrajectoryResult, accuracy: float
) -> TrajectoryResult:
    """Refine or smooth the plan until the forward run under its controls agrees with it."""
    penalty, smoothed = 0.0, False
    for _ in range(REFINEMENTS):
        chatters = not smoothed and exploits_nodes(plan)
        if plan.motion is None or (agrees(plan, accuracy) and not chatters):
            break
        if chatters:
            penalty, smoothed = ROUGHNESS_WEIGHT * max(abs(plan.fun), 1e-6), True
        else:
            method = method.finer(steps=plan.deviation <= accuracy)
        guess = from_plan(task.physics, plan, method.intervals)
        try:
            following = task.plan(method, guess, penalty)
        except KeyboardInterrupt:
            break
        if not following.success:
            break
        following.iterations += plan.iterations
        plan = verify_plan(following, task.physics, method, task.begin is None)
    return with_final_status(plan, accuracy, smoothed)


def duration_of(duration: float | tuple[float, float]) -> tuple[float, float]:
    """Minimum and maximum of the duration [s].

    Raises
    ------
    AnalysisError
        ``duration`` is neither a time nor a pair of finite bounds.
    """
    low, high = duration if isinstance(duration, (tuple, list)) else (duration, duration)
    if low is None or high is None or not (np.isfinite(high) and 0 <= low <= high and high > 0):
        raise AnalysisError(f"duration is {duration!r}; give a time, or two finite bounds [s]")
    return max(float(low), 1e-6 * float(high)), float(high)


def _check_names(model: Model, names: Sequence[str]) -> None:
    for k, name in enumerate(names):
        if name not in model.parameters:
            raise AnalysisError(unknown("parameter", name, model.parameters))
        if name in names[:k]:
            raise AnalysisError(f"{name!r} is named twice; it is a control or varies, once")


def _at_start(transcription: Transcription) -> list[Rows]:
    """Initial positions and speeds of the model, in the directions free of constraints."""
    physics, knots = transcription.physics, transcription.knots
    model, recipe = physics.model, physics.model.closure.recipe
    basis = speed_basis(physics.equations, 0.0, model.start.y, physics.p)
    position = ca.vertcat(recipe.pinned, recipe.position_conditions)
    position_function = physics.of_state("pinned", position)
    speed = ca.mtimes(ca.DM(basis).T, physics.equations.v - ca.DM(model.start.v))
    speed_function = physics.of_state("moving", speed * model.scales.time)
    return [
        Rows("positions at the start", knots.at(0, position_function)),
        Rows("speeds at the start", knots.at(0, speed_function)),
    ]


def _plan_from(
    programme: Programme, solution: Solution, method: TrajectoryMethod
) -> TrajectoryResult:
    """The plan of a solution, not yet verified."""
    physics = programme.transcription.physics
    unknowns = programme.transcription.unpack(solution.x)
    duration = float(unknowns["duration"][0, 0])
    status = programme.status(solution, duration)
    varied = dict(zip(physics.vary, map(float, unknowns["q"].ravel()), strict=True))
    nominal = dict(zip(physics.model.parameters, map(float, physics.p), strict=False))
    controls = _controls(physics, unknowns, duration)
    scheduled = ScheduledModel(physics.model, {n: c.formula for n, c in controls.items()})
    p = physics.model.values(nominal | varied)
    return TrajectoryResult(
        status=status,
        fun=solution.objective,
        duration=duration,
        x=varied,
        start={name: nominal[name] for name in varied},
        controls=controls,
        planned=_planned_motion(scheduled, method, p, unknowns, duration, status),
        iterations=solution.iterations,
    )


def _controls(
    physics: Physics, unknowns: dict[str, np.ndarray], duration: float
) -> dict[str, Control]:
    controls, count = {}, unknowns["u_middle"].shape[1]
    times = np.linspace(0, duration, 2 * count + 1)
    for k, name in enumerate(physics.controls):
        values = np.empty(2 * count + 1)
        values[::2], values[1::2] = unknowns["u"][k], unknowns["u_middle"][k]
        controls[name] = Control(name, physics.model.parameters[name].unit, times, values)
    return controls


def _planned_motion(
    model: Model,
    method: TrajectoryMethod,
    p: np.ndarray,
    unknowns: dict[str, np.ndarray],
    duration: float,
    status: Status,
) -> Motion:
    """The values at the knots as a motion."""
    times = np.linspace(0, duration, method.intervals + 1)
    trajectory = Trajectory(
        times,
        unknowns["y"],
        unknowns["v"],
        unknowns["a"],
        model.all_multipliers(unknowns["multiplier"]),
        np.full((2, times.size), np.nan),
    )
    return Motion(model, method, p, trajectory, status)
