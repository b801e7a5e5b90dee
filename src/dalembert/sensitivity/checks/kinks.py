"""Responses at a kink: where the largest sample is not one, or a root mean square is zero."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError, UnsupportedError
from dalembert.responses.base import Response, scalar_measure
from dalembert.responses.extremes import Maximum
from dalembert.responses.integrals import Rms
from dalembert.responses.smooth_extreme import SAME
from dalembert.results.result import Result
from dalembert.sensitivity.checks.scales import parameter_scales
from dalembert.sensitivity.registry import engine_of

DIFFERENT = 1e-6
"""Difference of gradients, relative to the largest entry, that is one."""
CURES = {
    False: "this is that of the first. A width smooth= makes it smooth",
    True: "this is the mean. An absolute width, such as smooth='5 N', makes it smooth",
}
"""What to do about ties, of a width relative to the spread of the samples or of none."""
PICKED = 6
"""Samples whose gradients are compared."""


@dataclass(frozen=True)
class Picked(Response):
    """One sample of a measure, by its number."""

    index: int = 0

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(samples[self.index])

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return np.eye(1, samples.size, self.index).ravel()


def _slopes(motion: Result, response: Response, samples: np.ndarray, columns) -> np.ndarray:
    """(samples, columns) changes of some samples for changes of 100 % of the parameters."""
    few = samples[np.unique(np.linspace(0, samples.size - 1, PICKED).astype(int))]
    picked = [Picked(response.measure, f"sample {k}", int(k)) for k in few]
    found = engine_of(motion, picked).adjoint()[:, list(columns)]
    return found * parameter_scales(motion, columns)


def ties(motion: Result, response: Response, columns: Sequence[int]) -> str:
    """What to say where several samples are the largest and change differently; else nothing."""
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
    apart = np.ptp(slopes, axis=0).max()
    if apart <= DIFFERENT * np.abs(slopes).max():
        return ""
    word = "largest" if response.sign > 0 else "smallest"
    return (
        f"{response.label}: {tied.size} samples share the {word} value (first at "
        f"{_instant(motion, tied[0])}, last at {_instant(motion, tied[-1])}) and change "
        f"differently, so that only one-sided derivatives exist; {CURES[response.relative]}"
    )


def _instant(motion: Result, k: int) -> str:
    cases = getattr(motion, "cases", None)
    return f"load case {cases[k]!r}" if cases else f"t = {motion.time[k]:.6g} s"


def refuse_kinks(motion: Result, responses: Sequence[Response], columns: Sequence[int]) -> None:
    """A root mean square of zero has no gradient unless all its samples stay zero.

    Raises
    ------
    AnalysisError
        Names the response and what to use instead.
    """
    for response in responses:
        if not isinstance(response, Rms):
            continue
        seen = response.sampled(motion)
        samples = seen.values(scalar_measure(seen, response))
        if samples.any():
            continue
        try:
            moves = bool(_slopes(seen, response, np.arange(samples.size), columns).any())
        except UnsupportedError:
            moves = True
        if moves:
            raise AnalysisError(
                f"response {response.label} is zero, where a root mean square has a kink and no "
                "gradient; use integral or mean of the square, or other parameter values"
            )
