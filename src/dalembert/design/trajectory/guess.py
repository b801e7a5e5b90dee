"""Where the search for a trajectory begins."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.dynamics import Dynamics
from dalembert.design.trajectory.physics import Physics
from dalembert.design.trajectory.quantities import Conditions
from dalembert.errors import AnalysisError
from dalembert.symbolic.formulas.expression import stack

Guess = dict[str, np.ndarray]
ITERATIONS = 60
"""Newton corrections of a guessed position at most."""


def guessed(
    physics: Physics, given: Any, ends: Conditions, duration: tuple[float, float], intervals: int
) -> Guess:
    """Unknowns at the knots to begin with.

    Parameters
    ----------
    given : a motion, ``"simulate"``, ``"line"``, or None: a line where places at the end are known

    Raises
    ------
    AnalysisError
        What is given is none of these, or the motion cannot be run.
    """
    if isinstance(given, str) or given is None:
        span = float(np.sqrt(max(duration[0], 1e-3 * duration[1]) * duration[1]))
        goals = _places(physics, ends)
        if given not in (None, "simulate", "line"):
            raise AnalysisError(f"guess is {given!r}; give a motion, 'simulate' or 'line'")
        if given == "line" or (given is None and goals):
            return _completed(physics, _line(physics, goals, intervals), span)
        given = Dynamics(span, step=span / max(200, 4 * intervals)).run(physics.model, physics.p)
        if not given.status.success:
            raise AnalysisError(f"the guessed motion fails: {given.status}; give guess='line'")
    return _sampled(physics, given, intervals)


def from_plan(physics: Physics, plan: Any, intervals: int) -> Guess:
    """A plan as the beginning of the search for the next one, on other intervals."""
    made = _sampled(physics, plan.planned, intervals)
    times = np.linspace(0, plan.duration, 2 * intervals + 1)
    u = np.array([control(times) for control in plan.controls.values()]).reshape(-1, times.size)
    q = np.array(list(plan.x.values()))
    y, v = made["y"], made["v"]
    forces = [
        physics.accelerations(t, y[:, k], v[:, k], u[:, 2 * k], q) for k, t in enumerate(times[::2])
    ]
    a, multiplier = (
        np.array(part).T.reshape(-1, intervals + 1) for part in zip(*forces, strict=True)
    )
    return made | {
        "a": a,
        "multiplier": multiplier,
        "a_middle": (a[:, 1:] + a[:, :-1]) / 2,
        "multiplier_middle": (multiplier[:, 1:] + multiplier[:, :-1]) / 2,
        "u": u[:, ::2],
        "u_middle": u[:, 1::2],
        "q": q[:, None],
    }


def _sampled(physics: Physics, motion: Any, intervals: int) -> Guess:
    """A motion at the knots."""
    if motion.model.equations.y.numel() != physics.equations.y.numel():
        raise AnalysisError("the guess is a motion of another mechanism; give one of this model")
    span = float(motion.time[-1] - motion.time[0])
    seen = motion.at(np.linspace(motion.time[0], motion.time[-1], intervals + 1)).trajectory
    return _completed(physics, seen.y, span, seen.v)


def _places(physics: Physics, ends: Conditions) -> dict[str, tuple[float, float]]:
    """Measures of positions alone that are demanded at the end, with their bounds."""
    e, made = physics.equations, {}
    others = ca.vertcat(e.v, e.a, e.multiplier, e.t)
    for name, value in ends.items():
        if not ca.depends_on(physics.model.expression(name).sx, others):
            low, high = value if isinstance(value, tuple) else (value, value)
            made[name] = (-np.inf if low is None else low, np.inf if high is None else high)
    return made


def _line(physics: Physics, goals: dict[str, tuple[float, float]], intervals: int) -> np.ndarray:
    """(n_y, N + 1) positions at which what is demanded at the end is approached evenly.

    Each position is corrected on to the constraints with the least change of the one before.
    """
    e, y = physics.equations, physics.model.start.y.copy()
    measures = stack(physics.model.expression(name).sx for name in goals)
    rows = ca.vertcat(physics.held, measures)
    lead = ca.mtimes(ca.jacobian(rows, e.y), e.lift)
    solve = ca.Function("places", [e.t, e.y, e.p], [rows, lead])
    p, held = physics.p, physics.held.numel()
    begun = np.asarray(solve(0.0, y, p)[0]).ravel()[held:]
    low, high = np.array(list(goals.values())).reshape(-1, 2).T
    aims = np.clip(begun, low, high)
    found = [y]
    for share in np.linspace(0, 1, intervals + 1)[1:]:
        aim = np.r_[np.zeros(held), begun + share * (aims - begun)]
        for _ in range(ITERATIONS):
            value, slope = (np.asarray(part) for part in solve(0.0, y, p))
            off = value.ravel() - aim
            if np.abs(off).max(initial=0.0) < 1e-9:
                break
            y = e.manifold.go(y, -np.linalg.lstsq(slope, off, rcond=1e-9)[0])
        found.append(y)
    return np.array(found).T


def _completed(physics: Physics, y: np.ndarray, span: float, v: Any = None) -> Guess:
    """With speeds by differences, and the accelerations and multipliers that they need."""
    model, manifold = physics.model, physics.equations.manifold
    count, h = y.shape[1], span / (y.shape[1] - 1)
    if v is None:
        between = manifold.lead(y[:, :-1], y[:, 1:]) / h
        v = np.column_stack([between[:, 0], (between[:, 1:] + between[:, :-1]) / 2, between[:, -1]])
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
