"""Integrals over the run, by a quadrature of fourth order on the output times."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np

from dalembert.responses.base import Response
from dalembert.results.motion import Motion
from dalembert.symbolic.expression import Expression

SHORT = 1e-3
"""Length of the last interval, relative to the one before, below which the two are one."""


@dataclass(frozen=True)
class Quadrature:
    """``∫ m dt ≈ wᵀ m``: a sum over pieces, each a parabola on one interval.

    Each interval takes the mean of the parabolas through it and its left and its right
    neighbour; two samples make a trapezium. A last interval that is nearly nothing, as an event
    right after an output leaves it, is joined to the one before: weights stay bounded.

    Attributes
    ----------
    count : number of samples
    index : (P, q) samples that each piece goes through
    powers : (P, q, q) powers ``0 … q−1`` of their times, from the beginning of the interval
    shares : (P, q) weight of each in the piece
    """

    count: int
    index: np.ndarray
    powers: np.ndarray
    shares: np.ndarray

    @staticmethod
    def over(times: np.ndarray) -> Quadrature:
        """The quadrature on these times."""
        return _quadrature(np.ascontiguousarray(times, dtype=float).tobytes())

    @cached_property
    def weights(self) -> np.ndarray:
        """(K,) ``w``."""
        weights = np.zeros(self.count)
        np.add.at(weights, self.index, self.shares)
        return weights

    def time_weights(self, samples: np.ndarray) -> np.ndarray:
        """(K,) ``∂(wᵀ m)/∂t_k`` with the samples held.

        A node that moves by ``dt`` changes its parabola ``P`` by ``−P'(t_k) ℓ_k dt``, with ``ℓ_k``
        one there and zero at the other nodes, so each piece by ``−P'(t_k) w_k dt``. The ends of the
        intervals add ``m_k`` and take it away again, but for the first and the last.
        """
        found = np.zeros(self.count)
        if self.count < 2:
            return found
        size = self.index.shape[1]
        order = np.arange(1, size)
        terms = np.linalg.solve(self.powers, samples[self.index][..., None])[..., 0]
        slopes = np.einsum("pij,pj->pi", self.powers[:, :, : size - 1], order * terms[:, 1:])
        np.add.at(found, self.index, -slopes * self.shares)
        found[0] -= samples[0]
        found[-1] += samples[-1]
        return found


@lru_cache(maxsize=64)
def _quadrature(buffer: bytes) -> Quadrature:
    given = np.frombuffer(buffer)
    nodes = np.arange(given.size)
    if given.size > 2 and given[-1] - given[-2] < SHORT * (given[-2] - given[-3]):
        nodes = np.delete(nodes, -2)
    times = given[nodes]
    count, size = times.size, min(times.size, 3)
    begins = np.arange(max(count - 1, 0))
    # the piece on interval k starts at node k, or one before
    both = [(k, k - back) for back in range(max(size - 1, 0)) for k in begins]
    k, left = np.array([(k, j) for k, j in both if 0 <= j <= count - size], int).reshape(-1, 2).T
    index = left[:, None] + np.arange(size)
    powers = (times[index] - times[k][:, None])[..., None] ** np.arange(size)
    moments = np.diff(times)[k][:, None] ** np.arange(1, size + 1) / np.arange(1, size + 1)
    shares = np.linalg.solve(powers.transpose(0, 2, 1), moments[..., None])[..., 0]
    shares /= np.bincount(k, minlength=count)[k][:, None]
    return Quadrature(given.size, nodes[index], powers, shares)


@dataclass(frozen=True)
class OverRun(Response):
    """Something integrated over the run; of modes and load cases, which have nothing between them,
    the sum takes its place.

    Parameters
    ----------
    counted : take the sum
    """

    counted: bool = field(default=False, kw_only=True, repr=False)

    def over(self, motion: Motion) -> Response:
        return self if getattr(motion, "continuous", True) else replace(self, counted=True)


@dataclass(frozen=True)
class Integral(OverRun):
    """``∫ m dt``, or ``Σ m_k`` over modes and load cases."""

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(self.weights(times, samples) @ samples)

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return np.ones(times.size) if self.counted else Quadrature.over(times).weights

    def time_weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return (
            np.zeros(times.size) if self.counted else Quadrature.over(times).time_weights(samples)
        )

    def unit(self, unit: str) -> str:
        return unit if self.counted else f"{unit} s".strip()


@dataclass(frozen=True)
class Mean(OverRun):
    """``(1/T) ∫ m dt``, or the plain mean over modes and load cases."""

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(self.weights(times, samples) @ samples)

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        if self.counted or times.size == 1:
            return np.full(times.size, 1.0 / times.size)
        return Quadrature.over(times).weights / (times[-1] - times[0])

    def time_weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        if self.counted or times.size == 1:
            return np.zeros(times.size)
        found = Quadrature.over(times).time_weights(samples)
        found[[0, -1]] += np.array([1.0, -1.0]) * self.reduce(times, samples)
        return found / (times[-1] - times[0])


@dataclass(frozen=True)
class Rms(OverRun):
    """``√((1/T) ∫ m² dt)``, or the root of the plain mean square over modes and load cases."""

    @property
    def _mean(self) -> Mean:
        return Mean(self.measure, counted=self.counted)

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(np.sqrt(max(self._mean.reduce(times, samples**2), 0.0)))

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        value = self.reduce(times, samples)
        if value == 0.0:  # the root has no slope there; zero is the one-sided choice
            return np.zeros_like(samples)
        return self._mean.weights(times, samples) * samples / value

    def weights_change(
        self, times: np.ndarray, samples: np.ndarray, change: np.ndarray
    ) -> np.ndarray:
        value, own = self.reduce(times, samples), self.weights(times, samples)
        if value == 0.0:
            return np.zeros_like(samples)
        return (self._mean.weights(times, samples) * change - own * (own @ change)) / value

    def time_weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        value = self.reduce(times, samples)
        if value == 0.0:
            return np.zeros_like(samples)
        return self._mean.time_weights(times, samples**2) / (2 * value)


def integral(measure: str | Expression, name: str = "") -> Integral:
    """Integral of a measure over the run."""
    return Integral(measure, name)


def mean(measure: str | Expression, name: str = "") -> Mean:
    """Mean of a measure over the run."""
    return Mean(measure, name)


def rms(measure: str | Expression, name: str = "") -> Rms:
    """Root mean square of a measure over the run."""
    return Rms(measure, name)
