"""Height of one of several resonance peaks."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.options import options
from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.arguments import check_arguments


@options
class Peak(Response):
    """Value of a measure at one of its local maxima over the frequency.

    The maxima are located between the frequencies of the result. Each peak is a differentiable
    function of the parameters, in contrast to the highest one, ``Maximum``.

    Parameters
    ----------
    number : of the peak, from 1, by increasing frequency

    Raises
    ------
    AnalysisError
        There are fewer peaks.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("oscillator")
    >>> push = system.input("push", unit="N")
    >>> body = system.add(planar.Particle("body", mass=1.0, position=(0.5, 0)))
    >>> rail = system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    >>> ends = system.ground.center, body.center
    >>> spring = planar.Spring("spring", *ends, stiffness=100.0, damping=2.0, free_length=0.5)
    >>> parts = system.add(spring), system.add(planar.Force("force", body.center, (push, 0)))
    >>> response = da.frequency_response(system.build(), outputs=["body.x"])
    >>> peak = da.Peak("body.x.amplitude", number=1)
    >>> round(da.evaluate(response, peak) * 20 * 0.99**0.5, 9)  # 1/(2 D k √(1 − D²)), D = 0.1
    1.0
    """

    number: int = 1

    def __post_init__(self) -> None:
        if self.number < 1:
            raise AnalysisError(f"{type(self).__name__}: number is {self.number}; count from 1")

    @property
    def label(self) -> str:
        return self.name or super().label.replace("peak(", f"peak({self.number}, ", 1)

    def sampled(self, motion: Result) -> Result:
        analysis: Any = motion.analysis
        if not hasattr(analysis, "maxima"):
            kind = type(motion).__name__
            raise UnsupportedError(
                f"response {self.label}: peaks are those of a frequency response, this is {kind}; "
                "use da.maximum"
            )
        return analysis.maxima(motion, self.measure)  # type: ignore[no-any-return]

    def has_adaptive_times(self, motion: Result) -> bool:
        return True

    def reduction(self, times: np.ndarray) -> dict[str, Any]:
        return {"kind": "peak", "number": self.number}

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(samples[self._place(times, samples)])

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return np.eye(1, samples.size, self._place(times, samples)).ravel()

    def _place(self, times: np.ndarray, samples: np.ndarray) -> int:
        if self.number > samples.size:
            listed = ", ".join(f"{f:.6g} Hz" for f in times) or "none"
            raise AnalysisError(
                f"response {self.label}: there is no peak number {self.number} (peaks: {listed})"
            )
        return self.number - 1


@check_arguments
def peak(number: int, measure: str | Expression, name: str = "") -> Peak:
    """Value of a measure at its local maximum of this number, by increasing frequency.

    Parameters
    ----------
    number : from 1
    measure : name, formula or Expression; scalar
    name : label; built from the measure if empty

    Examples
    --------
    >>> import dalembert as da
    >>> da.peak(2, "tip.amplitude").label
    'peak(2, tip.amplitude)'
    """
    return Peak(measure, name, number)
