"""Finite differences of the discrete run: same steps, same branch, other parameters."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.responses.base import Response, evaluate
from dalembert.results.motion import Motion

SCHEMES = ("forward", "backward", "central", "richardson")


@dataclass(frozen=True)
class FiniteDifference:
    """Difference quotients ``(R(p + h) − R(p))/h`` and their relatives.

    Parameters
    ----------
    scheme : forward, backward, central, or richardson (central, extrapolated to fourth order)
    step : relative to ``max(|p|, 1)`` of each parameter
    """

    scheme: str = "richardson"
    step: float = 1e-5

    def __post_init__(self) -> None:
        if self.scheme not in SCHEMES:
            raise UnsupportedError(
                f"scheme {self.scheme!r} is unknown; choose one of {', '.join(SCHEMES)}"
            )
        if not self.step > 0:
            raise UnsupportedError(f"step is {self.step}; it must be positive")

    def gradient(
        self, motion: Motion, responses: Sequence[Response], columns: Sequence[int]
    ) -> np.ndarray:
        """(responses, columns) difference quotients."""
        centre = self._values(motion, responses, motion.parameters)
        rows = [self._column(motion, responses, i, centre) for i in columns]
        return np.array(rows).T.reshape(len(responses), len(columns))

    def _column(self, motion, responses, i: int, centre: np.ndarray) -> np.ndarray:
        h = self.step * max(abs(motion.parameters[i]), 1.0)

        def shifted(by: float) -> np.ndarray:
            p = motion.parameters.copy()
            p[i] += by
            return self._values(motion, responses, p)

        def central(width: float) -> np.ndarray:
            return (shifted(width) - shifted(-width)) / (2 * width)

        if self.scheme == "forward":
            return (shifted(h) - centre) / h
        if self.scheme == "backward":
            return (centre - shifted(-h)) / h
        if self.scheme == "central":
            return central(h)
        return (4 * central(h / 2) - central(h)) / 3

    @staticmethod
    def _values(motion: Motion, responses: Sequence[Response], p: np.ndarray) -> np.ndarray:
        repeated = motion.analysis.replay(motion, p)
        return np.array([evaluate(repeated, r) for r in responses])
