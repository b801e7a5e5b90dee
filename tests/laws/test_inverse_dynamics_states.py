"""Inverse dynamics of models with states of first order: these integrate along the motion."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar

RATE = 0.7


def arm(driven: bool = True, steady: bool = False) -> da.Model:
    """A bar that turns by ``t²`` against a spring whose strain relaxes."""
    system = da.System("arm", gravity=(0, -10))
    rate = system.parameter("rate", RATE, bounds=(0.1, 2))
    bar = system.add(planar.Bar("bar", length=1.0, mass=3.0))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    if driven:
        system.add(planar.RotationalDriver("motor", system.ground, bar, 0.3 + da.t**2))
    x = system.add(da.blocks.State("x", start=0.1 * rate, steady=steady))
    x.rate = bar.angle - rate * x.value
    system.add(planar.Torque("push", bar, 5 * x.value))
    return system.build()


def effort(t: np.ndarray, rate: float, start: float) -> np.ndarray:
    """``J φ̈ + m g l/2 cos φ − 5 x`` with ``ẋ = φ − rate x`` by an independent integrator."""
    options = {"rtol": 1e-12, "atol": 1e-13, "method": "DOP853", "dense_output": True}
    run = solve_ivp(lambda t, x: 0.3 + t * t - rate * x, (0, 1), [start], **options)
    return 1.0 * 2 + 15 * np.cos(0.3 + t**2) - 5 * run.sol(t)[0]


@pytest.mark.parametrize(
    ("options", "count"),
    [({"step": 0.01}, 101), ({"step": 0.3}, 5), ({}, 1001), ({"outputs": 11}, 11)],
)
def test_efforts_are_those_of_integrated_states(options, count):
    motion = da.solve_inverse_dynamics(arm(), 1.0, **options)
    assert motion.status.success and not motion.warnings
    assert motion.time.size == count and motion.time[-1] == 1.0
    expected = effort(motion.time, RATE, 0.1 * RATE)
    assert np.allclose(motion["motor.effort"].values, expected, rtol=0, atol=1e-7)


def test_steady_states_begin_at_rest():
    motion = da.solve_inverse_dynamics(arm(steady=True), 1.0, step=0.1)
    expected = effort(motion.time, RATE, 0.3 / RATE)
    assert np.allclose(motion["motor.effort"].values, expected, rtol=0, atol=1e-7)


def test_gradients_include_the_states():
    motion = da.solve_inverse_dynamics(arm(), 1.0, step=0.1)
    responses = [da.Final("motor.effort"), da.Final("x.value")]
    end, h = np.array([1.0]), 1e-4
    high, low = (effort(end, RATE + d, 0.1 * (RATE + d))[0] for d in (h, -h))
    slope = (high - low) / (2 * h)
    for method in ("adjoint", "direct"):
        gradient = da.sensitivity(motion, responses, method=method).values[:, 0]
        assert np.allclose(gradient, [slope, -slope / 5], rtol=1e-6)


def test_many_designs_and_a_duration_that_follows_a_parameter():
    model, rates = arm(), [0.5, 1.0]
    batch = da.solve_inverse_dynamics(model, 1.0, step=0.1, parameters={"rate": rates})
    for row, rate in zip(batch["motor.effort"].values, rates, strict=True):
        assert np.allclose(row, effort(batch.time, rate, 0.1 * rate), rtol=0, atol=1e-7)
    analysis = da.InverseDynamics(duration=1.0, step=0.5)
    assert analysis.run(model, {"rate": 0.5}).time.tolist() == [0.0, 0.5, 1.0]
    following = da.solve_inverse_dynamics(model, "0.7/rate", step=0.25)
    assert following.time.tolist() == [0.0, 0.25, 0.5, 0.75, 1.0]
    slope = da.sensitivity(following, [da.Final("bar.angle")]).values[0, 0]
    assert slope == pytest.approx(2 * 1.0 * -0.7 / RATE**2, rel=1e-8)  # 2 T dT/d rate


def test_free_motions_are_refused_as_without_states():
    with pytest.raises(da.AnalysisError, match="1 degree of freedom undetermined"):
        da.solve_inverse_dynamics(arm(driven=False), 1.0, step=0.1)


def test_friction_with_a_bristle_holds_its_limit():
    """At a constant speed far above that of Stribeck, sliding friction loads the driver."""
    system = da.System("driven", gravity=(0, 0))
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0))
    hinge = system.add(planar.Revolute("hinge", system.ground.center, bar.start))
    system.add(planar.RotationalDriver("turn", system.ground, bar, 2 * da.t))
    system.add(planar.BristleFriction("rub", hinge, coulomb=1.5))
    model = system.build()
    inverse = da.solve_inverse_dynamics(model, 1.0, step=0.1)
    assert inverse["turn.effort"].values[0] == pytest.approx(0.0, abs=1e-12)
    assert np.allclose(inverse["turn.effort"].values[1:], 1.5, rtol=0, atol=1e-6)
    motion = da.solve_kinematics(model, 1.0, step=0.1)
    assert any("keep their values at the start" in warning for warning in motion.warnings)
