"""Values at instants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.options import options
from dalembert.responses.base import Response
from dalembert.results.result import Result
from dalembert.symbolic.expression import Expression


@dataclass(frozen=True)
class Final(Response):
    """Value at the end of the run."""

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(samples[-1])

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return np.eye(1, samples.size, samples.size - 1).ravel()


@options
class At(Response):
    """Value at a time, or of a load case, mode or point of a path by number.

    Parameters
    ----------
    time : instant within the run [s], or number
    """

    time: float = 0.0

    @property
    def label(self) -> str:
        return self.name or super().label.replace("at(", f"at({self.time:g}, ", 1)

    def sample_times(self, motion: Result) -> np.ndarray | None:
        return np.array([float(self.time)])

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(samples[0])

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return np.ones(1)


def final(measure: str | Expression, name: str = "") -> Final:
    """Value of a measure at the end of the run."""
    return Final(measure, name)


def at(time: float, measure: str | Expression, name: str = "") -> At:
    """Value of a measure at a time [s]; of a load case (from 0) or mode (from 1) by number."""
    return At(measure, name, time)
