"""Initial guesses of trajectory optimisation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.design.trajectory.physics import Physics
from dalembert.design.trajectory.quantities import Conditions
from dalembert.errors import AnalysisError
from dalembert.symbolic.formulas.expression import stack

if TYPE_CHECKING:
    from dalembert.design.trajectory.trajectory_result import TrajectoryResult
    from dalembert.results.motion import Motion

Guess = dict[str, np.ndarray]
ITERATIONS = 60
"""Upper limit of Newton corrections of a guessed position."""


def initial_guess(
    physics: Physics, guess: Any, ends: Conditions, duration: tuple[float, float], intervals: int
) -> Guess:
    """Initial values of the unknowns at the knots.

    Parameters
    ----------
    guess : a motion, ``"simulate"``, ``"line"``, or None: a line if end positions are prescribed,
        otherwise a simulation

    Raises
    ------
    AnalysisError
        ``guess`` is none of these, or the motion cannot be run.
    """
    if isinstance(guess, str) or guess is None:
        span = float(np.sqrt(max(duration[0], 1e-3 * duration[1]) * duration[1]))
        goals = _position_goals(physics, ends)
        if guess not in (None, "simulate", "line"):
            raise AnalysisError(f"guess is {guess!r}; give a motion, 'simulate' or 'line'")
        if guess == "line" or (guess is None and goals):
            return _complete_guess(physics, _line(physics, goals, intervals), span)
        motion = Dynamics(span, step=span / max(200, 4 * intervals)).run(physics.model, physics.p)
        if not motion.status.success:
            raise AnalysisError(f"the guessed motion fails: {motion.status}; give guess='line'")
        return _sample_motion(physics, motion, intervals)
    return _sample_motion(physics, guess, intervals)


def from_plan(physics: Physics, plan: TrajectoryResult, intervals: int) -> Guess:
    """A plan as initial guess of the next one, on other intervals."""
    guess = _sample_motion(physics, plan.planned, intervals)
    times = np.linspace(0, plan.duration, 2 * intervals + 1)
    u = np.array([control(times) for control in plan.controls.values()]).reshape(-1, times.size)
    q = np.array(list(plan.x.values()))
    y, v = guess["y"], guess["v"]
    forces = [
        physics.accelerations(t, y[:, k], v[:, k], u[:, 2 * k], q) for k, t in enumerate(times[::2])
    ]
    a, multiplier = (
        np.array(part).T.reshape(-1, intervals + 1) for part in zip(*forces, strict=True)
    )
    return guess | {
        "a": a,
        "multiplier": multiplier,
        "a_middle": (a[:, 1:] + a[:, :-1]) / 2,
        "multiplier_middle": (multiplier[:, 1:] + multiplier[:, :-1]) / 2,
        "u": u[:, ::2],
        "u_middle": u[:, 1::2],
        "q": q[:, None],
    }


def _sample_motion(physics: Physics, motion: Motion, intervals: int) -> Guess:
    """A motion, sampled at the knots."""
    if motion.model.equations.y.numel() != physics.equations.y.numel():
        raise AnalysisError("the guess is a motion of another mechanism; give one of this model")
    span = float(motion.time[-1] - motion.time[0])
    samples = motion.at(np.linspace(motion.time[0], motion.time[-1], intervals + 1)).trajectory
    return _complete_guess(physics, samples.y, span, samples.v)


def _position_goals(physics: Physics, ends: Conditions) -> dict[str, tuple[float, float]]:
    """Bounds of the measures prescribed at the end that depend on positions only."""
    e, goals = physics.equations, {}
    other_states = ca.vertcat(e.v, e.a, e.multiplier, e.t)
    for name, value in ends.items():
        if not ca.depends_on(physics.model.expression(name).sx, other_states):
            low, high = value if isinstance(value, tuple) else (value, value)
            goals[name] = (-np.inf if low is None else low, np.inf if high is None else high)
    return goals


def _line(physics: Physics, goals: dict[str, tuple[float, float]], intervals: int) -> np.ndarray:
    """(n_y, N + 1) positions at which the measures approach their end values linearly.

    Each position is projected on the constraints with the smallest change from the previous one.
    """
    e, y = physics.equations, physics.model.start.y.copy()
    measures = stack(physics.model.expression(name).sx for name in goals)
    rows = ca.vertcat(physics.position_conditions, measures)
    lead = ca.mtimes(ca.jacobian(rows, e.y), e.lift)
    evaluate = ca.Function("positions", [e.t, e.y, e.p], [rows, lead])
    p, count = physics.p, physics.position_conditions.numel()
    initial = np.asarray(evaluate(0.0, y, p)[0]).ravel()[count:]
    low, high = np.array(list(goals.values())).reshape(-1, 2).T
    targets = np.clip(initial, low, high)
    positions = [y]
    for share in np.linspace(0, 1, intervals + 1)[1:]:
        target = np.r_[np.zeros(count), initial + share * (targets - initial)]
        for _ in range(ITERATIONS):
            value, jacobian = (np.asarray(part) for part in evaluate(0.0, y, p))
            residual = value.ravel() - target
            if np.abs(residual).max(initial=0.0) < 1e-9:
                break
            y = e.manifold.go(y, -np.linalg.lstsq(jacobian, residual, rcond=1e-9)[0])
        positions.append(y)
    return np.array(positions).T


def _complete_guess(physics: Physics, y: np.ndarray, span: float, v: Any = None) -> Guess:
    """Complete positions by finite-difference speeds and by accelerations and multipliers."""
    model, manifold = physics.model, physics.equations.manifold
    count, h = y.shape[1], span / (y.shape[1] - 1)
    if v is None:
        mean_speeds = manifold.lead(y[:, :-1], y[:, 1:]) / h
        v = np.column_stack(
            [mean_speeds[:, 0], (mean_speeds[:, 1:] + mean_speeds[:, :-1]) / 2, mean_speeds[:, -1]]
        )
    u = np.array([model.parameters[n].value for n in physics.controls])
    q = np.array([physics.p[list(model.parameters).index(n)] for n in physics.vary])
    times = np.linspace(0, span, count)
    forces = [physics.accelerations(t, y[:, k], v[:, k], u, q) for k, t in enumerate(times)]
    a, multiplier = (np.array(part).T.reshape(-1, count) for part in zip(*forces, strict=True))
    return {
        "y": y,
        "v": v,
        "a": a,
        "multiplier": multiplier,
        "a_middle": (a[:, 1:] + a[:, :-1]) / 2,
        "multiplier_middle": (multiplier[:, 1:] + multiplier[:, :-1]) / 2,
        "u": u[:, None],
        "u_middle": u[:, None],
        "q": q[:, None],
        "duration": np.array([[span]]),
    }
