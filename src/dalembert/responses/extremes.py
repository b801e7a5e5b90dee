"""Largest and smallest values, exact or smoothed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.analysis.dynamics.event_search import end_by_event
from dalembert.analysis.events import Occurrence
from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.responses.base import Response, scalar_measure
from dalembert.responses.integrals import Weighted
from dalembert.responses.quadrature import rule_over
from dalembert.responses.smooth_extreme import SmoothExtreme
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.spelling import spelled
from dalembert.units.measured import Measured, check_measured


@options
class Maximum(Response):
    """Largest value, or its smooth lower bound (Kreisselmeier and Steinhauser 1979).

    Under error control the largest value of the motion between its first and its last output: its
    instant is located inside the steps, and both sides of impacts and switches count. With fixed
    steps, and of other results, the largest sample.

    With ``smooth``, ``δ ln ( (1/T) ∫ exp(m/δ) dt )`` with the width ``δ``; of K samples their mean
    stands for that over time, and the bound is at most ``δ ln K`` below the largest. A relative
    width is a share of the spread ``√12 σ`` of the measure, with its standard deviation ``σ``: the
    range of a measure that grows evenly, and differentiable as the range of samples is not.
    Gradients contain the change of the spread. Without ``smooth`` the gradient is that of the
    largest value.

    Parameters
    ----------
    smooth : width ``δ``: a number above 0 and at most 1 is relative, 0.02 being a usual value; a
        text with the unit of the measure is absolute, such as ``"5 N"``

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
    >>> peak = da.Maximum("crank.end.y", smooth=0.01)  # has a gradient wherever the peak is
    >>> round(da.evaluate(motion, da.Maximum("crank.end.y")), 3), da.evaluate(motion, peak) > 1.8
    (2.0, True)
    >>> da.evaluate(motion, da.Maximum("crank.end.y", smooth="1 cm")) > 1.95
    True
    """

    smooth: float | None = None
    sign = 1.0

    def __post_init__(self) -> None:
        if self.smooth is None:
            return
        if not self.smooth > 0:
            raise AnalysisError(f"{self.label}: smooth is {self.smooth}; it must be positive")
        if self.smooth > 1 and self.relative:
            raise AnalysisError(
                f"{self.label}: smooth is {self.smooth:g}, but a number is a share of the spread "
                "of the measure, at most 1, such as 0.02; give an absolute width with the unit of "
                f"the measure, such as smooth='{self.smooth:g} N' of a force in newtons"
            )

    @property
    def relative(self) -> bool:
        """Whether the width is a share of the spread, without which it does not smooth."""
        return self.smooth is not None and not isinstance(self.smooth, Measured)

    def sampled(self, motion: Result) -> Result:
        measure = scalar_measure(motion, self)  # names the response where there is no such measure
        if self.smooth is None:
            return motion.analysis.peaks(motion, self.measure, self.sign)
        width = self._smooth().width(motion.time, motion.values(measure))
        if not width:
            return motion
        return motion.analysis.over_peaks(motion, self.measure, 1 / width, self.sign)

    def searches(self, motion: Result) -> bool:
        return self.sampled(motion) is not motion

    def stays(self, motion: Result) -> bool:
        seen = self.sampled(motion)
        return seen is not motion and seen.time[-1] != motion.record.steps.end

    def moves_with(self, motion: Result) -> Occurrence | None:
        return end_by_event(self.sampled(motion))

    def over(self, motion: Result) -> Response:
        if self.smooth is None:
            return self
        if isinstance(self.smooth, Measured):
            unit = motion.expression(self.measure).unit
            check_measured([self.smooth], unit, f"{self.label}.smooth")
        seen = self.sampled(motion)
        if seen is motion:
            return self._smooth()
        return self._smooth(
            Weighted(self.measure, self.label, rule=rule_over(seen), over_span=True)
        )

    def _smooth(self, mean: Weighted | None = None) -> SmoothExtreme:
        return SmoothExtreme(
            self.measure,
            self.label,
            smooth=float(self.smooth or 0.0),
            relative=self.relative,
            sign=self.sign,
            mean=mean,
        )

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        if self.smooth is not None:
            return self._smooth().reduce(times, samples)
        return float(self.sign * (self.sign * samples).max())

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        if self.smooth is not None:
            return self._smooth().weights(times, samples)
        return np.eye(1, samples.size, int(np.argmax(self.sign * samples))).ravel()

    def weights_change(
        self, times: np.ndarray, samples: np.ndarray, change: np.ndarray
    ) -> np.ndarray:
        if self.smooth is not None:
            return self._smooth().weights_change(times, samples, change)
        return np.zeros_like(samples)


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
def maximum(
    measure: str | Expression, smooth: float | str | None = None, name: str = ""
) -> Maximum:
    """Largest value of a measure over the run.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    smooth : width as in ``Maximum``: a share of the spread of the measure, such as 0.02, or with
        the unit of the measure, such as ``"5 N"``; None for the maximum itself
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
    return Maximum(measure, name, smooth)  # type: ignore[arg-type]  # texts are read


@spelled
def minimum(
    measure: str | Expression, smooth: float | str | None = None, name: str = ""
) -> Minimum:
    """Smallest value of a measure over the run.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    smooth : width as in ``Maximum``: a share of the spread of the measure, such as 0.02, or with
        the unit of the measure, such as ``"5 N"``; None for the minimum itself
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
    return Minimum(measure, name, smooth)  # type: ignore[arg-type]
