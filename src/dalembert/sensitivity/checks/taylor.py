"""Taylor test: ``|R(p + h d) − R(p) − h ∇R·d| = O(h²)`` if and only if ∇R is correct."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError, ModelError
from dalembert.sensitivity.checks.finite_difference import Replays
from dalembert.sensitivity.checks.stencils import beyond_bounds, parameter_scales

LONGEST, HALVINGS = 2.0**-4, 18
"""Longest step relative to the scales of the parameters [-], and number of halvings."""
SHORT = (1e-10, 1e-8, 1e-6, 4e-6)
"""Steps short enough for third differences of round-off only [-]."""
CLEAR = 30.0
"""Threshold of a significant remainder, relative to its uncertainty [-]."""


@dataclass(frozen=True)
class TaylorTest:
    """Remainders of the first-order expansion along one direction.

    Attributes
    ----------
    steps : (K,) ``h``, descending
    remainders : (responses, K); NaN if the run could not be repeated
    noise : (responses, K) their uncertainty: round-off of the responses and tolerance of the
        gradient
    """

    steps: np.ndarray
    remainders: np.ndarray
    noise: np.ndarray

    def slope(self, response: int) -> float:
        """Slope of the remainder over the step, log-log; NaN if all remainders are round-off.

        It is fitted to the four shortest steps with significant remainders.
        """
        r = self.remainders[response]
        significant = np.flatnonzero(np.isfinite(r) & (r > CLEAR * self.noise[response]))
        if significant.size < 3:
            return np.nan
        last = significant[-4:]
        return float(np.polyfit(np.log(self.steps[last]), np.log(r[last]), 1)[0])

    def exact(self, response: int) -> bool:
        """True if the response is linear: all remainders are round-off."""
        r = self.remainders[response]
        finite = np.isfinite(r)
        return bool(finite.sum() > 2 and np.all(~finite | (r <= CLEAR * self.noise[response])))


def taylor_test(
    values: Replays,
    columns: list[int],
    gradient: np.ndarray,
    tolerance: float,
    noise: np.ndarray,
    rng: np.random.Generator,
) -> TaylorTest:
    """Remainders along a random direction within bounds and limits.

    Parameters
    ----------
    values : responses at other parameters
    gradient : (responses, columns)
    tolerance : accepted error of the gradient, relative to its largest influence [-]
    noise : (responses, 1) lower bound of the noise of the values
    rng : random generator of the direction
    """
    p, size = values.parameters, len(gradient)
    direction = _direction(values, columns, rng)
    slope = gradient @ direction[columns]
    centre = values(p)
    steps = LONGEST * 0.5 ** np.arange(HALVINGS)
    remainders = np.full((size, HALVINGS), np.nan)
    for k, h in enumerate(steps):
        responses = _values_at(values, p + h * direction)
        if responses is not None:
            remainders[:, k] = np.abs(responses - centre - h * slope)
    largest = np.abs(gradient * direction[columns]).max(axis=1)
    noise = np.maximum(noise, _round_off(values, direction, centre)[:, None])
    return TaylorTest(steps, remainders, noise + tolerance * np.outer(largest, steps))


def _values_at(values: Replays, p: np.ndarray) -> np.ndarray | None:
    """Responses at parameters, None if limits are violated or the run fails."""
    model = values.motion.model
    for i in np.flatnonzero(p != values.parameters):
        if beyond_bounds(values.motion, int(i), float(p[i])):
            return None
    try:
        model.values(dict(zip(model.parameters, map(float, p), strict=False)))
        return values(p)
    except (AnalysisError, ModelError):
        return None


def _direction(values: Replays, columns: list[int], rng: np.random.Generator) -> np.ndarray:
    """Random direction with entries of the size of the parameters, away from bounds."""
    motion, direction = values.motion, np.zeros_like(values.parameters)
    size = parameter_scales(motion, columns) * rng.uniform(0.3, 1.0, len(columns))
    direction[columns] = size * rng.choice([-1.0, 1.0], len(columns))
    for i in columns:
        for _ in range(2):
            if beyond_bounds(motion, i, float(values.parameters[i] + 1e-3 * direction[i])):
                direction[i] *= -1.0
            else:
                break
        else:
            direction[i] = 0.0
    return direction


def _round_off(values: Replays, direction: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Round-off of the responses, estimated by third differences at short steps."""
    noise, p = np.zeros_like(centre), values.parameters
    for h in SHORT:
        points = [_values_at(values, p + k * h * direction) for k in (1, 2, 3)]
        rows = [row for row in points if row is not None]
        if len(rows) == 3:
            third = np.abs(centre - 3 * rows[0] + 3 * rows[1] - rows[2])
            noise = np.maximum(noise, third / 4)
    return noise
