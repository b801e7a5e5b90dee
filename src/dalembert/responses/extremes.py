"""Maximum and minimum of a measure, exact or smoothed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.analysis.dynamics.event_search import end_by_event
from dalembert.analysis.events import Occurrence
from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.responses.base import Response, scalar_measure
from dalembert.responses.quadrature import Weighted, rule_over
from dalembert.responses.smooth_extreme import SmoothExtreme
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.arguments import check_arguments
from dalembert.units.measured import Measured, check_measured


@options
class Maximum(Response):
    """Maximum, or its smooth lower bound (Kreisselmeier and Steinhauser 1979).

    For runs with error control, the maximum of the motion between the first and the last output:
    its instant is located inside the steps, and the values on both sides of impacts and switches
    are considered. For fixed steps and for other results, the largest sample.

    With ``smooth``, ``δ ln ( (1/T) ∫ exp(m/δ) dt )`` with the width ``δ``. For K samples, their
    mean replaces the mean over time, and the bound is at most ``δ ln K`` below the maximum. A
    relative width is a fraction of the spread ``√12 σ`` of the measure with standard deviation
    ``σ``: the spread is the range of a measure that grows linearly in time and, unlike the range of
    samples, is differentiable. Gradients contain the derivative of the spread. Without ``smooth``,
    the gradient is that of the largest value.

    Parameters
    ----------
    smooth : width ``δ``: a number above 0 and at most 1 is relative, typically 0.02; a
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
    >>> peak = da.Maximum("crank.end.y", smooth=0.01)  # differentiable wherever the peak is
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
        """Whether the width is a fraction of the spread of the measure."""
        return self.smooth is not None and not isinstance(self.smooth, Measured)

    def sampled(self, motion: Result) -> Result:
        measure = scalar_measure(motion, self)  # error with the label if there is no such measure
        if self.smooth is None:
            return motion.analysis.peaks(motion, self.measure, self.sign)
        width = self._smooth().width(motion.time, motion.values(measure))
        if not width:
            return motion
        return motion.analysis.over_peaks(motion, self.measure, 1 / width, self.sign)

    def has_adaptive_times(self, motion: Result) -> bool:
        return self.sampled(motion) is not motion

    def has_fixed_times(self, motion: Result) -> bool:
        sampled = self.sampled(motion)
        return sampled is not motion and sampled.time[-1] != motion.record.steps.end

    def final_event(self, motion: Result) -> Occurrence | None:
        return end_by_event(self.sampled(motion))

    def adapted_to(self, motion: Result) -> Response:
        if self.smooth is None:
            return self
        if isinstance(self.smooth, Measured):
            unit = motion.expression(self.measure).unit
            check_measured([self.smooth], unit, f"{self.label}.smooth")
        sampled = self.sampled(motion)
        if sampled is motion:
            return self._smooth()
        return self._smooth(
            Weighted(self.measure, self.label, rule=rule_over(sampled), over_span=True)
        )

    def reduction(self, times: np.ndarray) -> dict[str, Any]:
        if self.smooth is None:
            return {"kind": "maximum" if self.sign > 0 else "minimum"}
        width = {"smooth": float(self.smooth), "relative": self.relative}
        return {"kind": "smooth", "sign": self.sign} | width

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
    """Minimum, or its smooth upper bound; see ``Maximum``.

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


@check_arguments
def maximum(
    measure: str | Expression, smooth: float | str | None = None, name: str = ""
) -> Maximum:
    """Maximum of a measure over the run.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    smooth : width as in ``Maximum``: a fraction of the spread of the measure, such as 0.02, or with
        the unit of the measure, such as ``"5 N"``; None for the exact maximum
    name : label; built from the measure if empty

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
    return Maximum(measure, name, smooth)  # type: ignore[arg-type]  # texts are parsed


@check_arguments
def minimum(
    measure: str | Expression, smooth: float | str | None = None, name: str = ""
) -> Minimum:
    """Minimum of a measure over the run.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    smooth : width as in ``Maximum``: a fraction of the spread of the measure, such as 0.02, or with
        the unit of the measure, such as ``"5 N"``; None for the exact minimum
    name : label; built from the measure if empty

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
