"""Forces: generalised forces, potentials and powers against wrenches written out in NumPy."""

from __future__ import annotations

import functools

import casadi as ca
import numpy as np
import pytest
from registry import CASES, LOADED, model_of
from twins import context, cross

import dalembert as da
from dalembert import planar

CONSERVATIVE = [n for n, c in CASES.items() if c.conservative]


@functools.cache
def functions_of(name: str) -> ca.Function:
    """``(t, y, v, p) → f, ∂V/∂y, powers``."""
    model = model_of(name)
    e = model.all_equations
    outputs = [e.force, e.by_displacement(model.equations.potential).T, model.equations.potential]
    return ca.Function("forces", [e.t, e.y, e.v, e.p], outputs)


def states(name: str):
    """States in general position; on the constraints where the element needs that."""
    model, rng = model_of(name), np.random.default_rng(3)
    y, v, p = model.start.y, model.start.v, model.nominal
    yield 0.0, y, v, p
    if not model.constraints:
        for t in (0.1, 0.7):
            step = 0.1 * rng.standard_normal((2, y.size))
            yield t, y + step[0], v + 3 * step[1][: v.size], p


def generalised_force(name: str, t, y, v, p) -> np.ndarray:
    """Sum of all wrenches, moved to the mass centres, and of the weights."""
    model = model_of(name)
    c = context(model, t, y, p, v)
    wrench = {b.name: np.zeros(3) for b in model.bodies}
    for body, force, place, moment in CASES[name].loads(c):
        wrench[body] += np.append(force, moment + cross(place - c.body[body].r, force))
    for body in wrench:
        wrench[body][:2] += getattr(c.p, f"{body}_m") * np.array([c.p.gx, c.p.gy])
    return np.concatenate([wrench[b.name][: b.pose.numel()] for b in model.bodies])


@pytest.mark.parametrize("name", LOADED)
def test_generalised_forces_are_the_textbook_wrenches(name):
    """f = Σ (F, M + (r_P − r) × F) + m g."""
    for state in states(name):
        computed = functions_of(name)(*state)[0].full().ravel()
        np.testing.assert_allclose(
            computed, generalised_force(name, *state), rtol=1e-12, atol=1e-12
        )


@pytest.mark.few(18)
@pytest.mark.parametrize("name", CONSERVATIVE)
def test_conservative_forces_have_a_potential(name):
    """At rest, f = −Aᵀ ∂V/∂y."""
    for t, y, v, p in states(name):
        force, slope, _ = (a.full().ravel() for a in functions_of(name)(t, y, 0 * v, p))
        np.testing.assert_allclose(force, -slope, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", CASES)
def test_weight_has_the_potential_of_its_height(name):
    """Turning gravity off takes −Σ m g·r from the potential."""
    model = model_of(name)
    y, p = model.start.y, model.nominal
    light = model.values({n: 0.0 for n in ("gx", "gy", "gz") if n in model.parameters})
    zero = np.zeros(model.start.v.size)
    potential = functions_of(name)
    taken = float(potential(0, y, zero, p)[2]) - float(potential(0, y, zero, light)[2])
    c = context(model, 0, y, p)
    masses = [getattr(c.p, f"{b.name}_m") for b in model.bodies]
    centres = [getattr(c, b.name).r for b in model.bodies]
    g = [getattr(c.p, name) for name in ("gx", "gy", "gz") if hasattr(c.p, name)]
    lift = sum(m * np.dot(g, r) for m, r in zip(masses, centres, strict=True))
    assert taken == pytest.approx(-lift, abs=1e-12)


@pytest.mark.few(20)
@pytest.mark.parametrize("name", CASES)
def test_friction_and_damping_only_take_energy(name):
    """The dissipated power is never negative."""
    model = model_of(name)
    e = model.all_equations
    power = ca.Function("loss", [e.t, e.y, e.v, e.p], [e.powers[0]])
    rng = np.random.default_rng(0)
    for _ in range(5):
        v = 3 * rng.standard_normal(e.v.numel())
        assert float(power(0.3, model.start.y, v, model.nominal)) >= 0


@pytest.mark.parametrize("what", ["angular_velocity", "angular_acceleration"])
def test_what_a_force_acts_along_is_a_position(what):
    system = da.System("spinning")
    wheel = system.add(planar.Body("wheel", mass=1.0, inertia=0.1))
    system.add(planar.Stop("stop", wheel.angle + getattr(wheel, what), upper=1.0, stiffness=9.0))
    with pytest.raises(da.DalembertError, match=r"stop: depends on wheel.*only parameters"):
        system.build()
