"""Derivatives of what is solved: tangent and adjoint are transposes, and both are right."""

from __future__ import annotations

import numpy as np
import pytest
from registry import CASES, COMBINED, FORMULATIONS, definite, model_of
from spatial_registry import SPATIAL_CASES, any_model_of

from dalembert.analysis.dynamics.dynamics import Dynamics

STEP = 0.01


def difference(function, x: np.ndarray, direction: np.ndarray, h: float = 1e-3) -> np.ndarray:
    """Directional derivative by central differences, extrapolated."""

    def central(d):
        return (function(x + d * direction) - function(x - d * direction)) / (2 * d)

    coarse, middle, fine = central(h), central(h / 2), central(h / 4)
    first, second = (4 * middle - coarse) / 3, (4 * fine - middle) / 3
    return (16 * second - first) / 15


def relative_parameters(p: np.ndarray, rng) -> np.ndarray:
    """A random change of parameters, in proportion to them."""
    return rng.standard_normal(p.size) * (0.1 + np.abs(p)) * 0.3


def flat(outputs) -> np.ndarray:
    outputs = outputs if isinstance(outputs, (tuple, list)) else [outputs]
    return np.concatenate([o.full().ravel() for o in outputs])


@pytest.mark.few(8)
@pytest.mark.parametrize("name", [*CASES, *SPATIAL_CASES])
def test_step(name):
    """One projected Runge–Kutta step: ⟨w, T d⟩ = ⟨Tᵀ w, d⟩ to 1e-12, T d by differences."""
    model, rng = any_model_of(name), np.random.default_rng(5)
    kernel, p = Dynamics(1.0).kernel(model), model.nominal
    x, mode = kernel.initial(model.start, 0.0, p)
    step, n = kernel.variants[mode].step, x.size
    dx, dp, w = rng.standard_normal(n), relative_parameters(p, rng), rng.standard_normal(n)
    change = step.tangents(1)(0.0, STEP, x, p, dx, dp).full().ravel()
    x_bar, p_bar = (a.full().ravel() for a in step.adjoint(0.0, STEP, x, p, w))
    forward, backward = w @ change, x_bar @ dx + p_bar @ dp
    size = np.abs(w) @ np.abs(change) + np.abs(x_bar) @ np.abs(dx) + np.abs(p_bar) @ np.abs(dp)
    assert abs(forward - backward) < 1e-12 * size
    both = np.concatenate([x, p])
    expected = difference(
        lambda z: step.function(0.0, STEP, z[:n], z[n:]).full().ravel(),
        both,
        np.concatenate([dx, dp]),
    )
    np.testing.assert_allclose(change, expected, atol=1e-7 * (1 + np.abs(change).max()))


@pytest.mark.few(9)
@pytest.mark.parametrize(("name", "formulation"), COMBINED)
def test_accelerations(name, formulation):
    """v̇ and λ as functions of state and parameters: the same two laws."""
    model, rng = model_of(name), np.random.default_rng(6)
    e = model.equations
    chosen = definite(FORMULATIONS[formulation], model)
    implicit = chosen.acceleration(e, e.constraint_acceleration)
    x = np.concatenate([model.start.y, model.start.v, [0.0, 0.0]])
    check_implicit(implicit, [np.array([0.1]), x, model.nominal], rng, 1e-8)


def check_implicit(implicit, inputs, rng, tolerance: float) -> None:
    sizes = np.cumsum([i.size for i in inputs])[:-1]
    rates = [rng.standard_normal(i.size) for i in inputs[:-1]]
    rates.append(relative_parameters(inputs[-1], rng))
    weights = [rng.standard_normal(n) for n in implicit.output_sizes]
    change = flat(implicit.tangent(*inputs, *rates))
    back, w, d = (
        flat(implicit.adjoint(*inputs, *weights)),
        np.concatenate(weights),
        np.concatenate(rates),
    )
    size = np.abs(w) @ np.abs(change) + np.abs(back) @ np.abs(d)
    assert abs(w @ change - back @ d) < 1e-12 * size
    expected = difference(
        lambda z: flat(implicit.function(*np.split(z, sizes))), np.concatenate(inputs), d, h=2e-4
    )
    np.testing.assert_allclose(change, expected, atol=tolerance * (1 + np.abs(change).max()))


@pytest.mark.few(8)
@pytest.mark.parametrize("name", [*CASES, *SPATIAL_CASES])
def test_initial_state(name):
    """Assembled positions and speeds by the parameters, against assembling anew."""
    model, rng = any_model_of(name), np.random.default_rng(7)
    p, y = model.nominal, model.start.y
    dp = relative_parameters(p, rng)
    weights = [rng.standard_normal(n) for n in model.initial_state.output_sizes]
    zero = np.zeros(y.size)
    change = flat(model.initial_state.tangent(0.0, y, p, 0.0, zero, dp))
    p_bar = model.initial_state.adjoint(0.0, y, p, *weights)[2].full().ravel()
    assert p_bar @ dp == pytest.approx(np.concatenate(weights) @ change, rel=1e-11, abs=1e-11)

    def assembled(q):
        state = model.assemble(q)
        return np.concatenate([state.y, state.v])

    expected = difference(assembled, p, dp)
    np.testing.assert_allclose(change, expected, atol=1e-7 * (1 + np.abs(change).max()))
