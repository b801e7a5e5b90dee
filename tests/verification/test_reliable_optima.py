"""Designs whose limits hold with a given reliability, and robust ones.

Two normal variables and three limits: B. D. Youn, K. K. Choi, *Selecting probabilistic approaches
for reliability-based design optimization*, AIAA Journal 42 (2004), also by a dense scan here; a tie
rod of lognormal load and area, and sums of parabolas, in closed form.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import minimize

import dalembert as da
from dalembert import planar, structures

LIMITS = (
    "x1**2*x2/20 - 1",
    "(x1 + x2 - 5)**2/30 + (x1 - x2 - 12)**2/120 - 1",
    "80/(x1**2 + 8*x2 + 5) - 1",
)
SCATTER, BETA = 0.3, 3.0
STILL = da.Kinematics(t_span=(0.0, 1e-3), outputs=2)


@pytest.fixture(scope="module")
def numbers() -> da.Model:
    """A mechanism whose parameters are the two variables."""
    system = da.System("two numbers")
    for name in ("x1", "x2"):
        system.parameter(name, 5.0, bounds=(0.0, 10.0))
    bar = system.add(planar.Bar("bar", length=1.0))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bar.start))
    system.add(planar.RotationalDriver("hold", system.ground, bar, 0.0 * da.t))
    return system.build()


def scanned() -> np.ndarray:
    """The optimum with every limit at the least of a circle of radius β: no derivatives of it."""
    turn = np.linspace(0, 2 * math.pi, 4001)
    ring = BETA * SCATTER * np.array([np.cos(turn), np.sin(turn)])

    def least(d, limit):
        x1, x2 = d[:, None] + ring
        return float(np.min(eval(limit, {"x1": x1, "x2": x2})))

    optimum = minimize(
        np.sum,
        [5.0, 5.0],
        method="SLSQP",
        constraints=[{"type": "ineq", "fun": least, "args": (limit,)} for limit in LIMITS],
        tol=1e-10,
    )
    return optimum.x


def test_two_normal_variables(numbers):
    best = da.optimize_reliable(
        numbers,
        da.final("x1 + x2", name="cost"),
        subject_to=[da.Limit(da.final(g, name=f"G{k}"), lower=0) for k, g in enumerate(LIMITS)],
        random={name: da.Normal(5.0, SCATTER) for name in ("x1", "x2")},
        beta=BETA,
        analysis=STILL,
    )
    assert best.success and best.fun == pytest.approx(6.7257, abs=1e-4)  # printed
    np.testing.assert_allclose([best.x["x1"], best.x["x2"]], scanned(), rtol=1e-5)
    assert [limit.beta for limit in best.limits[:2]] == pytest.approx([BETA, BETA], rel=1e-6)
    assert best.limits[2].beta > 8 and best.limits[2].value > 0
    assert best.rounds[0].objective < best.fun  # the optimum without scatter breaks the limits
    assert "<iframe" in best._repr_html_() and best.data.limit_beta.size == 3


def rod() -> da.Model:
    structure = da.Structure("tie rod")
    load = structure.parameter("load", 1e5, "N")
    area = structure.parameter("area", 1e-3, "m^2", bounds=(2e-4, 5e-3))
    left, right = structure.node("left", 0, 0), structure.node("right", 2, 0)
    structure.add(structures.Truss("rod", left, right, area=area, modulus=2e11, density=7850))
    structure.support(left)
    structure.support(right, uy=0)
    structure.load(right, fx=load)
    return structure.build()


def test_a_lognormal_load():
    """The area bears the load at its quantile: ``A = exp(μ + βσ)/s``."""
    best = da.optimize_reliable(
        rod(),
        da.final("mass", name="mass"),
        subject_to=[da.Limit(da.final("rod.stress", name="stress"), upper=1.5e8)],
        random={"load": da.Lognormal(1e5, 2e4)},
        beta=3.5,
        analysis=da.Statics(),
    )
    spread = math.log1p(0.2**2)
    needed = math.exp(math.log(1e5) - spread / 2 + 3.5 * math.sqrt(spread)) / 1.5e8
    assert best.success and best.x["area"] == pytest.approx(needed, rel=1e-6)
    assert best.limits[0].beta == pytest.approx(3.5, rel=1e-6)


def test_a_robust_limit():
    """Stress is linear in the load: mean and three deviations are those of the load."""
    random = {"load": da.Normal(1e5, 1e4)}
    stress = da.robust(da.final("rod.stress", name="stress"), random, 3.0)
    best = da.optimize(
        rod(),
        da.final("mass", name="mass"),
        subject_to=[da.Limit(stress, upper=1.5e8)],
        analysis=da.Statics(),
    )
    assert best.success and best.x["area"] == pytest.approx(1.3e5 / 1.5e8, rel=1e-6)


def test_what_does_not_vary_keeps_its_own_mean():
    """A modulus with bounds that is random but no variable: ``A = F l E(1/E)/u``."""
    structure = da.Structure("rod")
    area = structure.parameter("area", 1e-3, bounds=(1e-4, 1e-2))
    modulus = structure.parameter("modulus", 2e11, bounds=(1e11, 3e11))
    fixed, end = structure.node("fixed", 0.0), structure.node("end", 2.0)
    structure.add(structures.Truss("rod", fixed, end, area=area, modulus=modulus, density=7850.0))
    structure.support(fixed)
    structure.load(end, fx=1e5)
    distribution = da.Lognormal(1.5e11, 1e9)
    sunk = da.robust(da.final("end.ux"), {"modulus": distribution}, 0.0)
    aim = da.combined("2*sunk", "doubled", sunk=sunk)
    for limit in (da.Limit(sunk, upper=1e-3), da.Limit(aim, upper=2e-3)):
        best = da.optimize(
            structure.build(),
            minimize=da.final("mass"),
            subject_to=[limit],
            vary=["area"],
            analysis=da.Statics(),
        )
        mean, spread = distribution.logarithm
        assert best.x["area"] == pytest.approx(2e5 / 1e-3 * math.exp(spread**2 / 2 - mean))


def test_a_robust_objective(numbers):
    """``(x₁ − 2)² + 0.1 x₂²`` about the design: mean ``+ s²``, variance ``4 d² s² + 2 s⁴`` each."""
    s, k = 0.3, 2.0
    random = {name: da.Normal(5.0, s) for name in ("x1", "x2")}
    aim = da.robust(da.final("(x1 - 2)**2 + 0.1*x2**2", name="f"), random, k)
    best = da.optimize(numbers, aim, analysis=STILL, tolerance=1e-12)

    def exact(d):
        mean = (d[0] - 2) ** 2 + s**2 + 0.1 * (d[1] ** 2 + s**2)
        first = 4 * (d[0] - 2) ** 2 * s**2 + 2 * s**4
        second = 0.01 * (4 * d[1] ** 2 * s**2 + 2 * s**4)
        return mean + k * math.sqrt(first + second)

    assert best.fun == pytest.approx(minimize(exact, [3.0, 1.0], tol=1e-12).fun, rel=1e-6)
    at = np.array([3.0, 1.0])
    problem = da.DesignFunctions(numbers, [aim], analysis=STILL)
    value, slope = problem.values(at), problem.jacobian(at)[0]
    assert value[0] == pytest.approx(exact(at), rel=1e-9)
    ends = [(exact(at + e) - exact(at - e)) / 2e-6 for e in 1e-6 * np.eye(2)]
    np.testing.assert_allclose(slope, ends, rtol=1e-6)


def test_invalid_tasks_are_refused(numbers):
    cost, random = da.final("x1 + x2"), {"x1": da.Normal(5.0, 0.3)}
    limit = da.Limit(da.final("x1"), lower=1.0)

    def ask(**changed):
        arguments = {"subject_to": [limit], "random": random, "analysis": STILL} | changed
        return da.optimize_reliable(numbers, cost, **arguments)

    for changed, words in (
        ({"beta": -1.0}, "beta is -1.0"),
        ({"random": {}}, "nothing is random"),
        ({"random": {"x3": da.Normal(0, 1)}}, "unknown random parameter 'x3'"),
        ({"subject_to": []}, "no limit to be reliable"),
    ):
        with pytest.raises(da.DalembertError, match=words):
            ask(**changed)
    with pytest.raises(da.AnalysisError, match="nothing is random"):
        da.robust(cost, {})
