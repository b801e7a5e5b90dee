"""Integrals, means and sums over a run.

Integrals are evaluated on the steps of the run, not on its outputs. Steps of high order or of
varying length are sampled at interior points (``StepQuadrature``), other steps at their ends. Modes
and load cases are discrete; sums replace integrals there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.analysis.dynamics.event_search import end_by_event
from dalembert.analysis.events import Occurrence
from dalembert.responses.base import Response
from dalembert.responses.quadrature import (
    Count,
    Quadrature,
    RootOfSquares,
    Rule,
    Weighted,
    rule_over,
)
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.arguments import check_arguments


@dataclass(frozen=True)
class OverRun(Response):
    """Base class of responses that are integrals over the run."""

    def by(self, rule: Rule) -> Response:
        """The response with the weights of a quadrature rule."""
        raise NotImplementedError

    def sampled(self, motion: Result) -> Result:
        return motion.over_steps

    def adapted_to(self, motion: Result) -> Response:
        return self.by(rule_over(self.sampled(motion)))

    def final_event(self, motion: Result) -> Occurrence | None:
        return end_by_event(self.sampled(motion))

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return self.by(Quadrature.over(times)).reduce(times, samples)

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return self.by(Quadrature.over(times)).weights(times, samples)

    def time_weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return self.by(Quadrature.over(times)).time_weights(times, samples)


@dataclass(frozen=True)
class Integral(OverRun):
    """``∫ m dt`` over the run, or ``Σ m_k`` over modes and load cases.

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
    >>> way = da.Integral("crank.end.speed", name="way")
    >>> round(da.evaluate(motion, way) / (2 * math.pi), 6)  # per radian: the length
    2.0
    """

    def reduction(self, times: np.ndarray) -> dict[str, Any]:
        return {"kind": "integral"}

    def by(self, rule: Rule) -> Response:
        return Weighted(self.measure, self.label, rule=rule)


@dataclass(frozen=True)
class Mean(OverRun):
    """``(1/T) ∫ m dt`` over the run, or the arithmetic mean over modes and load cases.

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
    >>> round(da.evaluate(motion, da.Mean("crank.end.y**2")), 6)  # l²/2
    2.0
    """

    def reduction(self, times: np.ndarray) -> dict[str, Any]:
        return {"kind": "mean"}

    def by(self, rule: Rule) -> Response:
        rule = rule if rule.weights.size > 1 else Count(1)  # the mean of one sample is its value
        return Weighted(self.measure, self.label, rule=rule, over_span=True)


@dataclass(frozen=True)
class RMS(OverRun):
    """``√((1/T) ∫ m² dt)``, or the root mean square over modes and load cases.

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
    >>> round(da.evaluate(motion, da.RMS("crank.end.y"))**2, 6)  # l²/2
    2.0
    """

    def reduction(self, times: np.ndarray) -> dict[str, Any]:
        return {"kind": "rms"}

    def by(self, rule: Rule) -> Response:
        rule = rule if rule.weights.size > 1 else Count(1)
        mean = Weighted(self.measure, self.label, rule=rule, over_span=True)
        return RootOfSquares(self.measure, self.label, mean=mean)


@dataclass(frozen=True)
class Total(Response):
    """``Σ m_k`` over the outputs, or over modes and load cases, with unit weights.

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
    >>> round(da.evaluate(motion, da.Total("crank.end.y**2 + crank.end.x**2")), 6)  # 101 of l²
    404.0
    """

    def reduction(self, times: np.ndarray) -> dict[str, Any]:
        return {"kind": "sum"}

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(samples.sum())

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return np.ones(times.size)


@check_arguments
def integral(measure: str | Expression, name: str = "") -> Integral:
    """Integral of a measure over the run.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    name : label; built from the measure if empty

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, 10)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> round(da.evaluate(motion, da.integral("stone.vx")), 6)  # distance
    6.0
    """
    return Integral(measure, name)


@check_arguments
def mean(measure: str | Expression, name: str = "") -> Mean:
    """Mean of a measure over the run.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    name : label; built from the measure if empty

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, 10)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> round(da.evaluate(motion, da.mean("stone.vy")), 6) + 0.0  # symmetric about the top
    0.0
    """
    return Mean(measure, name)


@check_arguments
def rms(measure: str | Expression, name: str = "") -> RMS:
    """Root mean square of a measure over the run.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    name : label; built from the measure if empty

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, 10)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> round(da.evaluate(motion, da.rms("stone.vx")), 6)
    3.0
    """
    return RMS(measure, name)


@check_arguments
def total(measure: str | Expression, name: str = "") -> Total:
    """Sum of a measure over the outputs, such as squared distances to points of a path.

    Parameters
    ----------
    measure : name, formula or Expression; scalar
    name : label; built from the measure if empty

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0, velocity=(3, 10)))
    >>> motion = da.solve_dynamics(system.build(), 2.0, step=0.1)
    >>> off = da.total("(stone.y - 5)**2")  # squared distances from a line
    >>> round(da.evaluate(motion, off), 6) == round(float(((motion["stone.y"] - 5)**2).sum()), 6)
    True
    """
    return Total(measure, name)
