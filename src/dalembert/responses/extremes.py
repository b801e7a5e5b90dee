"""Largest and smallest values, exact or smoothed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.analysis.dynamics.instants import end_by_event
from dalembert.analysis.events import Occurrence
from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.responses.base import Response, scalar_measure
from dalembert.responses.integrals import Weighted
from dalembert.responses.quadrature import rule_over
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.spelling import spelled


@dataclass(frozen=True, kw_only=True)
class SmoothExtreme(Response):
    """``± (1/ρ) ln(wᵀ exp(± ρ m))`` with the weights of a mean over time."""

    mean: Weighted
    smooth: float
    sign: float

    def _powers(self, samples: np.ndarray) -> tuple[float, np.ndarray]:
        """The largest sample, and the powers relative to that of it."""
        m = self.sign * samples
        return float(m.max()), np.exp(self.smooth * (m - m.max()))

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        top, powers = self._powers(samples)
        return self.sign * (top + float(np.log(self.mean.reduce(times, powers))) / self.smooth)

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        _, powers = self._powers(samples)
        return self.mean.weights(times, powers) * powers / self.mean.reduce(times, powers)

    def weights_change(
        self, times: np.ndarray, samples: np.ndarray, change: np.ndarray
    ) -> np.ndarray:
        weights = self.weights(times, samples)
        return self.sign * self.smooth * weights * (change - weights @ change)

    def time_weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        _, powers = self._powers(samples)
        size = self.sign * self.smooth * self.mean.reduce(times, powers)
        return self.mean.time_weights(times, powers) / size

    def jump_weight(
        self, times: np.ndarray, samples: np.ndarray, before: float, after: float
    ) -> float:
        top, powers = self._powers(samples)
        sides = np.exp(self.smooth * (self.sign * np.array([before, after]) - top))
        size = self.sign * self.smooth * self.mean.reduce(times, powers)
        return self.mean.jump_weight(times, powers, *sides) / size

    def shares(self, times: np.ndarray) -> np.ndarray:
        return self.mean.shares(times)


@options
class Maximum(Response):
    """Largest value, or its smooth lower bound (Kreisselmeier and Steinhauser 1979).

    Under error control the largest value of the motion between its first and its last output: its
    instant is located inside the steps, and both sides of impacts and switches count. With fixed
    steps, and of other results, the largest sample.

    ``(1/ρ) ln ( (1/T) ∫ exp(ρ m) dt )`` tends to the maximum as ``ρ`` grows; of samples their mean
    stands for that over time. Without ``ρ`` the maximum itself, whose gradient is that of the
    largest value.

    Parameters
    ----------
    smooth : ``ρ``, one over the unit of the measure

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("crank")
    >>> crank = system.add(planar.Bar("crank", length=2.0, mass=1.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, crank.start))
    >>> motor = system.add(planar.RotationalDriver("motor", system.ground, crank, da.t))
    >>> motion = da.solve_kinematics(system.build(), 2 * math.pi, outputs=101)
    >>> peak = da.Maximum("crank.end.y", smooth=50.0)  # has a gradient wherever the peak is
    >>> round(da.evaluate(motion, da.Maximum("crank.end.y")), 3), da.evaluate(motion, peak) > 1.9
    (2.0, True)
    """

    smooth: float | None = None
    sign = 1.0

    def __post_init__(self) -> None:
        if self.smooth is not None and not self.smooth > 0:
            raise AnalysisError(f"{self.label}: smooth is {self.smooth}; it must be positive")

    def sampled(self, motion: Result) -> Result:
        scalar_measure(motion, self)  # which names the response where there is no such measure
        if self.smooth is None:
            return motion.analysis.peaks(motion, self.measure, self.sign)
        return motion.analysis.over_peaks(motion, self.measure, self.smooth, self.sign)

    def searches(self, motion: Result) -> bool:
        return self.sampled(motion) is not motion

    def stays(self, motion: Result) -> bool:
        seen = self.sampled(motion)
        return seen is not motion and seen.time[-1] != motion.record.steps.end

    def moves_with(self, motion: Result) -> Occurrence | None:
        return end_by_event(self.sampled(motion))

    def over(self, motion: Result) -> Response:
        if self.smooth is None or not self.searches(motion):
            return self
        rule = rule_over(self.sampled(motion))
        mean = Weighted(self.measure, self.label, rule=rule, over_span=True)
        return SmoothExtreme(
            self.measure, self.label, mean=mean, smooth=self.smooth, sign=self.sign
        )

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        m = self.sign * samples
        top = m.max()
        if self.smooth is not None:
            top += np.log(np.mean(np.exp(self.smooth * (m - top)))) / self.smooth
        return float(self.sign * top)

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        m = self.sign * samples
        if self.smooth is None:
            return np.eye(1, m.size, int(np.argmax(m))).ravel()
        parts = np.exp(self.smooth * (m - m.max()))
        return parts / parts.sum()

    def weights_change(
        self, times: np.ndarray, samples: np.ndarray, change: np.ndarray
    ) -> np.ndarray:
        if self.smooth is None:
            return np.zeros_like(samples)
        weights = self.weights(times, samples)
        return self.sign * self.smooth * weights * (change - weights @ change)


@dataclass(frozen=True)
class Minimum(Maximum):
    """Smallest value, or its smooth upper bound; see ``Maximum``.

    Examples
    --------
    >>> import math
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("crank")
    >>> crank = system.add(planar.Bar("crank", length=2.0, mass=1.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, crank.start))
    >>> motor = system.add(planar.RotationalDriver("motor", system.ground, crank, da.t))
    >>> motion = da.solve_kinematics(system.build(), 2 * math.pi, outputs=101)
    >>> lowest = da.Minimum("crank.end.y", name="lowest")
    >>> lowest.label, round(da.evaluate(motion, lowest), 3)
    ('lowest', -2.0)
    """

    sign = -1.0


@spelled
def maximum(measure: str | Expression, smooth: float | None = None, name: str = "") -> Maximum:
    """Largest value of a measure over the run.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    smooth : ``ρ`` of ``Maximum``, one over the unit of the measure; None for the maximum itself
    name : label; made from the measure if empty

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, 10)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> round(da.evaluate(motion, da.maximum("stone.y")), 6)  # v²/(2 g)
    5.0
    """
    return Maximum(measure, name, smooth)


@spelled
def minimum(measure: str | Expression, smooth: float | None = None, name: str = "") -> Minimum:
    """Smallest value of a measure over the run.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    smooth : ``ρ`` of ``Maximum``, one over the unit of the measure; None for the minimum itself
    name : label; made from the measure if empty

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, 10)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> round(da.evaluate(motion, da.minimum("hypot(stone.vx, stone.vy)")), 6)  # at the top
    3.0
    """
    return Minimum(measure, name, smooth)
