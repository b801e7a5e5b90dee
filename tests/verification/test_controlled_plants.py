"""Controlled plants from model files against their equations by SciPy and python-control."""

from functools import cache

import control
import numpy as np
import pytest
from controlled_plants import PLANTS

import dalembert as da

INTEGRATORS = {  # fixed steps as shares of the duration
    "automatic": ({}, 2e-7),
    "DormandPrince853": ({"integrator": da.DormandPrince853(rtol=1e-12, atol=1e-13)}, 1e-8),
    "Radau": ({"integrator": da.Radau(rtol=1e-9, atol=1e-11)}, 1e-7),
    "BDF": ({"integrator": da.BDF(rtol=1e-9, atol=1e-11)}, 1e-6),
    "CVODES": ({"integrator": da.CVODES(rtol=1e-10, atol=1e-12)}, 1e-7),
    "IDA": ({"integrator": da.IDA(rtol=1e-10, atol=1e-12)}, 1e-7),
    "Trapezoidal": ({"integrator": da.Trapezoidal(), "step": 1 / 5000}, 1e-4),
    "GeneralizedAlpha": ({"integrator": da.GeneralizedAlpha(), "step": 1 / 5000}, 1e-4),
}
REST = ["pid", "filters", "motor", "cylinder"]
FIRST = {"cylinder": np.array([1.0, 0, 0, 0])}
"""Measured minus hand-written states."""


@cache
def model(name: str, folder) -> da.Model:
    return PLANTS[name].model(folder)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("plants")


@cache
def exact(name: str) -> np.ndarray:
    return PLANTS[name].end()


def computed(result, name: str) -> np.ndarray:
    """The measured states of a plant at the end, as in its equations."""
    values = np.array([np.ravel(result[state])[-1] for state in PLANTS[name].states])
    return values - FIRST.get(name, 0.0)


@pytest.mark.few(4)
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("name", PLANTS)
def test_motions(name, integrator, folder):
    plant, (options, tolerance) = PLANTS[name], INTEGRATORS[integrator]
    if "step" in options:
        options = options | {"step": options["step"] * plant.duration}
    motion = da.solve_dynamics(model(name, folder), plant.duration, **options)
    assert motion.status.success
    sizes, count = np.array(plant.sizes), len(plant.states)
    errors = np.abs(computed(motion, name) - exact(name)[:count]) / sizes[:count]
    assert errors.max() < tolerance


@pytest.mark.few(2)
@pytest.mark.parametrize("name", REST)
def test_equilibria_and_poles(name, folder):
    """The balance of forces and rates, and the poles of python-control about it."""
    plant = PLANTS[name]
    rest = da.solve_equilibrium(model(name, folder))
    assert rest.status.success
    values = computed(rest, name)
    near = np.concatenate([values, np.zeros(len(plant.sizes) - values.size)])
    expected = plant.rest(near)
    sizes = np.array(plant.sizes)[: values.size]
    assert (np.abs(values - expected[: values.size]) / sizes).max() < 1e-10
    a = plant.jacobian(expected)
    zero = np.zeros((len(a), 1))
    poles = control.ss(a, zero, zero.T, 0).poles()
    modes = da.linearize(model(name, folder))
    for own in (
        modes.eigenvalues,
        modes.state_space(list(plant.parameters), [plant.states[0]]).poles,
    ):
        distance = np.abs(np.asarray(own)[:, None] / poles - 1).min(axis=1)
        assert distance.max() < 1e-10
    count = len(modes.state_space(list(plant.parameters), [plant.states[0]]).poles)
    assert count == len(poles)


@pytest.mark.parametrize("name", REST)
def test_gradients_of_equilibria(name, folder):
    """``dx/dp = −(∂f/∂x)⁻¹ ∂f/∂p``."""
    plant = PLANTS[name]
    rest = da.solve_equilibrium(model(name, folder))
    values = computed(rest, name)
    x = plant.rest(np.concatenate([values, np.zeros(len(plant.sizes) - values.size)]))
    by_parameter = []
    for parameter, value in plant.parameters.items():
        p = plant.parameters | {parameter: value + 1e-25j}
        by_parameter.append(np.imag(np.array(plant.rate(0.0, x.astype(complex), p))) / 1e-25)
    exact = -np.linalg.solve(plant.jacobian(x), np.array(by_parameter).T)[: values.size]
    responses = [da.final(state) for state in plant.states]
    scale, sizes = np.array(list(plant.parameters.values())), np.array(plant.sizes)
    for method in ("direct", "adjoint"):
        gradient = da.sensitivity(rest, responses, method=method).values
        errors = np.abs(gradient - exact) * scale / sizes[: values.size, None]
        assert errors.max() < 1e-9


@pytest.mark.few(2)
@pytest.mark.parametrize("name", PLANTS)
def test_gradients(name, folder):
    """Direct and adjoint gradients of all states, by complex steps of the equations."""
    plant = PLANTS[name]
    precise = da.DormandPrince853(rtol=1e-11, atol=1e-12)
    motion = da.solve_dynamics(model(name, folder), plant.duration, integrator=precise)
    responses, count = [da.final(state) for state in plant.states], len(plant.states)
    exact = np.array([plant.slope(parameter)[:count] for parameter in plant.parameters]).T
    scale = np.array(list(plant.parameters.values()))
    size = np.abs(exact * scale).max(axis=1, keepdims=True)
    rows = [da.sensitivity(motion, responses, method=m).values for m in ("direct", "adjoint")]
    assert (np.abs(rows[0] - exact) * scale / size).max() < 1e-7
    assert (np.abs(rows[1] - rows[0]) * scale / size).max() < 1e-10
