"""Taylor test: ``|R(p + h d) − R(p) − h ∇R·d|`` falls with ``h²`` if, and only if, ∇R is right."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError, ModelError
from dalembert.sensitivity.checks.replays import Replays
from dalembert.sensitivity.checks.scales import parameter_scales
from dalembert.sensitivity.checks.stencils import beyond_bounds

LONGEST, HALVINGS = 2.0**-4, 18
"""Longest step, relative to the scales of the parameters, and how often it is halved."""
SHORT = (1e-10, 1e-8, 1e-6, 4e-6)
"""Steps so short that a third difference is nothing but round-off."""
CLEAR = 30.0
"""A remainder tells something where it exceeds its uncertainty so many times."""


@dataclass(frozen=True)
class TaylorTest:
    """Remainders of the first-order expansion along one direction.

    Attributes
    ----------
    steps : (K,) ``h``, falling
    remainders : (responses, K); not a number where the run could not be repeated
    noise : (responses, K) their uncertainty: round-off of the responses, and what the gradient may
        be off by
    """

    steps: np.ndarray
    remainders: np.ndarray
    noise: np.ndarray

    def slope(self, response: int) -> float:
        """Slope of the remainder over the step, both logarithmic; NaN where it is all round-off.

        It is that of the four shortest steps whose remainder is clear of round-off.
        """
        r = self.remainders[response]
        clear = np.flatnonzero(np.isfinite(r) & (r > CLEAR * self.noise[response]))
        if clear.size < 3:
            return np.nan
        last = clear[-4:]
        return float(np.polyfit(np.log(self.steps[last]), np.log(r[last]), 1)[0])

    def exact(self, response: int) -> bool:
        """Whether the response is linear: nothing remains at any step but round-off."""
        r = self.remainders[response]
        known = np.isfinite(r)
        return bool(known.sum() > 2 and np.all(~known | (r <= CLEAR * self.noise[response])))


def taylor_test(
    values: Replays,
    columns: list[int],
    gradient: np.ndarray,
    tolerance: float,
    noise: np.ndarray,
    rng: np.random.Generator,
) -> TaylorTest:
    """Remainders along a random direction that stays within bounds and limits.

    Parameters
    ----------
    values : responses at other parameters
    gradient : (responses, columns)
    tolerance : error of the gradient that is accepted, relative to its largest influence
    noise : (responses, 1) of the values, where it is known beforehand
    rng : makes the direction
    """
    p, size = values.parameters, len(gradient)
    direction = _direction(values, columns, rng)
    slope = gradient @ direction[columns]
    centre = values(p)
    steps = LONGEST * 0.5 ** np.arange(HALVINGS)
    remainders = np.full((size, HALVINGS), np.nan)
    for k, h in enumerate(steps):
        found = _tried(values, p + h * direction)
        if found is not None:
            remainders[:, k] = np.abs(found - centre - h * slope)
    largest = np.abs(gradient * direction[columns]).max(axis=1)
    noise = np.maximum(noise, _round_off(values, direction, centre)[:, None])
    return TaylorTest(steps, remainders, noise + tolerance * np.outer(largest, steps))


def _tried(values: Replays, p: np.ndarray) -> np.ndarray | None:
    """Responses at parameters, None where the limits or the run refuse them."""
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
    """Random, each entry of the size of its parameter, away from bounds."""
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
    """Round-off of the responses, by differences that no smooth function shows."""
    noise, p = np.zeros_like(centre), values.parameters
    for h in SHORT:
        found = [_tried(values, p + k * h * direction) for k in (1, 2, 3)]
        ahead = [row for row in found if row is not None]
        if len(ahead) == 3:
            third = np.abs(centre - 3 * ahead[0] + 3 * ahead[1] - ahead[2])
            noise = np.maximum(noise, third / 4)
    return noise
