"""Forces in space: generalised forces, potentials and powers against wrenches written in NumPy."""

from __future__ import annotations

import functools

import casadi as ca
import numpy as np
import pytest
from spatial_registry import SPATIAL_CASES, context, spatial_model_of

import dalembert as da
from dalembert import spatial
from dalembert.elements import registry

CONSERVATIVE = [n for n, c in SPATIAL_CASES.items() if c.conservative]
NOT_HERE = {"Mesh", "FlexibleBody", "Node", "PointNode", "UnilateralConstraint", "Collisions"}
"""Bodies from files, of structures and of finite elements, and rigid contacts: they have laws of
their own."""


@pytest.mark.parametrize("section", ["bodies", "forces"])
def test_every_element_has_a_case(section):
    covered = {kind for case in SPATIAL_CASES.values() for kind in case.covers}
    rows = registry.SPATIAL.sections[section]
    assert {kind for name, kind in rows.items() if name not in NOT_HERE} <= covered


@functools.cache
def functions_of(name: str) -> ca.Function:
    """``(t, y, v, p) → f, ∂V/∂δ``."""
    e = spatial_model_of(name).all_equations
    slope = ca.gradient(e.potential, e.y)
    return ca.Function("forces", [e.t, e.y, e.v, e.p], [e.force, ca.mtimes(e.lift.T, slope)])


def states(name: str):
    """States in general position; on the constraints where the element needs that."""
    model, rng = spatial_model_of(name), np.random.default_rng(3)
    y, v, p = model.start.y, model.start.v, model.nominal
    yield 0.0, y, v, p
    if not model.constraints:
        for t in (0.1, 0.7):
            moved = model.equations.manifold.go(y, 0.3 * rng.standard_normal(v.size))
            yield t, moved, v + 2 * rng.standard_normal(v.size), p


def generalised_force(name: str, t, y, v, p) -> np.ndarray:
    """``(F, Rᵀ (M + (r_P − r) × F))`` of all wrenches, and the weights."""
    model = spatial_model_of(name)
    c = context(model, t, y, v, p)
    mass = ca.Function("m", [model.equations.p], [b.mass.sx for b in model.bodies])
    weights = [float(m) * c.p.g for m in mass.call([p])]
    results = {b.name: [w, np.zeros(3)] for b, w in zip(model.bodies, weights, strict=True)}
    for body, force, place, moment in SPATIAL_CASES[name].loads(c):
        about = moment + np.cross(place - c.body[body].r, force)
        results[body][0] = results[body][0] + force
        results[body][1] = results[body][1] + c.body[body].R.T @ about
    return np.concatenate(
        [np.concatenate(results[b.name])[: b.twist.numel()] for b in model.bodies]
    )


@pytest.mark.parametrize("name", SPATIAL_CASES)
def test_generalised_forces_are_the_textbook_wrenches(name):
    for state in states(name):
        computed = functions_of(name)(*state)[0].full().ravel()
        np.testing.assert_allclose(
            computed, generalised_force(name, *state), rtol=1e-11, atol=1e-11
        )


@pytest.mark.parametrize("name", CONSERVATIVE)
def test_conservative_forces_have_a_potential(name):
    """At rest, ``f = −∂V/∂δ``."""
    for t, y, v, p in states(name):
        force, slope = (a.full().ravel() for a in functions_of(name)(t, y, 0 * v, p))
        np.testing.assert_allclose(force, -slope, rtol=1e-12, atol=1e-12)


@pytest.mark.few(7)
@pytest.mark.parametrize("name", SPATIAL_CASES)
def test_friction_and_damping_only_take_energy(name):
    """The dissipated power is never negative, and nothing is put in where nothing drives."""
    model = spatial_model_of(name)
    e = model.all_equations
    powers = ca.Function("powers", [e.t, e.y, e.v, e.multiplier, e.p], [e.powers])
    rng = np.random.default_rng(0)
    for _ in range(5):
        v, multiplier = (3 * rng.standard_normal(x.numel()) for x in (e.v, e.multiplier))
        loss, put_in = powers(0.3, model.start.y, v, multiplier, model.nominal).full().ravel()
        assert loss >= 0
        if SPATIAL_CASES[name].conservative:
            assert put_in == pytest.approx(0.0, abs=1e-9)


def test_a_bushing_may_turn_round():
    """Its energy goes on smoothly beyond half a turn, and its moment about one axis is k sin φ."""
    system = da.System("round")
    body = spatial.Body("b", mass=1.0, inertia=(0.3, 0.2, 0.25), angular_velocity=(0.4, -0.3, 9.0))
    system.add(body)
    stiffness = {"stiffness": (9.0, 9.0, 9.0), "rotational_stiffness": (1.0, 2.0, 3.0)}
    damping = {"rotational_damping": (0.01, 0.02, 0.03)}
    ends = system.ground.frame(axis=(0, 0, 1)), body.frame()
    system.add(spatial.Bushing("F", *ends, **stiffness, **damping))
    model = system.build()
    motion = da.solve_dynamics(model, 1.0, integrator=da.DormandPrince(1e-9, 1e-9))
    assert motion.status.success
    turned = np.unwrap(np.asarray(motion["b.bryant.z"]))
    assert turned[-1] > 1.3 * np.pi
    assert np.abs(motion["balance_error"]).max() < 1e-7
    e = model.all_equations
    moment = ca.Function("m", [e.y, e.v, e.p], [e.force[5]])
    for angle in (0.4, 1.7, 3.1, 3.2, 5.0):
        y = np.r_[np.zeros(3), np.cos(angle / 2), 0, 0, np.sin(angle / 2)]
        assert float(moment(y, np.zeros(6), [])) == pytest.approx(-3.0 * np.sin(angle), abs=1e-12)


@pytest.mark.few(2)
@pytest.mark.parametrize("name", SPATIAL_CASES)
def test_the_same_motion_in_joint_coordinates(name):
    model = spatial_model_of(name)
    ends = [
        da.solve_dynamics(model, 0.004, step=0.001, coordinates=coordinates)
        for coordinates in (da.AbsoluteCoordinates(), da.JointCoordinates())
    ]
    for body in model.bodies:
        own, other = (np.asarray(motion[f"{body.name}.velocity"]) for motion in ends)
        np.testing.assert_allclose(own, other, atol=1e-8 * np.abs(own).max())
