"""Constraints: position, velocity and acceleration equations against textbook equations in NumPy.

The twin states Φ once more by hand; its derivatives are taken by complex step and Richardson
differences along a motion, so a wrong sign in an element is seen, not only a wrong derivative.
"""

from __future__ import annotations

import functools

import casadi as ca
import numpy as np
import pytest
from registry import CASES, CONSTRAINED, model_of
from spatial_twins import moved
from twins import complex_step, context, rate, second_rate

SEEDS = range(3)


@functools.cache
def equations_of(name: str) -> ca.Function:
    """``(t, y, v, v̇, p) → Φ, Ψ, C v̇ − ξ, ∂Φ/∂p``."""
    e = model_of(name).all_equations
    second = ca.mtimes(e.jacobian, e.a) - e.constraint_acceleration
    outputs = [e.constraints, e.velocity_constraints, second, ca.jacobian(e.constraints, e.p)]
    return ca.Function("equations", [e.t, e.y, e.v, e.a, e.p], outputs)


def general_state(name: str, seed: int):
    """A state near the start that satisfies nothing in particular."""
    model, rng = model_of(name), np.random.default_rng(seed)
    n = model.start.v.size
    y = moved(model, model.start.y, 0.1 * rng.standard_normal(n))
    return 0.13 + 0.05 * seed, y, rng.standard_normal(n), rng.standard_normal(n), model.nominal


def residual(name: str, t, y, p) -> np.ndarray:
    return np.atleast_1d(CASES[name].residual(context(model_of(name), t, y, p)))


def along(name: str, t, y, step, p) -> np.ndarray:
    """The same at a displacement from a position."""
    return residual(name, t, moved(model_of(name), y, step), p)


@pytest.mark.few(30)
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", CONSTRAINED)
def test_position_equations_are_the_textbook_ones(name, seed):
    """Φ(y, t) as written by hand."""
    t, y, v, a, p = general_state(name, seed)
    phi = equations_of(name)(t, y, v, a, p)[0].full().ravel()
    np.testing.assert_allclose(phi, residual(name, t, y, p), atol=1e-13)


@pytest.mark.few(16)
@pytest.mark.parametrize("name", CONSTRAINED)
def test_start_satisfies_the_textbook_equations(name):
    """Assembly closes the twin's equations, in position and speed."""
    start, p = model_of(name).start, model_of(name).nominal
    assert np.abs(residual(name, 0.0, start.y, p)).max() < 1e-11
    assert np.abs(rate(lambda s: along(name, s, start.y, s * start.v, p))).max() < 1e-11


@pytest.mark.few(40)
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", CONSTRAINED)
def test_velocity_equations(name, seed):
    """C v + Φ_t is the rate of Φ along any motion."""
    t, y, v, a, p = general_state(name, seed)
    psi = equations_of(name)(t, y, v, a, p)[1].full().ravel()
    np.testing.assert_allclose(psi, rate(lambda s: along(name, t + s, y, s * v, p)), atol=1e-12)


@pytest.mark.few(30)
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("name", CONSTRAINED)
def test_acceleration_equations(name, seed):
    """C v̇ − ξ is the second rate of Φ along any motion."""
    t, y, v, a, p = general_state(name, seed)
    computed = equations_of(name)(t, y, v, a, p)[2].full().ravel()
    expected = second_rate(lambda s: along(name, t + s, y, s * v + s**2 * a / 2, p))
    np.testing.assert_allclose(computed, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.few(16)
@pytest.mark.parametrize("name", CONSTRAINED)
def test_design_derivatives(name):
    """∂Φ/∂p by complex step of the twin."""
    t, y, v, a, p = general_state(name, 0)
    computed = equations_of(name)(t, y, v, a, p)[3].full()
    expected = complex_step(lambda q: residual(name, t, y, q), p)
    np.testing.assert_allclose(computed, expected, atol=1e-12)
