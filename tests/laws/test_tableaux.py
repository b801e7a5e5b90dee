"""Runge–Kutta tableaux satisfy the conditions of their order, and fail those of the next.

Order conditions by rooted trees (Butcher 1963): ``Σ b_i Φ_i(τ) = 1/γ(τ)`` for every tree ``τ`` of
at most ``p`` nodes. Sums are those of fractions, so that only the coefficients are rounded.
"""

from __future__ import annotations

import functools
from fractions import Fraction
from itertools import combinations_with_replacement, product
from math import prod

import numpy as np
import pytest
from scipy.optimize import brentq

import dalembert as da
from dalembert.errors import UnsupportedError
from dalembert.integrators.runge_kutta.explicit import ExplicitRungeKutta
from dalembert.integrators.runge_kutta.tableau import ButcherTableau

METHODS: dict[str, ExplicitRungeKutta] = {
    kind.__name__: kind()
    for kind in (da.Euler, da.Heun, da.RK4, da.RKGill, da.DormandPrince, da.DormandPrince853)
}
EMBEDDED = [
    ("DormandPrince", "b_error", 4),
    ("DormandPrince853", "b_error", 5),
    ("DormandPrince853", "b_error_low", 3),
]
TREES = [1, 1, 2, 4, 9, 20, 48, 115, 286]
"""Rooted trees of 1, 2, … nodes (Cayley 1857)."""

Tree = tuple  # the subtrees at the root, sorted


@functools.cache
def trees(nodes: int) -> list[Tree]:
    """Rooted trees of the given number of nodes."""
    return sorted({tuple(sorted(forest)) for forest in _forests(nodes - 1, nodes - 1)})


@functools.cache
def _forests(nodes: int, largest: int) -> list[tuple[Tree, ...]]:
    """Multisets of trees with the given number of nodes together, none above ``largest``."""
    if nodes == 0:
        return [()]
    groupings = []
    for size in range(1, largest + 1):
        for count in range(1, nodes // size + 1):
            rest = _forests(nodes - count * size, min(size - 1, nodes - count * size))
            equal = combinations_with_replacement(trees(size), count)
            groupings += [a + b for a, b in product(equal, rest)]
    return groupings


def size(tree: Tree) -> int:
    return 1 + sum(size(t) for t in tree)


@functools.cache
def density(tree: Tree) -> int:
    """``γ(τ)``: nodes of the tree and of all its subtrees, multiplied."""
    return size(tree) * prod(density(t) for t in tree)


@functools.cache
def stage_weights(tableau: ButcherTableau, tree: Tree) -> list[Fraction]:
    """``Φ_i(τ)``, the product over the subtrees ``σ`` at the root of ``Σ_j a_ij Φ_j(σ)``."""
    rows = [[Fraction(a) for a in row] for row in ((), *tableau.a)]
    below = [stage_weights(tableau, t) for t in tree]
    return [
        prod((sum(a * w for a, w in zip(row, s[: len(row)], strict=True)) for s in below), start=1)
        for row in rows
    ]


def residuals(tableau: ButcherTableau, weights, nodes: int, claims: bool = True) -> np.ndarray:
    """``Σ w_i Φ_i(τ) − 1/γ(τ)`` over the trees; without the last term for error weights."""
    return np.array(
        [
            float(
                sum(
                    Fraction(w) * f for w, f in zip(weights, stage_weights(tableau, t), strict=True)
                )
                - (Fraction(1, density(t)) if claims else 0)
            )
            for t in trees(nodes)
        ]
    )


def test_trees_are_counted_right():
    assert [len(trees(n)) for n in range(1, 10)] == TREES


@pytest.mark.parametrize("name", METHODS)
def test_order_conditions(name):
    """All conditions up to the order claimed hold, and some condition of the next fails."""
    tableau = METHODS[name].tableau
    for nodes in range(1, tableau.order + 1):
        np.testing.assert_allclose(residuals(tableau, tableau.b, nodes), 0, atol=1e-14)
    assert np.abs(residuals(tableau, tableau.b, tableau.order + 1)).max() > 1e-8


@pytest.mark.parametrize(("name", "weights", "order"), EMBEDDED)
def test_order_conditions_of_embedded_solutions(name, weights, order):
    """The estimate begins with the power of h that follows the order of the embedded solution."""
    tableau = METHODS[name].tableau
    estimate = getattr(tableau, weights)
    embedded = [b - e for b, e in zip(tableau.b, estimate, strict=True)]
    for nodes in range(1, order + 1):
        np.testing.assert_allclose(residuals(tableau, embedded, nodes), 0, atol=1e-14)
    assert np.abs(residuals(tableau, estimate, order + 1, claims=False)).max() > 1e-6


# steps ---------------------------------------------------------------------------------------


def rate(t, x):
    """``x' = 2 t x ln y, y' = −2 t y ln x`` with ``x = exp(sin t²), y = exp(cos t²)``."""
    return np.array([2 * t * x[0] * np.log(x[1]), -2 * t * x[1] * np.log(x[0])])


def exact(t):
    return np.exp([np.sin(t * t), np.cos(t * t)])


def slopes(tableau: ButcherTableau, t, h, x) -> list[np.ndarray]:
    results: list[np.ndarray] = []
    for c, row in zip(tableau.c, ((), *tableau.a), strict=True):
        results.append(
            rate(t + c * h, x + h * sum(a * k for a, k in zip(row, results, strict=True)))
        )
    return results


def combined(weights, slopes, h):
    return h * sum(w * k for w, k in zip(weights, slopes, strict=True))


@pytest.mark.parametrize("name", METHODS)
def test_measured_order(name):
    """The error at the end of a run falls with the order claimed."""
    tableau = METHODS[name].tableau
    start, end = 0.2, 1.4
    # small enough for the leading term, large enough to stay above round-off
    counts = np.array([8, 12, 16] if tableau.order > 5 else [32, 64, 128])
    errors = []
    for count in counts:
        h, x = (end - start) / count, exact(start)
        for k in range(count):
            t = start + k * h
            x = x + combined(tableau.b, slopes(tableau, t, h, x), h)
        errors.append(np.abs(x - exact(end)).max())
    measured = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert abs(measured - tableau.order) < 0.2, (measured, errors)


@pytest.mark.parametrize("name", ["DormandPrince", "DormandPrince853"])
def test_error_estimate_falls_with_its_order(name):
    """The estimate of one step, two of them combined in the norm, falls as h^(error_order+1)."""
    tableau = METHODS[name].tableau
    t, lengths = 0.7, np.array([0.04, 0.02, 0.01])
    estimates = []
    for h in lengths:
        computed = slopes(tableau, t, h, exact(t))
        square = np.sum(combined(tableau.b_error, computed, h) ** 2)
        low = 0
        if tableau.b_error_low is not None:
            low = np.sum(combined(tableau.b_error_low, computed, h) ** 2)
        estimates.append(square / np.sqrt(square + 0.01 * low))
    measured = np.polyfit(np.log(lengths), np.log(estimates), 1)[0]
    assert abs(measured - tableau.error_order - 1) < 0.2, (measured, estimates)


# stability -----------------------------------------------------------------------------------


@pytest.mark.parametrize("name", METHODS)
def test_stability_function_is_a_step_of_the_linear_equation(name):
    """``R(z) = 1 + z bᵀ(I − zA)⁻¹1`` for arrays of complex z."""
    tableau = METHODS[name].tableau
    s = tableau.stages
    a = np.zeros((s, s))
    for i, row in enumerate(tableau.a, start=1):
        a[i, :i] = row
    z = np.array([[0.3 - 0.2j, -1.7], [2.1j, -2.5 + 1.5j]])
    expected = [
        1 + v * np.dot(tableau.b, np.linalg.solve(np.eye(s) - v * a, np.ones(s))) for v in z.flat
    ]
    np.testing.assert_allclose(tableau.stability(z), np.reshape(expected, z.shape), rtol=1e-12)
    assert tableau.stability(0.0) == 1


@pytest.mark.parametrize("name", METHODS)
def test_stability_function_agrees_with_exp_to_the_order(name):
    """Taylor coefficients of R, by its values on the unit circle, are 1/k! up to the order only."""
    tableau = METHODS[name].tableau
    circle = np.exp(2j * np.pi * np.arange(32) / 32)
    coefficients = np.fft.fft(tableau.stability(circle)) / 32
    powers = np.arange(tableau.order + 2)
    difference = np.abs(coefficients[powers] - 1 / np.cumprod(np.maximum(powers, 1)))
    assert difference[:-1].max() < 1e-13
    assert difference[-1] > 1e-8


@pytest.mark.parametrize(
    ("name", "direction", "bound"),
    [
        ("Euler", -1, 2.0),
        ("Heun", -1, 2.0),
        ("RK4", -1, 2.7853),
        ("RKGill", -1, 2.7853),
        ("RK4", 1j, 2 * np.sqrt(2)),
        ("DormandPrince", -1, 3.3066),
    ],
)
def test_bounds_of_stability(name, direction, bound):
    """Where the ray leaves |R| ≤ 1 (Hairer and Wanner 1996, IV.2)."""
    stability = METHODS[name].tableau.stability
    root = brentq(lambda r: abs(stability(direction * r)) - 1, 0.9 * bound, 1.1 * bound)
    assert root == pytest.approx(bound, abs=1e-4)
    inside = np.linspace(0, 0.999 * bound, 200)
    assert np.abs(stability(direction * inside)).max() <= 1 + 1e-14


@pytest.mark.parametrize("name", ["Euler", "Heun"])
def test_undamped_oscillations_grow(name):
    """Neither method holds a piece of the imaginary axis."""
    y = np.linspace(0.1, 2, 20)
    assert np.abs(METHODS[name].tableau.stability(1j * y)).min() > 1


# wrong tableaux ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"c": (0, 0.9)}, r"row sums \[0.0, 1.0\] differ from nodes \(0, 0.9\)"),
        ({"c": (0, 1, 1)}, "2 weights need rows of lengths 1…1 and as many nodes"),
        ({"a": ((0.5, 0.5),)}, r"not rows of lengths \[2\]"),
        ({"b": (0.5, 0.4)}, "weights sum to 0.9, not 1"),
        ({"b_error": (0.5, 0.5), "error_order": 1}, "b_error sums to 1.0, not 0"),
        ({"b_error": (0.5, -0.5, 0), "error_order": 1}, "b_error has 3 weights for 2 stages"),
        ({"b_error": (0.5, -0.5)}, "give b_error and error_order, or neither"),
        ({"error_order": 1}, "give b_error and error_order, or neither"),
        ({"b_error_low": (0.5, -0.5)}, "b_error_low needs b_error"),
    ],
)
def test_wrong_tableaux_are_refused(wrong, message):
    right = {"a": ((1,),), "b": (0.5, 0.5), "c": (0, 1), "order": 2}
    ButcherTableau(**right)
    with pytest.raises(UnsupportedError, match=message):
        ButcherTableau(**(right | wrong))


@pytest.mark.parametrize("kind", [da.DormandPrince, da.DormandPrince853])
@pytest.mark.parametrize("wrong", [{"rtol": 0}, {"atol": -1e-9}, {"max_step": 0.0}])
def test_adaptive_methods_refuse_what_is_not_positive(kind, wrong):
    with pytest.raises(
        UnsupportedError, match=rf"{kind.__name__}\(.*{next(iter(wrong))}=.*positive"
    ):
        kind(**wrong)
