"""Root mean square of a random vibration."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.options import options
from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.arguments import check_arguments
from dalembert.units.powers import unit_of_density


@options
class RandomRMS(Response):
    """``σ = √∫ S df`` of a spectral density, such as ``"tip.psd"``.

    The nodes of the quadrature follow the resonances; gradients are those of the sum.

    Raises
    ------
    AnalysisError
        White noise over all frequencies has an infinite mean square.

    Examples
    --------
    >>> import dalembert as da
    >>> da.RandomRMS("tip.psd").label
    'randomrms(tip.psd)'
    """

    def sampled(self, motion: Result) -> Result:
        nodes: Result = self._vibration(motion).quadrature[0]
        return nodes

    def has_adaptive_times(self, motion: Result) -> bool:
        return True

    def adapted_to(self, motion: Result) -> Response:
        vibration = self._vibration(motion)
        if reason := vibration.divergence(self.measure):
            raise AnalysisError(f"response {self.label}: the mean square is infinite: {reason}")
        return WeightedRMS(self.measure, self.label, Nodes(vibration.quadrature[1]))

    def _vibration(self, motion: Any) -> Any:
        if not hasattr(motion, "quadrature"):
            raise UnsupportedError(
                f"response {self.label}: it needs a random vibration, by "
                f"analysis=da.RandomResponse(psd=…), not {type(motion).__name__}; over time, use "
                "da.rms"
            )
        return motion

    def unit(self, unit: str) -> str:
        return unit_of_density(unit)


@dataclass(frozen=True, eq=False)
class Nodes:
    """Weights (K,) of the nodes of a quadrature [Hz]."""

    weights: Any = field(default=None)


@dataclass(frozen=True)
class WeightedRMS(RandomRMS):
    """``√Σ w_k S_k`` with fixed weights."""

    nodes: Nodes = field(default_factory=Nodes)

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(np.sqrt(self.nodes.weights @ samples))

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        deviation = self.reduce(times, samples)
        if not deviation:
            return np.zeros(samples.size)
        return np.asarray(self.nodes.weights / (2 * deviation))


@check_arguments
def random_rms(measure: str | Expression, name: str = "") -> RandomRMS:
    """Root mean square of a measure of a random vibration.

    Parameters
    ----------
    measure : name of an output or of a scalar measure, or its density ``"tip.psd"``
    name : label; built from the measure if empty

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("oscillator")
    >>> push = system.input("push", unit="N")
    >>> c = system.parameter("c", 2.0, "N s/m")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(0.5, 0)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    >>> ends = system.ground.center, body.center
    >>> spring = planar.Spring("spring", *ends, stiffness=100.0, damping=c, free_length=0.5)
    >>> parts = system.add(spring), system.add(planar.Force("force", body.center, (push, 0)))
    >>> white = da.RandomResponse(psd={"push": 8.0}, outputs=["body.x"]).run(system.build())
    >>> rms = da.random_rms("body.x")
    >>> round(da.evaluate(white, rms), 9)  # √(S/(4 c k))
    0.1
    >>> round(da.sensitivity(white, rms).sel(parameter="c").item(), 9)  # −σ/(2 c)
    -0.025
    """
    if isinstance(measure, Expression):
        measure = measure.name
    from dalembert.results.harmonic_measures import part_name  # not loaded by other runs

    text = measure if measure.endswith(".psd") else part_name(measure, "psd")
    return RandomRMS(text, name or f"random_rms({measure.removesuffix('.psd')})")
