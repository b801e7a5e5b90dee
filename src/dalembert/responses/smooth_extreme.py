"""Smooth bound of a largest or smallest value, by samples and a mean over them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dalembert.responses.base import Response
from dalembert.responses.integrals import Weighted

SAME = 1e-10
"""Spread of samples, relative to the largest, that is round-off."""
UNIFORM = 12.0
"""Square of the range of evenly spread samples, in their variances."""


@dataclass(frozen=True, kw_only=True)
class SmoothExtreme(Response):
    """``± δ ln(wᵀ exp(± m/δ))`` with the weights ``w`` of a mean.

    Parameters
    ----------
    smooth : ``δ``, or its share of the spread ``√12 σ`` of the samples
    relative : whether it is a share
    sign : 1 for the largest value, -1 for the smallest
    mean : over time; over the samples where there is none
    """

    smooth: float
    relative: bool
    sign: float
    mean: Weighted | None = None

    def width(self, times: np.ndarray, samples: np.ndarray) -> float:
        """``δ``; zero where all samples are the same."""
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
        width, m, along = self.width(times, samples), self.sign * samples, self.sign * change
        if not width:
            return np.zeros_like(samples)
        q = self._mean(times, m)
        shares, by_width = _shares(m, q, width)
        widening = self._widening(q, m, width)
        wider = float(widening @ along)
        exponents = (along - (m - m.max()) * wider / width) / width
        shares_change = shares * (exponents - shares @ exponents)
        by_width_change = -float(shares_change @ m) / width
        widening_change = self._widening(q, along, width) - widening * wider / width
        return shares_change + by_width_change * widening + by_width * widening_change

    def time_weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        width, m = self.width(times, samples), self.sign * samples
        if self.mean is None or not width:
            return np.zeros(times.size)
        q, powers = self._mean(times, m), np.exp((m - m.max()) / width)
        found = width * self.mean.time_weights(times, powers) / (q @ powers)
        if self.relative:
            moved = self.mean.time_weights(times, (m - q @ m) ** 2)
            found = found + _shares(m, q, width)[1] * self._share**2 * moved / (2 * width)
        return self.sign * found

    def jump_weight(
        self, times: np.ndarray, samples: np.ndarray, before: float, after: float
    ) -> float:
        width, m = self.width(times, samples), self.sign * samples
        if self.mean is None or not width:
            return super().jump_weight(times, samples, before, after)
        q, top, sides = self._mean(times, m), m.max(), self.sign * np.array([before, after])
        powers, of_sides = np.exp((m - top) / width), np.exp((sides - top) / width)
        found = width * self.mean.jump_weight(times, powers, *of_sides) / float(q @ powers)
        if self.relative:
            mean = q @ m
            moved = self.mean.jump_weight(times, (m - mean) ** 2, *(sides - mean) ** 2)
            found += _shares(m, q, width)[1] * self._share**2 * moved / (2 * width)
        return float(self.sign * found)

    def shares(self, times: np.ndarray) -> np.ndarray:
        return super().shares(times) if self.mean is None else self.mean.shares(times)

    @property
    def _share(self) -> float:
        return self.smooth * float(UNIFORM**0.5)

    def _mean(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        """(K,) weights, of sum 1."""
        if self.mean is None:
            return np.full(samples.size, 1.0 / samples.size)
        return self.mean.weights(times, samples)

    def _widening(self, q: np.ndarray, m: np.ndarray, width: float) -> np.ndarray:
        """(K,) ``∂δ/∂m_k`` at samples ``m``, linear in these."""
        return self._share**2 * q * (m - q @ m) / width if self.relative else np.zeros_like(m)


def _shares(m: np.ndarray, q: np.ndarray, width: float) -> tuple[np.ndarray, float]:
    """``∂R/∂m_k`` with the width held, and ``∂R/∂δ`` with the samples held."""
    over = (m - m.max()) / width
    powers = q * np.exp(over)
    total = float(powers.sum())
    shares = powers / total
    return shares, float(np.log(total) - shares @ over)
