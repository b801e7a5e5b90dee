"""Subset simulation, ours and that of OpenTURNS, against probabilities known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import ndtr

import dalembert as da

NORMAL = da.Normal(0.0, 1.0)
PLANE = 10
"""Dimensions of a limit that is a plane at a distance of 4: p = Φ(−4) = 3.2e-5."""
CASES = {
    "plane": (
        f"4 - ({' + '.join(f'u{k}' for k in range(PLANE))})/sqrt({PLANE})",
        PLANE,
        float(ndtr(-4.0)),
    ),
    "circle": ("20 - u0**2 - u1**2", 2, math.exp(-10.0)),
}


@pytest.mark.few(1)
@pytest.mark.parametrize("method", ["subset-simulation", "openturns-subset"])
@pytest.mark.parametrize("name", ["plane", "circle"])
def test_probability(name, method):
    """The mean of several estimates, within three of their standard errors."""
    if method.startswith("openturns"):
        pytest.importorskip("openturns")
    formula, size, exact = CASES[name]
    random = {f"u{k}": NORMAL for k in range(size)}
    start = {"max_iterations": 3} if name == "circle" else {}  # whose slope is zero at the median
    shifted = {**random, "u0": da.Normal(1e-3, 1.0)} if name == "circle" else random
    result = da.reliability(None, formula, shifted, **start)
    results = [result.sample(method, 1000, seed) for seed in range(12 if method[0] == "s" else 5)]
    values = np.array([one.probability for one in results])
    assert abs(values.mean() - exact) < 3 * values.std(ddof=1) / math.sqrt(len(results))
    stated = np.mean([one.variation for one in results])
    assert stated == pytest.approx(values.std(ddof=1) / values.mean(), rel=0.8)


def test_an_event_of_openturns():
    """Its own algorithms know our limit states: directional sampling of a plane."""
    ot = pytest.importorskip("openturns")
    result = da.reliability(None, "3 - (u0 + u1)/sqrt(2)", {"u0": NORMAL, "u1": NORMAL})
    ot.RandomGenerator.SetSeed(1)
    algorithm = ot.DirectionalSampling(result.openturns_event)
    algorithm.setMaximumOuterSampling(2000)
    algorithm.run()
    estimate = algorithm.getResult().getProbabilityEstimate()
    assert estimate == pytest.approx(float(ndtr(-3.0)), rel=0.1)
