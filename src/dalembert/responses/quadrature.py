"""Weights that make an integral over a run of the samples of a measure."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Protocol

import numpy as np

from dalembert.analysis.dynamics.step_quadrature import StepQuadrature
from dalembert.results.result import Result

SHORT = 1e-3
"""Length of the last interval, relative to the one before, below which the two are one."""


class Rule(Protocol):
    """``Σ w_k m_k``, and how it depends on the times of the samples.

    Attributes
    ----------
    weights : (K,) ``w``
    shares : (K,) how far each sample moves in time when the last one moves by one
    span, span_weights : what the weights add up to, and its (K,) derivatives by the times
    continuous : the sum is an integral over time
    """

    @property
    def weights(self) -> np.ndarray: ...
    @property
    def shares(self) -> np.ndarray: ...
    @property
    def span(self) -> float: ...
    @property
    def span_weights(self) -> np.ndarray: ...
    @property
    def continuous(self) -> bool: ...
    def time_weights(self, samples: np.ndarray) -> np.ndarray:
        """(K,) ``∂(wᵀ m)/∂t_k`` with the samples held."""
        ...


@dataclass(frozen=True)
class Count:
    """Every sample counts one: modes, load cases, outputs."""

    count: int
    continuous = False

    @property
    def weights(self) -> np.ndarray:
        return np.ones(self.count)

    @property
    def shares(self) -> np.ndarray:
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
    """The rule for the samples of a motion."""
    if not motion.continuous:
        return Count(motion.time.size)
    chosen: StepQuadrature | None = getattr(motion.record, "quadrature", None)
    return Quadrature.over(motion.time) if chosen is None else chosen


@dataclass(frozen=True)
class Quadrature:
    """``∫ m dt ≈ wᵀ m`` on given times: a sum over pieces, each a parabola on one interval.

    Each interval takes the mean of the parabolas through it and its left and its right
    neighbour; two samples make a trapezium. A last interval that is nearly nothing, as an event
    right after an output leaves it, is joined to the one before: weights stay bounded.

    Attributes
    ----------
    count : number of samples
    span : from the first sample to the last
    index : (P, q) samples that each piece goes through
    powers : (P, q, q) powers ``0 … q−1`` of their times, from the beginning of the interval
    parts : (P, q) weight of each in the piece
    """

    count: int
    span: float
    index: np.ndarray
    powers: np.ndarray
    parts: np.ndarray

    @staticmethod
    def over(times: np.ndarray) -> Quadrature:
        """The quadrature on these times."""
        return _quadrature(np.ascontiguousarray(times, dtype=float).tobytes())

    continuous = True

    @property
    def shares(self) -> np.ndarray:
        return np.eye(1, self.count, self.count - 1).ravel()

    @property
    def span_weights(self) -> np.ndarray:
        found = np.zeros(self.count)
        found[-1] += 1.0
        found[0] -= 1.0
        return found

    @cached_property
    def weights(self) -> np.ndarray:
        """(K,) ``w``."""
        weights = np.zeros(self.count)
        np.add.at(weights, self.index, self.parts)
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
        np.add.at(found, self.index, -slopes * self.parts)
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
    parts = np.linalg.solve(powers.transpose(0, 2, 1), moments[..., None])[..., 0]
    parts /= np.bincount(k, minlength=count)[k][:, None]
    return Quadrature(given.size, float(given[-1] - given[0]), nodes[index], powers, parts)
