"""Probabilities by sampling: crude, about the design points, and by subsets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dalembert.errors import AnalysisError

Evaluate = Callable[[np.ndarray], np.ndarray]
"""(N, n) points ``u`` → (N,) ``G`` of the system, failed below zero; NaN where a run fails."""
LEVEL = 0.1
"""Share of the samples that goes on to the next subset."""
NEAR = 0.8
"""Correlation of a sample with the one it is drawn from."""
DEEPEST = 30


@dataclass(frozen=True)
class Estimate:
    """A probability from samples.

    Attributes
    ----------
    probability : of failure
    variation : coefficient of variation of the estimate
    interval : in which the probability lies with 95 %
    samples, failed_runs : how many, and how many of them could not be evaluated
    """

    probability: float
    variation: float
    interval: tuple[float, float]
    samples: int
    failed_runs: int = 0

    @property
    def beta(self) -> float:
        """The reliability index ``−Φ⁻¹(p)`` of this probability."""
        from scipy.special import ndtri

        return float(-ndtri(self.probability))


def monte_carlo(evaluate: Evaluate, size: int, samples: int, rng: np.random.Generator) -> Estimate:
    """Share of failures, with the interval of Clopper and Pearson."""
    from scipy.special import betaincinv

    g = evaluate(rng.normal(size=(samples, size)))
    good, broken = g[np.isfinite(g)], int(np.count_nonzero(~np.isfinite(g)))
    count, failures = _enough(good), int(np.count_nonzero(good < 0))
    p = failures / count
    low = float(betaincinv(failures, count - failures + 1, 0.025)) if failures else 0.0
    high = float(betaincinv(failures + 1, count - failures, 0.975)) if failures < count else 1.0
    variation = float(np.sqrt((1 - p) / (p * count))) if p else np.inf
    return Estimate(p, variation, (low, high), samples, broken)


def importance_sampling(
    evaluate: Evaluate, centres: np.ndarray, samples: int, rng: np.random.Generator
) -> Estimate:
    """Samples about the design points ``(m, n)``, weighed by how likely they are."""
    which = rng.integers(len(centres), size=samples)
    u = centres[which] + rng.normal(size=(samples, centres.shape[1]))
    # φ(u)/Σφ(u − c)/m, of which only the differences of the exponents matter
    exponents = u @ centres.T - 0.5 * np.sum(centres**2, axis=1)
    weights = 1 / np.mean(np.exp(np.clip(exponents, -700, 700)), axis=1)
    g = evaluate(u)
    good = np.isfinite(g)
    count = _enough(g[good])
    terms = np.where(g[good] < 0, weights[good], 0.0)
    p, spread = float(np.mean(terms)), float(np.std(terms, ddof=1) / np.sqrt(count))
    interval = (max(p - 1.96 * spread, 0.0), min(p + 1.96 * spread, 1.0))
    return Estimate(p, spread / p if p else np.inf, interval, samples, samples - count)


def subset_simulation(
    evaluate: Evaluate, size: int, samples: int, rng: np.random.Generator
) -> Estimate:
    """Small probabilities as products of larger ones (Au and Beck 2001).

    Chains stay in a subset by conditional sampling, ``u' = ρu + √(1 − ρ²) w`` (Papaioannou 2015).

    Parameters
    ----------
    samples : on each level
    """
    u = rng.normal(size=(samples, size))
    g = evaluate(u)
    broken, total = int(np.count_nonzero(~np.isfinite(g))), samples
    g = np.where(np.isfinite(g), g, np.inf)
    kept = max(int(LEVEL * samples), 2)
    length = -(-samples // kept)
    probability, variance = 1.0, 0.0
    chains = 1
    for _ in range(DEEPEST):
        order = np.argsort(g, kind="stable")
        threshold = float(g[order[kept - 1]])
        last = threshold <= 0
        inside = (g < 0) if last else (g <= threshold)
        share = float(np.mean(inside))
        variance += _variation(inside, share, chains) ** 2
        probability *= share
        if last or not share:
            break
        seeds, values = u[order[:kept]], g[order[:kept]]
        rows, heights = [seeds], [values]
        for _ in range(length - 1):
            tried = NEAR * rows[-1] + np.sqrt(1 - NEAR**2) * rng.normal(size=seeds.shape)
            height = evaluate(tried)
            broken += int(np.count_nonzero(~np.isfinite(height)))
            total += kept
            taken = np.isfinite(height) & (height <= threshold)
            rows.append(np.where(taken[:, None], tried, rows[-1]))
            heights.append(np.where(taken, height, heights[-1]))
        u, g, chains = np.vstack(rows), np.concatenate(heights), kept
    variation = float(np.sqrt(variance)) if probability else np.inf
    spread = 1.96 * variation * probability if probability else 0.0
    interval = (max(probability - spread, 0.0), min(probability + spread, 1.0))
    return Estimate(probability, variation, interval, total, broken)


def _variation(inside: np.ndarray, share: float, chains: int) -> float:
    """Coefficient of variation of a share, the correlation along the chains included."""
    if not 0 < share < 1:
        return 0.0
    independent = (1 - share) / (share * inside.size)
    if chains == 1:
        return float(np.sqrt(independent))
    steps = inside.reshape(-1, chains).astype(float)
    count, gamma = len(steps), 0.0
    for k in range(1, count):
        r = float(np.mean(steps[:-k] * steps[k:])) - share**2
        gamma += 2 * (1 - k / count) * r / (share * (1 - share))
    return float(np.sqrt(independent * (1 + max(gamma, 0.0))))


def _enough(good: np.ndarray) -> int:
    if good.size < 2:
        raise AnalysisError("no sample could be evaluated; look at the limits of the distributions")
    return int(good.size)
