"""Integrals over the run, by a quadrature of fourth order on the output times."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from dalembert.responses.base import Response
from dalembert.symbolic.expression import Expression


def quadrature_weights(times: np.ndarray) -> np.ndarray:
    """Weights ``w`` with ``∫ m dt ≈ wᵀ m``.

    Each interval takes the mean of the parabolas through it and its left and its right
    neighbour; two samples make a trapezium.
    """
    return _weights(np.ascontiguousarray(times, dtype=float).tobytes())


@lru_cache(maxsize=64)
def _weights(buffer: bytes) -> np.ndarray:
    times = np.frombuffer(buffer)
    count = times.size
    h = np.diff(times)
    weights = np.zeros(count)
    if count == 1:
        return weights
    if count == 2:
        return np.full(2, h[0] / 2)
    for k in range(count - 1):
        parabolas = [j for j in (k - 1, k) if 0 <= j <= count - 3]
        for j in parabolas:
            nodes = times[j : j + 3] - times[k]
            moments = [h[k], h[k] ** 2 / 2, h[k] ** 3 / 3]
            weights[j : j + 3] += np.linalg.solve(np.vander(nodes, 3, True).T, moments) / len(
                parabolas
            )
    return weights


@dataclass(frozen=True)
class Integral(Response):
    """``∫ m dt``."""

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(quadrature_weights(times) @ samples)

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return quadrature_weights(times)

    def unit(self, unit: str) -> str:
        return f"{unit} s".strip()


@dataclass(frozen=True)
class Mean(Response):
    """``(1/T) ∫ m dt``."""

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(self.weights(times, samples) @ samples)

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        if times.size == 1:
            return np.ones(1)
        return quadrature_weights(times) / (times[-1] - times[0])


@dataclass(frozen=True)
class Rms(Response):
    """``√((1/T) ∫ m² dt)``."""

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(np.sqrt(max(Mean(self.measure).reduce(times, samples**2), 0.0)))

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        value = self.reduce(times, samples)
        if value == 0.0:  # the root has no slope there; zero is the one-sided choice
            return np.zeros_like(samples)
        return Mean(self.measure).weights(times, samples) * samples / value


def integral(measure: str | Expression, name: str = "") -> Integral:
    """Integral of a measure over the run."""
    return Integral(measure, name)


def mean(measure: str | Expression, name: str = "") -> Mean:
    """Mean of a measure over the run."""
    return Mean(measure, name)


def rms(measure: str | Expression, name: str = "") -> Rms:
    """Root mean square of a measure over the run."""
    return Rms(measure, name)
