"""Impacts move in time with parameters; a step that takes them at its end does not see it.

With ``x⁺ = S(x⁻)`` over the step, rates ``ẋ⁻`` before and ``ẋ⁺`` after it, an impact that closes
its gap by ``dt* = −dg/ġ⁻`` later adds

    dx⁺ = S' dx⁻ + (S' ẋ⁻ + ∂S/∂t − ẋ⁺) dt*

(jump of the sensitivities: Hiskens and Pai 2000). So the gradient is that of the motion, to the
order of the step, where the derivative of steps at fixed times would miss a term of its own size.
Gaps on the same bodies that close in one instant make one impact, which moves by the mean of what
each of them would: exact for whatever keeps them together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.errors import SingularityError
from dalembert.sensitivity.nonsmooth.contact_maps import Rubbing
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps
from dalembert.sensitivity.nonsmooth.implicit_map import MapAt

SLOW = 2.0
"""Approach, by what forces change in a step, that counts as rest."""
RESTS = 1e-8
"""Speed after an impact, by that before, that is none."""
TOGETHER = 1e-6
"""Share of a step that is one instant."""
TOUCHED = 1e-9
"""Share of the largest change of speed by an impulse that is none."""


@dataclass(frozen=True, eq=False)
class MovingImpact:
    """What an impact adds to the changes of a step.

    Attributes
    ----------
    jump : (n,) change of the state at the end of the step with its instant
    by_x, by_p : of the instant
    """

    jump: np.ndarray
    by_x: np.ndarray
    by_p: np.ndarray

    def push(self, dx: np.ndarray, dp: np.ndarray) -> np.ndarray:
        return np.outer(self.jump, self.by_x @ dx + self.by_p @ dp)

    def pull(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        moved = self.jump @ weights
        return np.outer(self.by_x, moved), np.outer(self.by_p, moved)


@dataclass(frozen=True, eq=False)
class TakenStep:
    """A step with its slopes.

    Attributes
    ----------
    maps : one after the other
    impacts : that come in this step
    """

    maps: list[MapAt]
    impacts: list[MovingImpact]

    def push(self, dx: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """Change of the state at the end."""
        return sum((impact.push(dx, dp) for impact in self.impacts), pushed(self.maps, dx, 0.0, dp))

    def pull(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the state at the start, and of the parameters."""
        moved = [impact.pull(weights) for impact in self.impacts]
        total: Any = 0.0
        for each in reversed(self.maps):
            weights, p_bar = each.pull(weights)
            total = total + p_bar
        for x_bar, p_bar in moved:
            weights, total = weights + x_bar, total + p_bar
        return weights, total


def pushed(maps: list[MapAt], dx: np.ndarray, dt: float, dp: np.ndarray) -> np.ndarray:
    """Change that maps make of one."""
    for each in maps:
        dx = each.push(dx, dt, dp)
    return dx


def taken_step(steps: ContactSteps, k: int) -> TakenStep:
    """The k-th step of a run."""
    maps = steps.at(k)
    closing = _closing(steps, k)
    return TakenStep(maps, _impacts(steps, k, maps, closing) if closing else [])


def _earlier(steps: ContactSteps, k: int) -> dict[int, tuple[Rubbing, np.ndarray]]:
    """What presses in a step, and did in the one before."""
    earlier = steps.patterns[k - 1] if k else {}
    return {key: found for key, found in steps.patterns[k].items() if key in earlier}


def _before(steps: ContactSteps, k: int) -> np.ndarray:
    """Accelerations before the impacts of a step."""
    t, h = steps.span(k)
    end = steps.free(k, _earlier(steps, k), steps.x[:, k], t, h).following
    return (end - steps.x[:, k])[steps.size :] / h


def closing_speeds(steps: ContactSteps, k: int) -> dict[int, tuple[float, float]]:
    """Gaps that come to press in a step: how fast they close, and what forces change in it."""
    known, before = _earlier(steps, k), _before(steps, k)
    (t, h), state = steps.span(k), steps.split(k)
    found = {}
    for key in steps.patterns[k].keys() - known.keys():
        speed, by_v, *_ = steps.maps.closing(key)(t, *state, steps.p)
        found[key] = -float(speed), float(np.abs(by_v.full() @ before).max()) * h
    return found


def _closing(steps: ContactSteps, k: int) -> list[int]:
    """Gaps that close by an impact in a step."""
    if steps.patterns[k].keys() == _earlier(steps, k).keys():
        return []
    speeds = closing_speeds(steps, k)
    return [key for key, (speed, forced) in speeds.items() if speed > SLOW * forced]


def _impacts(
    steps: ContactSteps, k: int, maps: list[MapAt], closing: list[int]
) -> list[MovingImpact]:
    t, h = steps.span(k)
    begin, end, pattern = steps.x[:, k], steps.x[:, k + 1], steps.patterns[k]
    place = steps.split(k)
    lasting = {key: pattern[key] for key in pattern if _rests(steps, k, key)}
    after = (steps.free(k, lasting, end, t + h, h).following - end)[steps.size :] / h
    then = np.concatenate([_moving(steps, end) @ end[steps.size :], after])
    now = np.concatenate([_moving(steps, begin) @ begin[steps.size :], _before(steps, k)])
    jump = pushed(maps, now[:, None], 1.0, np.zeros((steps.p.size, 1))).ravel() - then
    found = []
    for keys, part in moving_parts(steps, k, closing).items():
        moving = []
        for key in keys:
            speed, _, by_y, by_p = (s.full() for s in steps.maps.closing(key)(t, *place, steps.p))
            by_x = np.concatenate([by_y.ravel(), 0 * after])
            moving.append(-np.concatenate([by_x, by_p.ravel()]) / speed[0, 0])
        by_x, by_p = np.split(np.mean(moving, axis=0), [steps.x.shape[0]])
        found.append(MovingImpact(part * jump, by_x, by_p))
    return found


def _rests(steps: ContactSteps, k: int, key: int) -> bool:
    """Whether a contact stays closed after the step."""
    gap, t = steps.maps.gap(key), steps.record.t
    y, v = steps.x[: steps.size], steps.x[steps.size :]
    speeds = [float(gap(t[n], y[:, n], v[:, n], steps.p)[1][0]) for n in (k, k + 1)]
    fastest = float(np.abs(steps.x[steps.size :, k : k + 2]).max())
    return abs(speeds[1]) <= RESTS * max(abs(speeds[0]), fastest)


def _moving(steps: ContactSteps, x: np.ndarray) -> np.ndarray:
    """(n_y, n_v) ``A`` with ``ẏ = A v``."""
    return steps.maps.moving(x[: steps.size]).full()


def together(steps: ContactSteps, k: int, keys: Sequence[int]) -> bool:
    """Whether gaps close in one instant, seen from before they were opened for this step."""
    before = max(k - 1, 0)
    (t, h), state = steps.span(before), steps.split(before)
    values = [steps.maps.gap(key)(t, *state, steps.p) for key in keys]
    instants = [-float(distance) / float(speeds[0]) for distance, speeds, *_ in values]
    return max(instants) - min(instants) <= TOGETHER * h


def moving_parts(steps: ContactSteps, k: int, keys: list[int]) -> dict[tuple[int, ...], np.ndarray]:
    """Which part of the state, as ones and zeros, each of the impacts of a step moves.

    Gaps that close in one instant and move the same are one impact.

    Raises
    ------
    SingularityError
        Two of them move the same, one after the other.
    """
    (t, _), (y, v) = steps.span(k), steps.split(k)
    if len(keys) == 1:
        return {tuple(keys): np.ones(steps.x.shape[0])}
    solve = steps.step.smooth.at(t, y, steps.p)[0]
    touched = {}
    for key in steps.patterns[k]:
        direction = steps.maps.closing(key)(t, y, v, steps.p)[1].full()[0]
        moved = np.abs(solve(direction, None)[0])
        touched[key] = moved > TOUCHED * moved.max()
    parts: dict[tuple[int, ...], np.ndarray] = {}
    for key in keys:
        part, others = touched[key], dict(touched)
        while near := [other for other, own in others.items() if (own & part).any()]:
            part = np.logical_or.reduce([part, *(others.pop(other) for other in near)])
        met = [known for known, own in parts.items() if (part & own).any()]
        if met and together(steps, k, [key, *met[0]]):
            parts[(*met[0], key)] = parts.pop(met[0])
            continue
        if met:
            raise SingularityError(
                f"impacts on the same bodies come within one step at t = {t:.9g} s: which is "
                "first depends on parameters, and so does the motion after them; take shorter "
                "steps"
            )
        parts[(key,)] = part
    places = np.abs(_moving(steps, steps.x[:, k]))
    return {
        some: np.concatenate([places @ part > 0, part]).astype(float)
        for some, part in parts.items()
    }
