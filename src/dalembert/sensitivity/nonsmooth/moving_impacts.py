"""Derivatives of impact times, which steps at fixed times do not include.

With ``x⁺ = S(x⁻)`` over the step and rates ``ẋ⁻`` before and ``ẋ⁺`` after it, an impact whose
instant moves by ``dt* = −dg/ġ⁻`` adds

    dx⁺ = S' dx⁻ + (S' ẋ⁻ + ∂S/∂t − ẋ⁺) dt*

(jump of the sensitivities: Hiskens and Pai 2000). So the gradient is that of the motion to the
order of the step, whereas the derivative of steps at fixed times lacks a term of its own size.
Gaps on the same bodies that close at one instant make one impact, which moves by the mean of their
shifts: exact for all changes that keep them simultaneous.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.errors import SingularityError
from dalembert.sensitivity.nonsmooth.contact_maps import Friction
from dalembert.sensitivity.nonsmooth.contact_steps import ContactSteps
from dalembert.sensitivity.nonsmooth.implicit_map import MapAt

SLOW = 2.0
"""Threshold of the approach speed of an impact, relative to the change by forces in a step [-]."""
RESTING = 1e-8
"""Threshold of the speed of a closed contact after an impact, relative to that before [-]."""
SIMULTANEOUS = 1e-6
"""Threshold of the distance of simultaneous impacts, relative to the step [-]."""
MOVED = 1e-9
"""Threshold of a change of speed by an impulse, relative to the largest change [-]."""


@dataclass(frozen=True, eq=False)
class MovingImpact:
    """Contribution of a moving impact to the changes of a step.

    Attributes
    ----------
    jump : (n,) derivative of the state at the end of the step by the instant
    by_x, by_p : derivatives of the instant
    """

    jump: np.ndarray
    by_x: np.ndarray
    by_p: np.ndarray

    def push(self, dx: np.ndarray, dp: np.ndarray) -> np.ndarray:
        return np.outer(self.jump, self.by_x @ dx + self.by_p @ dp)

    def pull(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        weight = self.jump @ weights
        return np.outer(self.by_x, weight), np.outer(self.by_p, weight)


@dataclass(frozen=True, eq=False)
class StepTangent:
    """Linearised step of a nonsmooth run.

    Attributes
    ----------
    maps : sequence of maps of the step
    impacts : moving impacts in this step
    """

    maps: list[MapAt]
    impacts: list[MovingImpact]

    def push(self, dx: np.ndarray, dp: np.ndarray) -> np.ndarray:
        """Change of the state at the end."""
        return sum(
            (impact.push(dx, dp) for impact in self.impacts), push_maps(self.maps, dx, 0.0, dp)
        )

    def pull(self, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Weights of the state at the start, and of the parameters."""
        of_impacts = [impact.pull(weights) for impact in self.impacts]
        total: Any = 0.0
        for one_map in reversed(self.maps):
            weights, p_bar = one_map.pull(weights)
            total = total + p_bar
        for x_bar, p_bar in of_impacts:
            weights, total = weights + x_bar, total + p_bar
        return weights, total


def push_maps(maps: list[MapAt], dx: np.ndarray, dt: float, dp: np.ndarray) -> np.ndarray:
    """Change of the state after a sequence of maps."""
    for one_map in maps:
        dx = one_map.push(dx, dt, dp)
    return dx


def step_tangent(steps: ContactSteps, k: int) -> StepTangent:
    """Linearisation of step ``k`` of a run."""
    maps = steps.at(k)
    closing = _impacting_gaps(steps, k)
    return StepTangent(maps, _impacts(steps, k, maps, closing) if closing else [])


def _persistent(steps: ContactSteps, k: int) -> dict[int, tuple[tuple[Friction, ...], np.ndarray]]:
    """Contacts that press in step ``k`` and in the step before."""
    earlier = steps.patterns[k - 1] if k else {}
    return {key: contact for key, contact in steps.patterns[k].items() if key in earlier}


def _acceleration_before(steps: ContactSteps, k: int) -> np.ndarray:
    """Accelerations before the impacts of step ``k``."""
    t, h = steps.span(k)
    end = steps.free(k, _persistent(steps, k), steps.x[:, k], t, h).following
    return (end - steps.x[:, k])[steps.size :] / h


def closing_speeds(steps: ContactSteps, k: int) -> dict[int, tuple[float, float]]:
    """Newly pressing gap → closing speed, and its change by forces in the step."""
    persistent, before = _persistent(steps, k), _acceleration_before(steps, k)
    (t, h), state = steps.span(k), steps.split(k)
    closing = {}
    for key in steps.patterns[k].keys() - persistent.keys():
        speed, by_v, *_ = steps.maps.closing(key)(t, *state, steps.p)
        closing[key] = -float(speed), float(np.abs(by_v.full() @ before).max()) * h
    return closing


def _impacting_gaps(steps: ContactSteps, k: int) -> list[int]:
    """Gaps that close by an impact in step ``k``."""
    if steps.patterns[k].keys() == _persistent(steps, k).keys():
        return []
    speeds = closing_speeds(steps, k)
    return [key for key, (speed, forced) in speeds.items() if speed > SLOW * forced]


def _impacts(
    steps: ContactSteps, k: int, maps: list[MapAt], closing: list[int]
) -> list[MovingImpact]:
    t, h = steps.span(k)
    begin, end, pattern = steps.x[:, k], steps.x[:, k + 1], steps.patterns[k]
    state = steps.split(k)
    closed = {key: pattern[key] for key in pattern if _remains_closed(steps, k, key)}
    after = (steps.free(k, closed, end, t + h, h).following - end)[steps.size :] / h
    rate_after = np.concatenate([_kinematic_matrix(steps, end) @ end[steps.size :], after])
    rate_before = np.concatenate(
        [_kinematic_matrix(steps, begin) @ begin[steps.size :], _acceleration_before(steps, k)]
    )
    jump = push_maps(maps, rate_before[:, None], 1.0, np.zeros((steps.p.size, 1))).ravel()
    jump = jump - rate_after
    impacts = []
    for keys, part in moving_parts(steps, k, closing).items():
        instants = []
        for key in keys:
            speed, _, by_y, by_p = (s.full() for s in steps.maps.closing(key)(t, *state, steps.p))
            by_x = np.concatenate([by_y.ravel(), 0 * after])
            instants.append(-np.concatenate([by_x, by_p.ravel()]) / speed[0, 0])
        by_x, by_p = np.split(np.mean(instants, axis=0), [steps.x.shape[0]])
        impacts.append(MovingImpact(part * jump, by_x, by_p))
    return impacts


def _remains_closed(steps: ContactSteps, k: int, key: int) -> bool:
    """True if a contact remains closed after step ``k``."""
    gap, t = steps.maps.gap(key), steps.record.t
    y, v = steps.x[: steps.size], steps.x[steps.size :]
    speeds = [float(gap(t[n], y[:, n], v[:, n], steps.p)[1][0]) for n in (k, k + 1)]
    fastest = float(np.abs(steps.x[steps.size :, k : k + 2]).max())
    return abs(speeds[1]) <= RESTING * max(abs(speeds[0]), fastest)


def _kinematic_matrix(steps: ContactSteps, x: np.ndarray) -> np.ndarray:
    """(n_y, n_v) ``A`` with ``ẏ = A v``."""
    return steps.maps.kinematic_matrix(x[: steps.size]).full()


def simultaneous(steps: ContactSteps, k: int, keys: Sequence[int]) -> bool:
    """True if gaps close at one instant, extrapolated from the step before their correction."""
    before = max(k - 1, 0)
    (t, h), state = steps.span(before), steps.split(before)
    values = [steps.maps.gap(key)(t, *state, steps.p) for key in keys]
    instants = [-float(distance) / float(speeds[0]) for distance, speeds, *_ in values]
    return max(instants) - min(instants) <= SIMULTANEOUS * h


def moving_parts(steps: ContactSteps, k: int, keys: list[int]) -> dict[tuple[int, ...], np.ndarray]:
    """Mask of the state entries that each impact of step ``k`` changes, as ones and zeros.

    Gaps that close simultaneously and change the same entries make one impact.

    Raises
    ------
    SingularityError
        Two successive impacts change the same entries.
    """
    (t, _), (y, v) = steps.span(k), steps.split(k)
    if len(keys) == 1:
        return {tuple(keys): np.ones(steps.x.shape[0])}
    solve = steps.step.smooth.at(t, y, steps.p)[0]
    changed = {}
    for key in steps.patterns[k]:
        direction = steps.maps.closing(key)(t, y, v, steps.p)[1].full()[0]
        speeds = np.abs(solve(direction, None)[0])
        changed[key] = speeds > MOVED * speeds.max()
    parts: dict[tuple[int, ...], np.ndarray] = {}
    for key in keys:
        part, remaining = changed[key], dict(changed)
        while coupled := [other for other, own in remaining.items() if (own & part).any()]:
            part = np.logical_or.reduce([part, *(remaining.pop(other) for other in coupled)])
        overlapping = [keys_of for keys_of, own in parts.items() if (part & own).any()]
        if overlapping and simultaneous(steps, k, [key, *overlapping[0]]):
            parts[(*overlapping[0], key)] = parts.pop(overlapping[0])
            continue
        if overlapping:
            raise SingularityError(
                f"impacts on the same bodies come within one step at t = {t:.9g} s: which is "
                "first depends on parameters, and so does the motion after them; take shorter "
                "steps"
            )
        parts[(key,)] = part
    matrix = np.abs(_kinematic_matrix(steps, steps.x[:, k]))
    return {
        group: np.concatenate([matrix @ part > 0, part]).astype(float)
        for group, part in parts.items()
    }
