"""Quadrature rules for integrals over a run from samples of a measure, and reductions with them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Protocol

import numpy as np

from dalembert.analysis.dynamics.step_quadrature import StepQuadrature
from dalembert.responses.base import Response
from dalembert.results.result import Result

SHORT = 1e-3
"""Threshold for joining the last interval to the one before, relative to its length."""


class Rule(Protocol):
    """Quadrature rule ``Σ w_k m_k`` and its derivatives by the sampling times.

    Attributes
    ----------
    weights : (K,) ``w``
    time_derivatives : (K,) ``∂t_k/∂t_K``, shift of each sampling time per shift of the last one
    span, span_weights : sum of the weights, and its (K,) derivatives by the times
    continuous : whether the sum approximates an integral over time
    """

    @property
    def weights(self) -> np.ndarray: ...
    @property
    def time_derivatives(self) -> np.ndarray: ...
    @property
    def span(self) -> float: ...
    @property
    def span_weights(self) -> np.ndarray: ...
    @property
    def continuous(self) -> bool: ...
    def time_weights(self, samples: np.ndarray) -> np.ndarray:
        """(K,) ``∂(wᵀ m)/∂t_k`` at fixed samples."""
        ...


@dataclass(frozen=True)
class Count:
    """Unit weights, for modes, load cases and outputs."""

    count: int
    continuous = False

    @property
    def weights(self) -> np.ndarray:
        return np.ones(self.count)

    @property
    def time_derivatives(self) -> np.ndarray:
        return np.eye(1, self.count, self.count - 1).ravel()

    @property
    def span(self) -> float:
        return float(self.count)

    @property
    def span_weights(self) -> np.ndarray:
        return np.zeros(self.count)

    def time_weights(self, samples: np.ndarray) -> np.ndarray:
        return np.zeros(self.count)


def rule_over(motion: Result) -> Rule:
    """The quadrature rule for the samples of a motion."""
    if not motion.continuous:
        return Count(motion.time.size)
    step_quadrature: StepQuadrature | None = getattr(motion.record, "quadrature", None)
    return Quadrature.over(motion.time) if step_quadrature is None else step_quadrature


@dataclass(frozen=True)
class Quadrature:
    """``∫ m dt ≈ wᵀ m`` from samples at fixed times: piecewise parabolas on the intervals.

    Each interval uses the mean of the two parabolas through it and its left or right neighbour;
    two samples give the trapezoidal rule. A very short last interval, as left by an event right
    after an output, is joined to the one before, so that the weights stay bounded.

    Attributes
    ----------
    count : number of samples
    span : time from the first sample to the last [s]
    index : (P, q) samples interpolated by each parabola
    powers : (P, q, q) powers ``0 … q−1`` of their times, relative to the start of the interval
    parts : (P, q) weights of these samples
    """

    count: int
    span: float
    index: np.ndarray
    powers: np.ndarray
    parts: np.ndarray

    @staticmethod
    def over(times: np.ndarray) -> Quadrature:
        """The quadrature rule for these times, cached."""
        return _quadrature(np.ascontiguousarray(times, dtype=float).tobytes())

    continuous = True

    @property
    def time_derivatives(self) -> np.ndarray:
        return np.eye(1, self.count, self.count - 1).ravel()

    @property
    def span_weights(self) -> np.ndarray:
        weights = np.zeros(self.count)
        weights[-1] += 1.0
        weights[0] -= 1.0
        return weights

    @cached_property
    def weights(self) -> np.ndarray:
        """(K,) ``w``."""
        weights = np.zeros(self.count)
        np.add.at(weights, self.index, self.parts)
        return weights

    def time_weights(self, samples: np.ndarray) -> np.ndarray:
        """(K,) ``∂(wᵀ m)/∂t_k`` at fixed samples.

        A shift ``dt`` of a node changes its parabola ``P`` by ``−P'(t_k) ℓ_k dt``, with the
        Lagrange polynomial ``ℓ_k`` of the node, so each integral by ``−P'(t_k) w_k dt``. The
        contributions ``m_k`` of the interval ends cancel, except at the first and the last node.
        """
        weights = np.zeros(self.count)
        if self.count < 2:
            return weights
        size = self.index.shape[1]
        order = np.arange(1, size)
        coefficients = np.linalg.solve(self.powers, samples[self.index][..., None])[..., 0]
        slopes = np.einsum("pij,pj->pi", self.powers[:, :, : size - 1], order * coefficients[:, 1:])
        np.add.at(weights, self.index, -slopes * self.parts)
        weights[0] -= samples[0]
        weights[-1] += samples[-1]
        return weights


@lru_cache(maxsize=64)
def _quadrature(buffer: bytes) -> Quadrature:
    all_times = np.frombuffer(buffer)
    nodes = np.arange(all_times.size)
    if all_times.size > 2 and all_times[-1] - all_times[-2] < SHORT * (
        all_times[-2] - all_times[-3]
    ):
        nodes = np.delete(nodes, -2)
    times = all_times[nodes]
    count, size = times.size, min(times.size, 3)
    intervals = np.arange(max(count - 1, 0))
    # the parabola on interval k starts at node k, or one before
    candidates = [(k, k - back) for back in range(max(size - 1, 0)) for k in intervals]
    k, left = (
        np.array([(k, j) for k, j in candidates if 0 <= j <= count - size], int).reshape(-1, 2).T
    )
    index = left[:, None] + np.arange(size)
    powers = (times[index] - times[k][:, None])[..., None] ** np.arange(size)
    moments = np.diff(times)[k][:, None] ** np.arange(1, size + 1) / np.arange(1, size + 1)
    parts = np.linalg.solve(powers.transpose(0, 2, 1), moments[..., None])[..., 0]
    parts /= np.bincount(k, minlength=count)[k][:, None]
    return Quadrature(
        all_times.size, float(all_times[-1] - all_times[0]), nodes[index], powers, parts
    )


@dataclass(frozen=True, kw_only=True)
class Weighted(Response):
    """``wᵀ m`` with the weights of a quadrature rule; divided by its span, a mean."""

    rule: Rule
    over_span: bool = False

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(self.weights(times, samples) @ samples)

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        return self.rule.weights / (self.rule.span if self.over_span else 1.0)

    def time_weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        weights = self.rule.time_weights(samples)
        if not self.over_span:
            return weights
        span_change = self.reduce(times, samples) * self.rule.span_weights
        return (weights - span_change) / self.rule.span

    def jump_weight(
        self, times: np.ndarray, samples: np.ndarray, before: float, after: float
    ) -> float:
        return (before - after) / (self.rule.span if self.over_span else 1.0)

    def time_derivatives(self, times: np.ndarray) -> np.ndarray:
        return self.rule.time_derivatives

    def unit(self, unit: str) -> str:
        times_time = unit and self.rule.continuous and not self.over_span
        return f"{unit} s" if times_time else unit  # formulas may have an unknown unit


@dataclass(frozen=True, kw_only=True)
class RootOfSquares(Response):
    """``√(wᵀ m²)`` with the weights of a mean."""

    mean: Weighted

    def reduce(self, times: np.ndarray, samples: np.ndarray) -> float:
        return float(np.sqrt(max(self.mean.reduce(times, samples**2), 0.0)))

    def weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        value = self.reduce(times, samples)
        if value == 0.0:  # not differentiable; zero is a subgradient
            return np.zeros_like(samples)
        return self.mean.weights(times, samples) * samples / value

    def weights_change(
        self, times: np.ndarray, samples: np.ndarray, change: np.ndarray
    ) -> np.ndarray:
        value, gradient = self.reduce(times, samples), self.weights(times, samples)
        if value == 0.0:
            return np.zeros_like(samples)
        return (self.mean.weights(times, samples) * change - gradient * (gradient @ change)) / value

    def time_weights(self, times: np.ndarray, samples: np.ndarray) -> np.ndarray:
        value = self.reduce(times, samples)
        if value == 0.0:
            return np.zeros_like(samples)
        return self.mean.time_weights(times, samples**2) / (2 * value)

    def jump_weight(
        self, times: np.ndarray, samples: np.ndarray, before: float, after: float
    ) -> float:
        value = self.reduce(times, samples)
        if value == 0.0:
            return 0.0
        return self.mean.jump_weight(times, samples**2, before**2, after**2) / (2 * value)

    def time_derivatives(self, times: np.ndarray) -> np.ndarray:
        return self.mean.time_derivatives(times)
