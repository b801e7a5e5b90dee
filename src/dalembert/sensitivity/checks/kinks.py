"""Responses at a kink: tied extremes, and root mean squares of zero."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.responses.base import Response, scalar_measure
from dalembert.responses.extremes import Maximum
from dalembert.responses.integrals import RMS
from dalembert.responses.smooth_extreme import SAME
from dalembert.results.result import Result
from dalembert.sensitivity.checks.stencils import parameter_scales
from dalembert.sensitivity.registry import engine_of

DIFFERENT = 1e-6
"""Threshold of the difference of gradients, relative to the largest entry [-]."""
REMEDIES = {
    False: "this is that of the first. A width smooth= makes it smooth",
    True: "this is the mean. An absolute width, such as smooth='5 N', makes it smooth",
}
"""Remedies for ties, without smoothing and with a width relative to the spread of the samples."""
COMPARED = 6
"""Maximum number of samples whose gradients are compared."""


@dataclass(frozen=True)
class SampleAt(Response):
    """Single sample of a measure, by its number."""

    index: int = 0

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(samples[self.index])

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return np.eye(1, samples.size, self.index).ravel()


def _slopes(motion: Result, response: Response, samples: np.ndarray, columns) -> np.ndarray:
    """(samples, columns) changes of some samples for changes of 100 % of the parameters."""
    compared = samples[np.unique(np.linspace(0, samples.size - 1, COMPARED).astype(int))]
    responses = [SampleAt(response.measure, f"sample {k}", int(k)) for k in compared]
    gradients = engine_of(motion, responses).adjoint()[:, list(columns)]
    return gradients * parameter_scales(motion, columns)


def ties(motion: Result, response: Response, columns: Sequence[int]) -> str:
    """Note if several samples attain the extreme and have different gradients; else ``""``."""
    if not isinstance(response, Maximum) or not (response.smooth is None or response.relative):
        return ""
    motion = response.sampled(motion)
    m = response.sign * motion.values(scalar_measure(motion, response))
    tied = np.flatnonzero(m >= m.max() - SAME * np.abs(m).max())
    if tied.size < (m.size if response.relative else 2) or m.size < 2:
        return ""
    try:
        slopes = _slopes(motion, response, tied, columns)
    except UnsupportedError:
        return ""
    spread = np.ptp(slopes, axis=0).max()
    if spread <= DIFFERENT * np.abs(slopes).max():
        return ""
    word = "largest" if response.sign > 0 else "smallest"
    return (
        f"{response.label}: {tied.size} samples share the {word} value (first at "
        f"{_instant(motion, tied[0])}, last at {_instant(motion, tied[-1])}) and change "
        f"differently, so that only one-sided derivatives exist; {REMEDIES[response.relative]}"
    )


def _instant(motion: Result, k: int) -> str:
    cases = getattr(motion, "cases", None)
    return f"load case {cases[k]!r}" if cases else f"t = {motion.time[k]:.6g} s"


def refuse_kinks(motion: Result, responses: Sequence[Response], columns: Sequence[int]) -> None:
    """Raise for a root mean square of zero, unless all its samples remain zero.

    Raises
    ------
    AnalysisError
        Names the response and alternatives.
    """
    for response in responses:
        if not isinstance(response, RMS):
            continue
        sampled = response.sampled(motion)
        samples = sampled.values(scalar_measure(sampled, response))
        if samples.any():
            continue
        try:
            varies = bool(_slopes(sampled, response, np.arange(samples.size), columns).any())
        except UnsupportedError:
            varies = True
        if varies:
            raise AnalysisError(
                f"response {response.label} is zero, where a root mean square has a kink and no "
                "gradient; use integral or mean of the square, or other parameter values"
            )
