"""A reliability as an event of OpenTURNS, an extra, for its algorithms of sampling."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from dalembert.design.reliability.sampling import Estimate
from dalembert.errors import UnsupportedError
from dalembert.options import random_generator

NEVER = 1e30
"""``G`` where a run fails: far from failure."""
BLOCK = 100


def event_of(evaluate: Callable[[np.ndarray], np.ndarray], size: int) -> Any:
    """``ThresholdEvent`` ``G(u) < 0`` of independent standard normal ``u``.

    Parameters
    ----------
    evaluate : (N, n) ``u`` → (N,) ``G``
    size : n

    Raises
    ------
    UnsupportedError
        OpenTURNS is not there.
    """
    ot = _openturns()

    def values(sample: Any) -> list[list[float]]:
        g = evaluate(np.array(sample, dtype=float))
        return [[float(v)] for v in np.where(np.isfinite(g), g, NEVER)]

    function = ot.PythonFunction(size, 1, func_sample=values)
    vector = ot.CompositeRandomVector(function, ot.RandomVector(ot.Normal(size)))
    return ot.ThresholdEvent(vector, ot.Less(), 0.0)


def subsets(
    evaluate: Callable[[np.ndarray], np.ndarray], size: int, samples: int, rng: Any
) -> Estimate:
    """Subset sampling of OpenTURNS with so many samples on each level."""
    ot = _openturns()
    failed = [0]

    def counted(u: np.ndarray) -> np.ndarray:
        g = evaluate(u)
        failed[0] += int(np.count_nonzero(~np.isfinite(g)))
        return g

    ot.RandomGenerator.SetSeed(int(random_generator(rng).integers(2**31)))
    block = min(BLOCK, samples)
    algorithm = ot.SubsetSampling(event_of(counted, size))
    algorithm.setBlockSize(block)
    algorithm.setMaximumOuterSampling(max(1, samples // block))
    algorithm.run()
    result = algorithm.getResult()
    p, variation = float(result.getProbabilityEstimate()), float(result.getCoefficientOfVariation())
    spread = 1.96 * variation * p if np.isfinite(variation) else 0.0
    total = int(result.getOuterSampling()) * block * int(algorithm.getStepsNumber())
    return Estimate(p, variation, (max(p - spread, 0.0), min(p + spread, 1.0)), total, failed[0])


def _openturns() -> Any:
    try:
        import openturns
    except ImportError:
        raise UnsupportedError(
            "OpenTURNS is missing: pip install 'dalembert[reliability]'"
        ) from None
    return openturns
