"""Kreisselmeier–Steinhauser function of samples: a smooth bound of an extreme value."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.responses.base import Response
from dalembert.responses.quadrature import Weighted

SAME = 1e-10
"""Threshold for a spread that is round-off, relative to the largest sample."""
UNIFORM = 12.0
"""Squared range of a uniform distribution divided by its variance."""


@dataclass(frozen=True, kw_only=True)
class SmoothExtreme(Response):
    """``± δ ln(wᵀ exp(± m/δ))`` with the weights ``w`` of a mean.

    Parameters
    ----------
    smooth : ``δ``, or its ratio to the spread ``√12 σ`` of the samples
    relative : whether ``smooth`` is the ratio
    sign : 1 for the maximum, -1 for the minimum
    mean : mean over time; None for the arithmetic mean of the samples
    """

    smooth: float
    relative: bool
    sign: float
    mean: Weighted | None = None

    def width(self, times: np.ndarray, samples: np.ndarray) -> float:
        """``δ``; zero if all samples are equal."""
        if not self.relative:
            return self.smooth
        q, m = self._mean(times, samples), self.sign * samples
        spread = float(np.sqrt(max(float(q @ (m - q @ m) ** 2), 0.0)))
        return self._share * spread if spread > SAME * np.abs(m).max() else 0.0

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        width, m = self.width(times, samples), self.sign * samples
        top = float(m.max())
        if width:
            top += width * float(np.log(self._mean(times, m) @ np.exp((m - top) / width)))
        return self.sign * top

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        width, m = self.width(times, samples), self.sign * samples
        if not width:
            return self._mean(times, m)
        q = self._mean(times, m)
        shares, by_width = _shares(m, q, width)
        return shares + by_width * self._widening(q, m, width)

    def weights_change(
        self, times: np.ndarray, samples: np.ndarray, change: np.ndarray
    ) -> np.ndarray:
        width, m, m_change = self.width(times, samples), self.sign * samples, self.sign * change
        if not width:
            return np.zeros_like(samples)
        q = self._mean(times, m)
        shares, by_width = _shares(m, q, width)
        widening = self._widening(q, m, width)
        width_change = float(widening @ m_change)
        exponents = (m_change - (m - m.max()) * width_change / width) / width
        shares_change = shares * (exponents - shares @ exponents)
        by_width_change = -float(shares_change @ m) / width
        widening_change = self._widening(q, m_change, width) - widening * width_change / width
        return shares_change + by_width_change * widening + by_width * widening_change

    def time_weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        width, m = self.width(times, samples), self.sign * samples
        if self.mean is None or not width:
            return np.zeros(times.size)
        q, powers = self._mean(times, m), np.exp((m - m.max()) / width)
        weights = width * self.mean.time_weights(times, powers) / (q @ powers)
        if self.relative:
            variance_weights = self.mean.time_weights(times, (m - q @ m) ** 2)
            weights = weights + _shares(m, q, width)[1] * self._share**2 * variance_weights / (
                2 * width
            )
        return self.sign * weights

    def jump_weight(
        self, times: np.ndarray, samples: np.ndarray, before: float, after: float
    ) -> float:
        width, m = self.width(times, samples), self.sign * samples
        if self.mean is None or not width:
            return super().jump_weight(times, samples, before, after)
        q, top, sides = self._mean(times, m), m.max(), self.sign * np.array([before, after])
        powers, side_powers = np.exp((m - top) / width), np.exp((sides - top) / width)
        weight = width * self.mean.jump_weight(times, powers, *side_powers) / float(q @ powers)
        if self.relative:
            mean = q @ m
            variance_weight = self.mean.jump_weight(times, (m - mean) ** 2, *(sides - mean) ** 2)
            weight += _shares(m, q, width)[1] * self._share**2 * variance_weight / (2 * width)
        return float(self.sign * weight)

    def time_derivatives(self, times: np.ndarray) -> np.ndarray:
        return (
            super().time_derivatives(times)
            if self.mean is None
            else self.mean.time_derivatives(times)
        )

    @property
    def _share(self) -> float:
        return self.smooth * float(UNIFORM**0.5)

    def _mean(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        """(K,) weights with sum 1."""
        if self.mean is None:
            return np.full(samples.size, 1.0 / samples.size)
        return self.mean.weights(times, samples)

    def _widening(self, q: np.ndarray, m: np.ndarray, width: float) -> np.ndarray:
        """(K,) ``∂δ/∂m_k``, linear in the samples ``m``."""
        return self._share**2 * q * (m - q @ m) / width if self.relative else np.zeros_like(m)


def _shares(m: np.ndarray, q: np.ndarray, width: float) -> tuple[np.ndarray, float]:
    """``∂R/∂m_k`` at fixed width, and ``∂R/∂δ`` at fixed samples."""
    exponents = (m - m.max()) / width
    powers = q * np.exp(exponents)
    total = float(powers.sum())
    shares = powers / total
    return shares, float(np.log(total) - shares @ exponents)
