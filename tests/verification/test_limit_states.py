"""Published limit states: FORM, SORM and sampling.

Benchmark of TNO's reliability problems RP22, RP24, RP107 and the four-branch system, with R − S, as
collected in otbenchmark (M. Baudin, Y. Jebroun and others), which gives exact and first-order
probabilities.
"""

from __future__ import annotations

import re

import numpy as np
import pytest

import dalembert as da

N = da.Normal(0.0, 1.0)
CASES = {  # formula, variables, exact probability, first-order probability
    "R-S": ("r - s", {"r": da.Normal(4, 1), "s": da.Normal(2, 1)}, 0.07864960352514258, None),
    "RP22": (
        "2.5 - (x1 + x2)/sqrt(2) + 0.1*(x1 - x2)**2",
        {"x1": N, "x2": N},
        0.00420730551,
        0.006209672,
    ),
    "RP24": (
        "2.5 - 0.2357*(x1 - x2) + 0.00463*(x1 + x2 - 20)**4",
        {"x1": da.Normal(10, 3), "x2": da.Normal(10, 3)},
        0.00286,
        0.006209245,
    ),
    "RP107": (
        "5*sqrt(10) - " + " - ".join(f"x{k}" for k in range(10)),
        {f"x{k}": N for k in range(10)},
        2.92e-7,
        2.866515719e-7,
    ),
}
BETAS = {"R-S": np.sqrt(2), "RP22": 2.5, "RP107": 5.0}
BRANCHES = [
    "3 + 0.1*(x0 - x1)**2 - (x0 + x1)/sqrt(2)",
    "3 + 0.1*(x0 - x1)**2 + (x0 + x1)/sqrt(2)",
    "x0 - x1 + 7/sqrt(2)",
    "x1 - x0 + 7/sqrt(2)",
]


@pytest.mark.parametrize("method", ["improved-hlrf", "hlrf"])
@pytest.mark.parametrize("name", ["R-S", "RP22", "RP107"])
def test_first_order(name, method):
    formula, random, exact, printed = CASES[name]
    result = da.reliability(None, formula, random, method=method, starts=1)
    assert result.success and result.residual < 1e-8
    assert result.beta == pytest.approx(BETAS[name], abs=1e-6)
    assert result.probability == pytest.approx(printed or exact, rel=2e-6)  # as it is printed


def test_first_order_of_a_flat_quartic():
    formula, random, _, printed = CASES["RP24"]
    result = da.reliability(None, formula, random)
    assert result.success and result.probability == pytest.approx(printed, rel=1e-6)
    assert result.beta == pytest.approx(2.500024, abs=1e-6)


@pytest.mark.few(1)
@pytest.mark.parametrize("name", ["R-S", "RP22", "RP24"])
def test_sampling(name):
    """Each interval of 95 % holds the exact probability, widened by the digits printed."""
    formula, random, exact, _ = CASES[name]
    result = da.reliability(None, formula, random)
    for estimate in (result.monte_carlo(300_000, rng=1), result.importance_sampling(50_000, rng=1)):
        low, high = estimate.interval
        assert low - 1e-5 * (name == "RP24") <= exact <= high + 1e-5 * (name == "RP24")
    subset = result.subset_simulation(20_000, rng=1)
    assert abs(subset.probability - exact) < 3 * subset.variation * exact


def test_the_sentence_states_the_error_of_the_samples():
    """Half of the 95 % interval is 1.96 times the standard error that the sentence states."""
    formula, random, _, _ = CASES["R-S"]
    method = "importance-sampling"
    result = da.reliability(None, formula, random, samples=2000, sampling=method, rng=1)
    found = re.search(
        r"by 2000 samples (\S+) ± (\S+) % \(95 % interval (\S+) … (\S+)\)", result.sentence
    )
    assert found is not None, result.sentence
    probability, error, low, high = map(float, found.groups())
    assert 1.96 * error / 100 * probability == pytest.approx((high - low) / 2, rel=0.05)
    assert low < probability < high
    assert f"{error:.2g} %" in str(result.sampled and result.page())
    assert "samples" not in da.reliability(None, formula, random).sentence


def test_second_order_of_a_parabola():
    """RP22 is a parabola; Tvedt's terms are within half a percent of the exact probability."""
    formula, random, exact, _ = CASES["RP22"]
    sorm = da.reliability(None, formula, random).sorm
    np.testing.assert_allclose(sorm.curvatures, [0.4], atol=1e-8)
    assert sorm.breitung == pytest.approx(0.006209665325776132 / np.sqrt(1 + 2.5 * 0.4), rel=1e-8)
    assert sorm.tvedt == pytest.approx(exact, rel=5e-3)


def test_a_small_probability_by_subsets():
    formula, random, _, exact = CASES["RP107"]
    subset = da.reliability(None, formula, random).subset_simulation(20_000, rng=2)
    assert abs(subset.probability - exact) < 3 * subset.variation * exact


def test_four_branches():
    exact = 0.002222795066194
    result = da.reliability(None, BRANCHES, {"x0": N, "x1": N})
    assert [one.beta for one in result.points] == pytest.approx([3, 3, 3.5, 3.5], abs=1e-6)
    assert result.point.probability == pytest.approx(0.00134989803, rel=1e-6)
    low, high = result.importance_sampling(50_000, rng=1).interval
    assert low <= exact <= high
    # planes touch a surface that bends away from the origin: the probability is from above
    assert exact < result.probability < 1.5 * exact
