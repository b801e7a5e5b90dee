"""Largest and smallest values, exact or smoothed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.spelling import spelled
from dalembert.units.measured import Measured, check_measured


SAME = 1e-10
"""Spread of samples, relative to the largest, that is round-off."""
UNIFORM = 12.0
"""Square of the range of evenly spread samples, in their variances."""


@options
class Maximum(Response):
    """Largest sample, or its smooth lower bound (Kreisselmeier and Steinhauser 1979).

    ``δ ln ( (1/K) Σ exp(m_k/δ) )`` with the width ``δ`` is at most ``δ ln K`` below the largest of
    the K samples. Without ``smooth`` it is the largest sample itself, whose gradient is that of this
    sample. A relative width is a share of the spread ``√12 σ`` of the samples, with their standard
    deviation ``σ``: the range of a measure that grows evenly, and differentiable as the range of
    the samples is not. Gradients contain the change of the spread.

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
    >>> round(da.evaluate(motion, da.Maximum("crank.end.y")), 3), da.evaluate(motion, peak) > 1.9
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
        if self.smooth > 1 and not isinstance(self.smooth, Measured):
            raise AnalysisError(
                f"{self.label}: smooth is {self.smooth:g}, but a number is a share of the spread of "
                f"the measure, at most 1, such as 0.02; give an absolute width with the unit of the "
                f"measure, such as '{1 / self.smooth:.3g} m'"
            )

    def over(self, motion: Result) -> Response:
        if isinstance(self.smooth, Measured):
            unit = motion.expression(self.measure).unit
            check_measured([self.smooth], unit, f"{self.label}.smooth")
        return self

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        m = self.sign * samples
        width = self._width(m)
        top = float(m.max())
        if width:
            top += width * float(np.log(np.mean(np.exp((m - top) / width))))
        return self.sign * top

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        m = self.sign * samples
        if self.smooth is None:
            return np.eye(1, m.size, int(np.argmax(m))).ravel()
        width = self._width(m)
        if not width:
            return np.full(m.size, 1 / m.size)
        shares = _shares(m, width)
        return shares + self._by_width(m, width, shares) * self._widening(m, width)

    def weights_change(
        self, times: np.ndarray, samples: np.ndarray, change: np.ndarray
    ) -> np.ndarray:
        m, along = self.sign * samples, self.sign * change
        width = self._width(m)
        if not width:
            return np.zeros_like(samples)
        shares, widening = _shares(m, width), self._widening(m, width)
        by_width, wider = self._by_width(m, width, shares), float(widening @ along)
        exponents = (along - (m - m.max()) * wider / width) / width
        shares_change = shares * (exponents - shares @ exponents)
        by_width_change = -float(shares_change @ m) / width
        widening_change = self._widening(along, width) - widening * wider / width
        return shares_change + by_width_change * widening + by_width * widening_change

    @property
    def relative(self) -> bool:
        """Whether the width is a share of the spread, without which it does not smooth."""
        return self.smooth is not None and not self._absolute

    @property
    def _absolute(self) -> bool:
        return isinstance(self.smooth, Measured)

    @property
    def _share(self) -> float:
        return float(self.smooth or 0.0) * float(UNIFORM**0.5)

    def _width(self, m: np.ndarray) -> float:
        """``δ``; zero where nothing is smoothed."""
        if self.smooth is None or self._absolute:
            return float(self.smooth or 0.0)
        spread = float(np.std(m))
        return self._share * spread if spread > SAME * np.abs(m).max() else 0.0

    def _widening(self, m: np.ndarray, width: float) -> np.ndarray:
        """(K,) ``∂δ/∂m_k``."""
        if self._absolute:
            return np.zeros_like(m)
        return self._share**2 * (m - m.mean()) / (m.size * width)

    @staticmethod
    def _by_width(m: np.ndarray, width: float, shares: np.ndarray) -> float:
        """``∂R/∂δ`` with the samples held."""
        top = m.max()
        return float(np.log(np.mean(np.exp((m - top) / width))) - shares @ (m - top) / width)


def _shares(m: np.ndarray, width: float) -> np.ndarray:
    parts = np.exp((m - m.max()) / width)
    return parts / parts.sum()


@dataclass(frozen=True)
class Minimum(Maximum):
    """Smallest sample, or its smooth upper bound.

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
def maximum(measure: str | Expression, smooth: float | str | None = None, name: str = "") -> Maximum:
    """Largest value of a measure over the run.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    smooth : width as in ``Maximum``: a share of the spread of the measure, such as 0.02, or with the
        unit of the measure, such as ``"5 N"``; None for the maximum itself
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
def minimum(measure: str | Expression, smooth: float | str | None = None, name: str = "") -> Minimum:
    """Smallest value of a measure over the run.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    smooth : width as in ``Maximum``: a share of the spread of the measure, such as 0.02, or with the
        unit of the measure, such as ``"5 N"``; None for the minimum itself
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
