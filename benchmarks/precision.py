"""Work and precision: time to an error, for everyone on one mechanism."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from benchmarks.sample import Sample
from benchmarks.solvers.base import Contestant

LONG = 0.1
"""Seconds of a run whose steps are timed."""


@dataclass(frozen=True)
class Point:
    steps: int
    seconds: float
    error: float


@dataclass
class Curve:
    """Runs of one contestant with more and more steps, and many with the last number of them."""

    contestant: Contestant
    points: list[Point] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    reached: bool = False

    @property
    def time(self) -> Sample:
        """To the error that was asked for; of the last number of steps where it was not reached."""
        last = self.points[-1]
        note = f"{last.steps} steps" if self.reached else f"error {last.error:.0e} only"
        return Sample.of(self.seconds, "s", note)


def compare(
    contestants: Sequence[Contestant],
    reference: np.ndarray,
    error: float,
    rounds: int,
    limit: float,
) -> list[Curve]:
    """Double the steps until the error is small enough; then repeat in turns.

    Parameters
    ----------
    error : of the observed place that everyone has to reach [m]
    rounds : how often the last run is repeated
    limit : seconds that a run may take; who would need more has not reached the error
    """
    curves = [Curve(c) for c in contestants]
    for curve in curves:
        _search(curve, reference, error, limit)
    for _ in range(rounds):
        for curve in curves:
            curve.seconds.append(curve.contestant.run(curve.points[-1].steps)[0])
    return curves


def per_step(curve: Curve, rounds: int) -> Sample:
    """A step of a run that is long enough for its beginning not to count."""
    last = curve.points[-1]
    steps = last.steps * max(1, math.ceil(LONG / max(last.seconds, 1e-9)))
    run = curve.contestant.run
    run(steps)
    return Sample.of([run(steps)[0] / steps for _ in range(rounds)], "s")


def _search(curve: Curve, reference: np.ndarray, error: float, limit: float) -> None:
    steps = curve.contestant.first
    while True:
        curve.contestant.run(steps)  # compiles, and fills caches
        seconds, place = curve.contestant.run(steps)
        found = float(np.abs(np.asarray(place) - reference)[_seen(reference)].max())
        if not np.isfinite(found):
            found = np.inf
        curve.points.append(Point(steps, seconds, found))
        if found <= error:
            curve.reached = True
            return
        if 4 * seconds > limit:
            return
        steps *= 2


def _seen(reference: np.ndarray) -> np.ndarray:
    """Coordinates that are known."""
    return np.isfinite(reference)
