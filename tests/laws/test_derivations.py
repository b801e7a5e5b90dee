"""Gibbs–Appell and Kane (6.12)–(6.15): other roads to the projective equations (6.9)."""

from __future__ import annotations

from itertools import product

import casadi as ca
import numpy as np
import pytest
from partition import evaluated, general_state, partition
from registry import CONSTRAINED
from thorough import sampled

import dalembert as da
from dalembert.model.graph.derivation import appell_function, gibbs_appell, kane
from dalembert.model.graph.transformation import speeds_by_basis

ROADS = {"Gibbs–Appell": gibbs_appell, "Kane": kane}
CASES = sampled(product(CONSTRAINED, ROADS), 5)
"""A sample, as no analysis uses these equations."""


@pytest.mark.few(11)
@pytest.mark.parametrize(("name", "road"), CASES)
def test_same_equations_as_the_projective_scheme(name, road):
    """``M̂ u̇ + d̂ − f̂``, whatever the accelerations are."""
    e, motion = partition(name)
    reduced = motion.apply(e).with_rows([])
    scheme = ca.mtimes(reduced.mass, motion.a) + reduced.bias - reduced.force
    rates = ca.DM(np.random.default_rng(1).standard_normal(motion.a.numel()))
    sides = ca.substitute([ROADS[road](e, motion), scheme], [motion.a], [ca.SX(rates)])
    computed, expected = evaluated(reduced, sides, general_state(reduced, 2, name))
    np.testing.assert_allclose(computed, expected, atol=1e-11 * (1 + np.abs(expected).max()))


@pytest.mark.few(11)
@pytest.mark.parametrize(("name", "road"), CASES)
def test_solved_by_the_constrained_motion(name, road):
    """The accelerations of the saddle system (5.7) satisfy them; no multiplier is left."""
    e, motion = partition(name)
    saddle = da.KKT().acceleration(e, e.constraint_acceleration, [e.a])
    rates = saddle.function(e.t, ca.vertcat(e.y, e.v, ca.SX.zeros(2)), e.p)
    rates = ca.mtimes(motion.basis.T, motion.seen(e, rates) - motion.gamma)
    rates = ca.solve(ca.mtimes(motion.basis.T, motion.basis), rates)  # u̇ of v̇ = D u̇ + γ
    residual = ca.substitute(ROADS[road](e, motion), motion.a, rates)
    reduced = motion.apply(e).with_rows([])
    computed, size = evaluated(reduced, [residual, reduced.force], general_state(reduced, 3, name))
    assert np.abs(computed).max(initial=0) < 1e-9 * (1 + np.abs(size).max(initial=0))


@pytest.mark.parametrize("name", sampled(CONSTRAINED, 5))
def test_appell_function_has_one_least_value(name):
    """M̂ is the Hessian of S in the accelerations, and positive definite (Gauss)."""
    e, motion = partition(name)
    reduced = motion.apply(e).with_rows([])
    hessian = ca.hessian(appell_function(e, motion), motion.a)[0]
    computed, mass = evaluated(reduced, [hessian, reduced.mass], general_state(reduced, 4, name))
    np.testing.assert_allclose(computed, mass, atol=1e-12)
    assert np.linalg.eigvalsh(mass).min(initial=1) > 0


@pytest.mark.parametrize("road", ROADS)
@pytest.mark.parametrize("name", ["revolute", "distance driver", "rigid link"])
def test_quasi_velocities(name, road):
    """Other independent speeds ``u = B w``: the equations are those in u, times Bᵀ."""
    e, motion = partition(name)
    k = motion.v.numel()
    w = ca.SX.sym("w", k)
    basis = ca.SX.eye(k) + ca.sin(e.y[0] + e.t) * ca.SX.ones(k, k) / (2 * k)
    reduced = motion.apply(e).with_rows([])
    mixing = speeds_by_basis(reduced, basis, w)
    d = ca.substitute(motion.basis, motion.v, mixing.old_v)
    drift = ca.substitute(motion.old_v, motion.v, 0 * motion.v)
    direct = speeds_by_basis(e, ca.mtimes(d, basis), mixing.v, drift)
    direct_side = ca.substitute(ROADS[road](e, direct), direct.a, mixing.a)
    in_steps = ca.substitute(ROADS[road](e, motion), motion.a, mixing.old_a)
    in_steps = ca.mtimes(basis.T, ca.substitute(in_steps, motion.v, mixing.old_v))
    sides = ca.substitute([direct_side, in_steps], [mixing.a], [ca.SX.ones(k)])
    state = general_state(mixing.apply(reduced), 6, name)
    computed, expected = evaluated(mixing.apply(reduced), sides, state)
    np.testing.assert_allclose(computed, expected, atol=1e-11 * (1 + np.abs(expected).max()))
