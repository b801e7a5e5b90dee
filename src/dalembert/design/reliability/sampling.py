"""Failure probabilities by sampling: Monte Carlo, importance sampling, subset simulation.

Unions of half-spaces are sampled one half-space at a time (Owen, Maximov and Chertkov 2019),
``P = Σ_k Φ(−β_k) E[1/N(u) | αₖᵀu ≥ β_k]`` with the number ``N`` of half-spaces that contain ``u``:
the relative error is bounded, however small the probability is. OpenTURNS, an optional package,
provides further algorithms.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.design.reliability.first_order import DesignPoint
from dalembert.errors import AnalysisError
from dalembert.options import RandomSource, random_generator
from dalembert.packages import optional_package

Evaluate = Callable[[np.ndarray], np.ndarray]
"""(N, n) points ``u`` → (N,) ``G`` of the system, failed below zero; NaN if a run fails."""
LEVEL_PROBABILITY = 0.1
"""Fraction of the samples that seed the next subset."""
CHAIN_CORRELATION = 0.8
"""Correlation of consecutive samples of a chain."""
MAX_LEVELS = 30
"""Upper limit of subsets."""
HALF_SPACE_SAMPLES = 2**14
"""Number of points of a scrambled Sobol sequence for each half-space."""
SAFE = 1e30
"""``G`` that replaces failed runs: far from failure."""
BLOCK = 100
"""Block size of the algorithms of OpenTURNS."""


@dataclass(frozen=True)
class Estimate:
    """Probability estimated from samples.

    Attributes
    ----------
    probability : of failure
    variation : coefficient of variation of the estimate
    interval : 95 % confidence interval
    samples, failed_runs : number of samples, and number of samples without a value
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

    @property
    def sentence(self) -> str:
        """The probability with its standard error and its interval."""
        low, high = self.interval
        error = f" ± {100 * self.variation:.2g} %" if np.isfinite(self.variation) else ""
        return (
            f"by {self.samples} samples {self.probability:.3g}{error} "
            f"(95 % interval {low:.3g} … {high:.3g})"
        )


def monte_carlo(evaluate: Evaluate, size: int, samples: int, rng: np.random.Generator) -> Estimate:
    """Crude Monte Carlo estimate with the interval of Clopper and Pearson."""
    from scipy.special import betaincinv

    g = evaluate(rng.normal(size=(samples, size)))
    finite, failed_runs = g[np.isfinite(g)], int(np.count_nonzero(~np.isfinite(g)))
    count, failures = _count_finite(finite), int(np.count_nonzero(finite < 0))
    p = failures / count
    low = float(betaincinv(failures, count - failures + 1, 0.025)) if failures else 0.0
    high = float(betaincinv(failures + 1, count - failures, 0.975)) if failures < count else 1.0
    variation = float(np.sqrt((1 - p) / (p * count))) if p else np.inf
    return Estimate(p, variation, (low, high), samples, failed_runs)


def importance_sampling(
    evaluate: Evaluate, centres: np.ndarray, samples: int, rng: np.random.Generator
) -> Estimate:
    """Importance sampling about the design points ``(m, n)``."""
    chosen = rng.integers(len(centres), size=samples)
    u = centres[chosen] + rng.normal(size=(samples, centres.shape[1]))
    # φ(u)/Σφ(u − c)/m from the differences of the exponents
    exponents = u @ centres.T - 0.5 * np.sum(centres**2, axis=1)
    weights = 1 / np.mean(np.exp(np.clip(exponents, -700, 700)), axis=1)
    g = evaluate(u)
    finite = np.isfinite(g)
    count = _count_finite(g[finite])
    terms = np.where(g[finite] < 0, weights[finite], 0.0)
    p, deviation = float(np.mean(terms)), float(np.std(terms, ddof=1) / np.sqrt(count))
    interval = (max(p - 1.96 * deviation, 0.0), min(p + 1.96 * deviation, 1.0))
    return Estimate(p, deviation / p if p else np.inf, interval, samples, samples - count)


def subset_simulation(
    evaluate: Evaluate, size: int, samples: int, rng: np.random.Generator
) -> Estimate:
    """Subset simulation: a product of larger probabilities (Au and Beck 2001).

    Chains remain in a subset by conditional sampling, ``u' = ρu + √(1 − ρ²) w`` (Papaioannou 2015).

    Parameters
    ----------
    samples : number of samples on each level
    """
    u = rng.normal(size=(samples, size))
    g = evaluate(u)
    failed_runs, total = int(np.count_nonzero(~np.isfinite(g))), samples
    g = np.where(np.isfinite(g), g, np.inf)
    seed_count = max(int(LEVEL_PROBABILITY * samples), 2)
    length = -(-samples // seed_count)
    probability, variance, rho = 1.0, 0.0, CHAIN_CORRELATION
    chains = 1
    for _ in range(MAX_LEVELS):
        order = np.argsort(g, kind="stable")
        threshold = float(g[order[seed_count - 1]])
        final = threshold <= 0
        inside = (g < 0) if final else (g <= threshold)
        fraction = float(np.mean(inside))
        variance += _variation(inside, fraction, chains) ** 2
        probability *= fraction
        if final or not fraction:
            break
        seeds, values = u[order[:seed_count]], g[order[:seed_count]]
        states, levels = [seeds], [values]
        for _ in range(length - 1):
            candidates = rho * states[-1] + np.sqrt(1 - rho**2) * rng.normal(size=seeds.shape)
            candidate_values = evaluate(candidates)
            failed_runs += int(np.count_nonzero(~np.isfinite(candidate_values)))
            total += seed_count
            accepted = np.isfinite(candidate_values) & (candidate_values <= threshold)
            states.append(np.where(accepted[:, None], candidates, states[-1]))
            levels.append(np.where(accepted, candidate_values, levels[-1]))
        u, g, chains = np.vstack(states), np.concatenate(levels), seed_count
    variation = float(np.sqrt(variance)) if probability else np.inf
    spread = 1.96 * variation * probability if probability else 0.0
    interval = (max(probability - spread, 0.0), min(probability + spread, 1.0))
    return Estimate(probability, variation, interval, total, failed_runs)


def _variation(inside: np.ndarray, fraction: float, chains: int) -> float:
    """Coefficient of variation of a fraction, including the correlation along the chains."""
    if not 0 < fraction < 1:
        return 0.0
    independent = (1 - fraction) / (fraction * inside.size)
    if chains == 1:
        return float(np.sqrt(independent))
    steps = inside.reshape(-1, chains).astype(float)
    count, gamma = len(steps), 0.0
    for k in range(1, count):
        r = float(np.mean(steps[:-k] * steps[k:])) - fraction**2
        gamma += 2 * (1 - k / count) * r / (fraction * (1 - fraction))
    return float(np.sqrt(independent * (1 + max(gamma, 0.0))))


def _count_finite(finite: np.ndarray) -> int:
    if finite.size < 2:
        raise AnalysisError("no sample could be evaluated; check the bounds of the distributions")
    return int(finite.size)


def union_of_half_spaces(points: Sequence[DesignPoint]) -> float:
    """Probability of the union of the half-spaces of design points."""
    from scipy.special import ndtr

    if len(points) == 1:
        return points[0].probability
    alphas, betas = np.array([p.alpha for p in points]), np.array([p.beta for p in points])
    if len(betas) == 2:
        return float(ndtr(-betas).sum() - intersection_of_half_spaces(points))
    return float(sum(_union_term(alphas, betas, k) for k in range(len(betas))))


def _union_term(alphas: np.ndarray, betas: np.ndarray, k: int) -> float:
    """``Φ(−β_k) E[1/N(u) | αₖᵀu ≥ β_k]``."""
    from scipy.special import ndtr, ndtri
    from scipy.stats import qmc

    tail = ndtr(-betas[k])
    if not tail > 0:
        return 0.0
    basis = np.linalg.svd(alphas, full_matrices=False)[2]
    projected = alphas @ basis.T
    uniform = qmc.Sobol(len(basis) + 1, rng=np.random.default_rng(k)).random(HALF_SPACE_SAMPLES)
    uniform = np.clip(uniform, 1e-15, 1 - 1e-15)
    components = -ndtri(uniform[:, 0] * tail)
    u = ndtri(uniform[:, 1:])
    u += (components - u @ projected[k])[:, None] * projected[k]
    inside = u @ projected.T >= betas
    inside[:, k] = True
    return float(tail * np.mean(1 / inside.sum(axis=1)))


def intersection_of_half_spaces(points: Sequence[DesignPoint]) -> float:
    """Probability of the intersection of the half-spaces of design points."""
    from scipy.stats import multivariate_normal

    alphas = np.array([p.alpha for p in points])
    betas = np.array([p.beta for p in points])
    joint = multivariate_normal(cov=alphas @ alphas.T, allow_singular=True)
    return float(joint.cdf(-betas, rng=np.random.default_rng(0)))


def failure_event(evaluate: Callable[[np.ndarray], np.ndarray], size: int) -> Any:
    """OpenTURNS ``ThresholdEvent`` ``G(u) < 0`` of independent standard normal ``u``.

    Parameters
    ----------
    evaluate : (N, n) ``u`` → (N,) ``G``
    size : n

    Raises
    ------
    UnsupportedError
        OpenTURNS is not installed.
    """
    ot = optional_package("openturns", "subset simulation")

    def values(sample: Any) -> list[list[float]]:
        g = evaluate(np.array(sample, dtype=float))
        return [[float(v)] for v in np.where(np.isfinite(g), g, SAFE)]

    function = ot.PythonFunction(size, 1, func_sample=values)
    vector = ot.CompositeRandomVector(function, ot.RandomVector(ot.Normal(size)))
    return ot.ThresholdEvent(vector, ot.Less(), 0.0)


def openturns_subset_sampling(
    evaluate: Callable[[np.ndarray], np.ndarray], size: int, samples: int, rng: RandomSource
) -> Estimate:
    """Subset sampling of OpenTURNS with a number of samples on each level."""
    ot = optional_package("openturns", "subset simulation")
    failed_runs = [0]

    def evaluate_and_count(u: np.ndarray) -> np.ndarray:
        g = evaluate(u)
        failed_runs[0] += int(np.count_nonzero(~np.isfinite(g)))
        return g

    ot.RandomGenerator.SetSeed(int(random_generator(rng).integers(2**31)))
    block = min(BLOCK, samples)
    algorithm = ot.SubsetSampling(failure_event(evaluate_and_count, size))
    algorithm.setBlockSize(block)
    algorithm.setMaximumOuterSampling(max(1, samples // block))
    algorithm.run()
    result = algorithm.getResult()
    p, variation = float(result.getProbabilityEstimate()), float(result.getCoefficientOfVariation())
    half_width = 1.96 * variation * p if np.isfinite(variation) else 0.0
    total = int(result.getOuterSampling()) * block * int(algorithm.getStepsNumber())
    return Estimate(
        p, variation, (max(p - half_width, 0.0), min(p + half_width, 1.0)), total, failed_runs[0]
    )
