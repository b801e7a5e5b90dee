"""Reliability: closed forms, transformations, sensitivities, systems, and what cannot be."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy import stats
from scipy.special import ndtr

import dalembert as da
from dalembert import planar, structures
from dalembert.design.reliability.design_points import PointSearches, _PointCheck, _ranked
from dalembert.design.reliability.distribution import normal_points
from dalembert.design.reliability.nataf import Nataf

DISTRIBUTIONS = {
    "normal": (da.Normal(2.0, 0.5), stats.norm(2.0, 0.5)),
    "lognormal": (
        da.Lognormal(2.0, 0.5),
        stats.lognorm(
            math.sqrt(math.log(1 + 0.0625)), scale=2 * math.exp(-math.log(1 + 0.0625) / 2)
        ),
    ),
    "uniform": (da.Uniform(-1.0, 3.0), stats.uniform(-1.0, 4.0)),
    "weibull": (da.Weibull(2.0, 3.0, 0.5), stats.weibull_min(3.0, 0.5, 2.0)),
    "gumbel": (
        da.Gumbel(2.0, 0.7),
        stats.gumbel_r(
            2.0 - np.euler_gamma * 0.7 * math.sqrt(6) / math.pi, 0.7 * math.sqrt(6) / math.pi
        ),
    ),
    "truncated": (da.Truncated(da.Normal(0, 1), -0.5, 3.0), stats.truncnorm(-0.5, 3.0)),
}
U = np.linspace(-4, 4, 33)
N = da.Normal(0.0, 1.0)


@pytest.mark.parametrize("name", DISTRIBUTIONS)
def test_distributions_are_those_of_scipy(name):
    own, other = DISTRIBUTIONS[name]
    x = own.from_normal(U)
    np.testing.assert_allclose(other.cdf(x), ndtr(U), rtol=1e-9)
    np.testing.assert_allclose(own.to_normal(x), U, atol=1e-9)
    np.testing.assert_allclose(own.slope(U) * other.pdf(x), stats.norm.pdf(U), rtol=1e-8)
    np.testing.assert_allclose(own.moments, (other.mean(), other.std()), rtol=1e-6)


def test_far_tails_are_kept():
    for own in (da.Weibull(2.0, 3.0), da.Gumbel(2.0, 0.7), da.Lognormal(1.0, 0.3)):
        u = np.array([-9.0, -7.0, 7.0, 9.0])
        np.testing.assert_allclose(own.to_normal(own.from_normal(u)), u, rtol=1e-9)


def test_nataf_of_two_uniform_variables():
    """In closed form ``ρ₀ = 2 sin(πρ/6)``."""
    pair = {"a": da.Uniform(0, 1), "b": da.Uniform(2, 5)}
    for wanted in (-0.7, 0.2, 0.9):
        factor = Nataf(pair, {("a", "b"): wanted}).factor
        assert factor[1, 0] == pytest.approx(2 * math.sin(math.pi * wanted / 6), abs=1e-5)


def test_nataf_keeps_the_correlation():
    kinds = {"a": da.Gumbel(1, 0.2), "b": da.Weibull(2, 1.7), "c": da.Lognormal(3, 1)}
    wanted = {("a", "b"): 0.4, ("b", "c"): -0.3, ("a", "c"): 0.1}
    nataf = Nataf(kinds, wanted)
    u, w = normal_points(24)
    grid = np.stack(np.meshgrid(u, u, u, indexing="ij"), axis=-1).reshape(-1, 3)
    weight = (w[:, None, None] * w[:, None] * w).ravel()
    x = nataf.values(grid)
    x = (x - weight @ x) / np.sqrt(weight @ (x - weight @ x) ** 2)
    computed = (x * weight[:, None]).T @ x
    for (i, j), value in wanted.items():
        assert computed["abc".index(i), "abc".index(j)] == pytest.approx(value, abs=2e-3)


def test_correlated_lognormal_ratio():
    """``ln r − ln s`` is normal, so ``β`` is known."""
    r, s, rho = da.Lognormal(5.0, 0.8), da.Lognormal(2.0, 0.6), 0.35
    result = da.reliability(None, "r - s", {"r": r, "s": s}, correlation={("r", "s"): rho})
    (mr, sr), (ms, ss) = r.logarithm, s.logarithm
    both = math.log1p(rho * 0.8 / 5 * 0.6 / 2)
    beta = (mr - ms) / math.sqrt(sr**2 + ss**2 - 2 * both)
    assert result.success and result.beta == pytest.approx(beta, abs=1e-6)


@pytest.fixture(scope="module")
def bar():
    structure = da.Structure("bar")
    load, area = structure.parameter("load", 1e5, "N"), structure.parameter("area", 1e-3, "m^2")
    length = structure.parameter("length", 2.0, "m")
    start, end = structure.node("a", 0, 0), structure.node("b", length, 0)
    structure.add(structures.Truss("rod", start, end, area=area, modulus=2e11))
    structure.support(start)
    structure.support(end, uy=0)
    structure.load(end, fx=load)
    return structure.build()


def test_a_structure_and_its_sensitivities(bar):
    """Elongation ``P l/(E A)`` of a bar with lognormal load and area."""
    random = {"load": da.Lognormal(1e5, 2e4), "area": da.Lognormal(1e-3, 5e-5)}
    limit = da.Limit(da.final("b.ux"), upper=2e-3)

    def beta(random, length=2.0):
        (ml, sl), (ma, sa) = (random[n].logarithm for n in ("load", "area"))
        return (math.log(2e-3 * 2e11 / length) - ml + ma) / math.hypot(sl, sa)

    result = da.reliability(bar, limit, random, analysis=da.Statics())
    assert result.success and result.beta == pytest.approx(beta(random), abs=1e-6)
    changed = [random | {"load": da.Lognormal(1e5 + d, 2e4)} for d in (-10, 10)]
    slope = (beta(changed[1]) - beta(changed[0])) / 20
    assert result.sensitivity["load"]["mean"] == pytest.approx(slope, rel=1e-5)
    changed = [random | {"load": da.Lognormal(1e5, 2e4 + d)} for d in (-10, 10)]
    slope = (beta(changed[1]) - beta(changed[0])) / 20
    assert result.sensitivity["load"]["std"] == pytest.approx(slope, rel=1e-5)
    slope = (beta(random, 2.001) - beta(random, 1.999)) / 0.002
    assert result.parameter_sensitivity["length"] == pytest.approx(slope, rel=1e-5)
    assert sum(result.importance.values()) == pytest.approx(1)
    low, high = result.importance_sampling(300).interval
    assert low < ndtr(-beta(random)) < high


def test_a_mechanism():
    """The slider of a crank goes too far: ``r cos q + √(l² − r² sin² q) > x``."""
    system = da.System("slider-crank")
    r, length = system.parameter("r", 0.1, "m"), system.parameter("l", 0.3, "m")
    crank = system.add(planar.Bar("crank", length=r, mass=1.0))
    rod = system.add(planar.Bar("rod", length=length, mass=1.0))
    slider = system.add(planar.Body("slider", mass=1.0, inertia=1.0, position=(0.4, 0)))
    system.add(planar.Revolute("O", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, slider.center))
    system.add(planar.Prismatic("rail", system.ground.point(0, 0), slider.center))
    system.add(planar.RotationalDriver("motor", system.ground, crank, 2 * da.t))
    random = {"r": da.Normal(0.1, 2e-3), "l": da.Normal(0.3, 1e-3)}
    limit = da.Limit(da.final("slider.x"), upper=0.367)
    result = da.reliability(
        *(system.build(), limit, random),
        analysis=da.Kinematics(0.4, outputs=2),
        correlation={("r", "l"): 0.5},
    )
    assert result.success and result.residual < 1e-8
    rng = np.random.default_rng(0)
    cov = np.array([[4, 1], [1, 1]]) * 1e-6
    radius, rod_length = rng.multivariate_normal([0.1, 0.3], cov, 1_000_000).T
    place = radius * np.cos(0.8) + np.sqrt(rod_length**2 - (radius * np.sin(0.8)) ** 2)
    share = np.mean(place > 0.367)
    assert result.probability == pytest.approx(share, rel=0.03)


def test_systems():
    """Two planes square to each other: the probabilities multiply."""
    limits, p = ["1 - a", "1.5 - b"], ndtr([-1.0, -1.5])
    series = da.reliability(None, limits, {"a": N, "b": N})
    assert series.probability == pytest.approx(1 - (1 - p[0]) * (1 - p[1]), rel=1e-6)
    parallel = da.reliability(None, limits, {"a": N, "b": N}, system="parallel")
    assert parallel.probability == pytest.approx(p[0] * p[1], rel=1e-4)
    low, high = parallel.monte_carlo(100_000, rng=1).interval
    assert low < p[0] * p[1] < high


def test_several_design_points():
    result = da.reliability(None, "9 - a**2 + 0.1*b", {"a": N, "b": N}, starts=12)
    assert sorted(round(one.x["a"], 3) for one in result.points) == [-2.999, 2.999]
    low, high = result.importance_sampling(20_000).interval
    u, w = normal_points()  # P(a² > 9 + b/10), integrated over b
    exact = w @ (2 * ndtr(-np.sqrt(9 + 0.1 * u)))
    assert low < exact < high


def test_a_median_on_an_axis_of_symmetry():
    """``3 − y − x²/2`` bends around the origin: (0, 3) is farthest, √5 is nearest; and a disc."""
    normal = {"x": da.Normal(0, 1), "y": da.Normal(0, 1)}
    result = da.reliability(None, "3 - y - x**2/2", normal, starts=1)
    assert result.success and result.beta == pytest.approx(np.sqrt(5), rel=1e-8)
    disc = da.reliability(None, "9 - x**2 - 2*y**2", normal, starts=1)
    assert disc.success and disc.beta == pytest.approx(np.sqrt(4.5), rel=1e-6)


def test_the_far_boundary_of_a_failure_region_is_no_design_point():
    """Failure between 3 and 3.2: a search from behind ends at 3.2, although the median is safe."""
    result = da.reliability(None, "(3 - a)*(3.2 - a)", {"a": N}, starts=1)
    far = result.searches[0].solve(np.array([4.5]), 9.6)
    assert far.beta == pytest.approx(-3.2)
    near = _PointCheck(result.searches[0], 9.6, 1.0).nearest(far)
    assert near.converged and near.beta == pytest.approx(3.0, rel=1e-7)
    outcome = PointSearches([far], 1)
    (point,) = _ranked(outcome, 1.0)
    assert far.converged and not point.converged
    outcome.points = [point]
    assert "far boundary" in outcome.warning


def test_failure_at_the_means_has_a_negative_index():
    result = da.reliability(None, "r - s", {"r": da.Normal(2, 1), "s": da.Normal(4, 1)})
    assert result.beta == pytest.approx(-math.sqrt(2), abs=1e-9)


def test_searches_that_do_not_converge_are_reported():
    result = da.reliability(None, "2 - a + exp(b) - 1", {"a": N, "b": N}, max_iterations=1)
    assert not result.success and result.residual > 1e-8 and "not converged" in repr(result)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"correlation": np.array([[1, 0.9], [0.2, 1]])}, "symmetric"),
        ({"correlation": {("a", "b"): 1.2}}, "not positive definite"),
        ({"correlation": {("a", "c"): 0.2}}, "unknown random parameter 'c'"),
        ({"random": {"a": da.Lognormal(1, 2), "b": da.Lognormal(1, 2)}}, "lies between"),
        ({"limit_state": "2 - a*0"}, "does not change"),
        ({"limit_state": "sqrt(a - 5)"}, "cannot be evaluated"),
        ({"random": {}}, "nothing is random"),
        ({"random": {"a": 1.0, "b": N}}, "give a distribution"),
        ({"limit_state": da.final("x")}, "need analysis"),
        ({"system": "circle"}, "unknown system"),
        ({"method": "newton"}, "unknown method"),
    ],
)
def test_invalid_arguments_are_refused(more, message):
    arguments = {"limit_state": "3 - a - b", "random": {"a": N, "b": N}}
    if "lies between" in message:
        arguments["correlation"] = {("a", "b"): -0.9}
    with pytest.raises(da.DalembertError, match=message):
        da.reliability(None, **(arguments | more))


@pytest.mark.parametrize(
    "make",
    [
        lambda: da.Normal(0, 0),
        lambda: da.Lognormal(-1, 1),
        lambda: da.Uniform(2, 1),
        lambda: da.Weibull(0, 1),
        lambda: da.Gumbel(1, -1),
        lambda: da.Truncated(N, 50.0, 60.0),
    ],
)
def test_distributions_that_cannot_be(make):
    with pytest.raises(da.ModelError):
        make()


def test_the_upper_tail_of_gumbel_neither_underflows_nor_warns():
    """``1 − F(x) → Φ(−u)``: ``x = mode − s ln Φ(−u)`` far out, and the slope is its derivative."""
    law, scale = da.Gumbel(10.0, 1.0), math.sqrt(6) / math.pi
    mode, u = 10.0 - np.euler_gamma * scale, np.array([8.5, 9.5, 20.0, 37.0, 39.0, 100.0])
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        x, slope = law.from_normal(u), law.slope(u)
        near = (law.from_normal(u + 1e-4) - law.from_normal(u - 1e-4)) / 2e-4
    np.testing.assert_allclose(x, mode - scale * stats.norm.logsf(u), rtol=1e-13)
    np.testing.assert_allclose(slope, near, rtol=1e-7)


def test_numbers_of_searches_and_samples_are_checked():
    random = {"x": da.Normal(0.0, 1.0)}
    for wrong in ({"starts": 0}, {"starts": "a"}, {"samples": -1}, {"max_iterations": 2.5}):
        with pytest.raises(da.DalembertError, match=f"{next(iter(wrong))} .*give a whole number"):
            da.reliability(None, "3 - x", random, **wrong)


def test_a_sphere_of_failure_has_no_second_order_estimate():
    """Curvature −1/β: ``Π(1 + βκ)`` is zero up to rounding; the warning shows no number of it."""
    random = {"x": da.Normal(0.0, 1.0), "y": da.Normal(0.0, 1.0)}
    (warning,) = da.reliability(None, "6.25 - x**2 - y**2", random).warnings
    assert "no second-order estimate" in warning
