"""Controls, motion and dimensions at once: trajectory optimisation by direct collocation.

``min J(x(t), u(t), p, T)`` subject to the equations of motion, limits on the way and conditions at
both ends (Betts 2010; Kelly, *An introduction to trajectory optimization*, SIAM Review 2017).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.requirements import need_mechanism
from dalembert.design.limit import Limit
from dalembert.design.telling import Told, teller
from dalembert.design.trajectory.chattering import WEIGHT, roughness
from dalembert.design.trajectory.collocation import DirectCollocation
from dalembert.design.trajectory.control import Control
from dalembert.design.trajectory.guess import Guess, from_plan, guessed
from dalembert.design.trajectory.ipopt import Programme, Solution
from dalembert.design.trajectory.method import TrajectoryMethod
from dalembert.design.trajectory.optimal import OptimalTrajectory
from dalembert.design.trajectory.physics import Physics, speed_basis
from dalembert.design.trajectory.quantities import (
    Conditions,
    check_conditions,
    condition_rows,
    cyclic_rows,
    limit_rows,
    number_of,
    unit_of,
)
from dalembert.design.trajectory.refinement import REFINEMENTS, agrees, exploits_nodes, judged
from dalembert.design.trajectory.transcription import Rows, Transcription
from dalembert.design.trajectory.verification import verified
from dalembert.errors import AnalysisError
from dalembert.interrupts import interruptible
from dalembert.model.model import Model
from dalembert.model.scheduled import ScheduledModel
from dalembert.options import is_number
from dalembert.results.motion import Motion
from dalembert.results.recording import Trajectory
from dalembert.results.status import Status
from dalembert.text.wording import unknown


@interruptible
def optimize_trajectory(
    model: Model,
    minimize: Any,
    controls: Sequence[str],
    duration: float | tuple[float, float],
    *,
    begin: Conditions | None = None,
    end: Conditions | None = None,
    cyclic: Sequence[str] = (),
    subject_to: Sequence[Limit] = (),
    vary: Sequence[str] = (),
    parameters: Mapping[str, float] | None = None,
    guess: Any = None,
    method: TrajectoryMethod | None = None,
    verify: bool = True,
    accuracy: float = 1e-3,
    progress: bool | Told = False,
) -> OptimalTrajectory:
    """Best motion of a mechanism, and the controls that make it.

    Parameters
    ----------
    model : Model; closed loops are kept closed by their constraints
    minimize : ``integral``, ``mean``, ``rms``, ``maximum`` or ``final`` of a measure, or
        ``combined`` of such; ``da.final("time")`` for the shortest time
    controls : parameters of forces and moments that become functions of time, within their bounds
    duration : of the motion, or its bounds [s]
    begin, end : measure → value or (lower, upper), None for an open side; by default it begins
        where the model starts
    cyclic : measures that end as they began
    subject_to : limits; those on ``maximum`` and ``minimum`` hold all the way
    vary : parameters that are designed with the motion, within their bounds
    parameters : values of others
    guess : a motion, ``"simulate"``, or ``"line"``, which leads evenly to the places demanded at
        the end; the line where there are such
    method : ``DirectCollocation(intervals=...)`` or ``MultipleShooting(...)``
    verify : run it forward under the controls; only a run that agrees with the plan is success
    accuracy : largest distance of plan and run, in natural sizes (lengths of the mechanism,
        radians). A plan that is farther away is refined, up to eight times the intervals; one whose
        control chatters gets a small penalty on the second differences of its controls
    progress : True prints each iteration, or a function of its number and objective

    Raises
    ------
    AnalysisError
        An unknown name, nothing to control, or a guess that cannot be made; ``UnsupportedError``
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
    _refuse_names(model, [*controls, *vary])
    if not controls and not vary:
        raise AnalysisError("nothing to find; name controls=[...], parameters of forces")
    check_conditions(begin, "begin")
    check_conditions(end, "end")
    if not (is_number(accuracy) and accuracy > 0):
        raise AnalysisError(f"accuracy is {accuracy!r}; give a number above zero, such as 1e-3")
    physics = Physics(model, controls, vary, model.values(parameters))
    task = _Task(physics, minimize, span, begin, end or {}, cyclic, subject_to, teller(progress))
    first = guessed(physics, guess, end or {}, span, method.intervals)
    plan = task.plan(method, first, 0.0)
    if not verify:
        plan.warnings.append("no run under the controls has verified the plan (verify=False)")
    if not verify or not plan.success:
        return plan
    return _refined(task, method, verified(plan, physics, method, begin is None), accuracy)


@dataclass
class _Task:
    """What a trajectory is asked for, on whatever intervals."""

    physics: Physics
    minimize: Any
    span: tuple[float, float]
    begin: Conditions | None
    end: Conditions
    cyclic: Sequence[str]
    subject_to: Sequence[Limit]
    told: Told | None

    def plan(self, method: TrajectoryMethod, guess: Guess, penalty: float) -> OptimalTrajectory:
        """The plan to which the search leads from a guess, with a penalty on rough controls."""
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
        objective = number_of(transcription, self.minimize)
        smooth = penalty * roughness(transcription) if penalty else 0.0
        programme = Programme(transcription, objective, [*rows, *transcription.peaks], smooth)
        x0 = transcription.pack(guess)
        made = _made(programme, programme.solved(x0, method, self.told), method)
        made.label = getattr(self.minimize, "label", made.label)
        made.unit = unit_of(self.physics.model, self.minimize)
        made.intervals = n
        return made


def _refined(
    task: _Task, method: TrajectoryMethod, plan: OptimalTrajectory, accuracy: float
) -> OptimalTrajectory:
    """The plan on finer intervals, or smoother, until the run under its controls agrees with it."""
    penalty, smoothed = 0.0, False
    for _ in range(REFINEMENTS):
        chatters = not smoothed and exploits_nodes(plan)
        if plan.motion is None or (agrees(plan, accuracy) and not chatters):
            break
        if chatters:
            penalty, smoothed = WEIGHT * max(abs(plan.fun), 1e-6), True
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
        plan = verified(following, task.physics, method, task.begin is None)
    return judged(plan, accuracy, smoothed)


def duration_of(duration: Any) -> tuple[float, float]:
    """Least and largest.

    Raises
    ------
    AnalysisError
        It is not a time, nor two finite bounds.
    """
    low, high = duration if isinstance(duration, (tuple, list)) else (duration, duration)
    if low is None or high is None or not (np.isfinite(high) and 0 <= low <= high and high > 0):
        raise AnalysisError(f"duration is {duration!r}; give a time, or two finite bounds [s]")
    return max(float(low), 1e-6 * float(high)), float(high)


def _refuse_names(model: Model, names: Sequence[str]) -> None:
    for k, name in enumerate(names):
        if name not in model.parameters:
            raise AnalysisError(unknown("parameter", name, model.parameters))
        if name in names[:k]:
            raise AnalysisError(f"{name!r} is named twice; it is a control or varies, once")


def _at_start(transcription: Transcription) -> list[Rows]:
    """Place and speeds of the model's start, on what the constraints leave free."""
    physics, knots = transcription.physics, transcription.knots
    model, recipe = physics.model, physics.model.closure.recipe
    free = speed_basis(physics.equations, 0.0, model.start.y, physics.p)
    away = ca.vertcat(recipe.pinned, recipe.position_conditions)
    place = physics.of_state("pinned", away)
    moving = ca.mtimes(ca.DM(free).T, physics.equations.v - ca.DM(model.start.v))
    speed = physics.of_state("moving", moving * model.scales.time)
    return [
        Rows("place at the start", knots.at(0, place)),
        Rows("speeds at the start", knots.at(0, speed)),
    ]


def _made(programme: Programme, solution: Solution, method: TrajectoryMethod) -> OptimalTrajectory:
    """The plan, not yet run."""
    physics = programme.transcription.physics
    found = programme.transcription.unpack(solution.x)
    duration = float(found["duration"][0, 0])
    status = programme.status(solution, duration)
    varied = dict(zip(physics.vary, map(float, found["q"].ravel()), strict=True))
    given = dict(zip(physics.model.parameters, map(float, physics.p), strict=False))
    controls = _controls(physics, found, duration)
    scheduled = ScheduledModel(physics.model, {n: c.formula for n, c in controls.items()})
    p = physics.model.values(given | varied)
    return OptimalTrajectory(
        status=status,
        fun=solution.objective,
        duration=duration,
        x=varied,
        start={name: given[name] for name in varied},
        controls=controls,
        planned=_planned(scheduled, method, p, found, duration, status),
        iterations=solution.iterations,
    )


def _controls(
    physics: Physics, found: dict[str, np.ndarray], duration: float
) -> dict[str, Control]:
    made, count = {}, found["u_middle"].shape[1]
    times = np.linspace(0, duration, 2 * count + 1)
    for k, name in enumerate(physics.controls):
        values = np.empty(2 * count + 1)
        values[::2], values[1::2] = found["u"][k], found["u_middle"][k]
        made[name] = Control(name, physics.model.parameters[name].unit, times, values)
    return made


def _planned(
    model: Model,
    method: TrajectoryMethod,
    p: np.ndarray,
    found: dict[str, np.ndarray],
    duration: float,
    status: Status,
) -> Motion:
    """The knots as a motion."""
    times = np.linspace(0, duration, method.intervals + 1)
    trajectory = Trajectory(
        times,
        found["y"],
        found["v"],
        found["a"],
        model.all_multipliers(found["multiplier"]),
        np.full((2, times.size), np.nan),
    )
    return Motion(model, method, p, trajectory, status)
