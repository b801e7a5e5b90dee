"""A run of 2 T is a run of T, gone on with for T."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

STEP = 2.0**-7


def pendulum() -> da.Model:
    system = da.System("double pendulum", gravity=(0, -9.81))
    length = system.parameter("length", 0.5)
    upper = system.add(planar.Bar("upper", length=length, mass=1.0, angle=0.3))
    lower = system.add(planar.Bar("lower", length=0.4, mass=0.5, angle=1.0, position=(0.5, 0.1)))
    system.add(planar.Revolute("O", system.ground.center, upper.start))
    system.add(planar.Revolute("P", upper.end, lower.start))
    return system.build()


def bouncing() -> da.Model:
    """A ball that is thrown, bounces to rest on a floor, slides there and stops."""
    system = da.System("ball", gravity=(0, -9.81))
    height = system.parameter("height", 0.3)
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0, height), velocity=(3.0, 0)))
    floor = planar.UnilateralConstraint(
        "floor", ball.y, ball.velocity[0], restitution=0.4, friction=0.2
    )
    system.add(floor)
    return system.build()


def stopped() -> da.Model:
    """An oscillator between stops: switches that adaptive integrators hold."""
    system = da.System("oscillator")
    speed = system.parameter("speed", 3.0)
    body = system.add(planar.Particle("body", mass=1.0, position=(0.5, 0), velocity=(speed, 0)))
    system.add(planar.PinInSlot("rail", system.ground.center, body.center))
    ends = system.ground.center, body.center
    system.add(planar.Stop("stop", body.x, stiffness=1e3, damping=1.0, upper=0.6))
    system.add(planar.Spring("spring", *ends, stiffness=100.0, free_length=0.5))
    return system.build()


def end(motion: da.Motion) -> np.ndarray:
    s = motion.trajectory
    return np.concatenate([s.y[:, -1], s.v[:, -1], s.work[:, -1]])


INTEGRATORS = [
    da.RK4(),
    da.Heun(),
    da.GeneralizedAlpha(),
    da.Newmark(),
]


@pytest.mark.parametrize("integrator", INTEGRATORS, ids=lambda one: type(one).__name__)
def test_two_halves_are_the_whole(integrator) -> None:
    model, options = pendulum(), {"step": STEP, "integrator": integrator}
    whole = da.solve_dynamics(model, 0.5, **options)
    motion = da.solve_dynamics(model, 0.25, **options).continued(0.25)
    np.testing.assert_array_equal(motion.time, whole.time)
    np.testing.assert_allclose(motion.trajectory.y, whole.trajectory.y, rtol=0, atol=1e-14)
    np.testing.assert_allclose(end(motion), end(whole), rtol=0, atol=1e-13)


def test_contacts_keep_their_phases() -> None:
    """Between bounces and while it slides: impacts, rest and gradients of the whole.

    When bounces count as none depends on the length of a run.
    """
    model, options = bouncing(), {"step": STEP}
    whole = da.solve_dynamics(model, 1.75, **options)
    motion = da.solve_dynamics(model, 0.5, **options).continued(1.25)
    assert len(motion.impacts) == len(whole.impacts) > 5
    for one, other in zip(motion.impacts, whole.impacts, strict=True):
        assert one.time == pytest.approx(other.time, abs=1e-12)
        assert one.normal == pytest.approx(other.normal, rel=1e-9, abs=1e-13)
    np.testing.assert_allclose(end(motion), end(whole), rtol=0, atol=1e-11)
    slid = da.solve_dynamics(model, 0.75, **options).continued(1.0)
    np.testing.assert_allclose(end(slid), end(whole), rtol=0, atol=1e-9)
    assert whole.values("ball.vx")[-1] == 0.0
    count = "accumulation of impacts"
    assert motion.statistics[count] == whole.statistics[count]
    places = [da.sensitivity(one, da.Final("ball.x")).values for one in (motion, whole)]
    np.testing.assert_allclose(*places, rtol=1e-8)


def test_error_control_goes_on() -> None:
    """Both halves within the tolerance; the memory of BDF and the sides of switches stay."""
    for integrator in (da.DormandPrince(), da.BDF()):
        model = stopped()
        whole = da.solve_dynamics(model, 1.0, integrator=integrator)
        motion = da.solve_dynamics(model, 0.05, integrator=integrator).continued(0.95)
        assert motion.status.success and not motion.warnings
        np.testing.assert_allclose(end(motion), end(whole), rtol=0, atol=1e-5)
        slopes = [da.sensitivity(one, da.Final("body.x")).values for one in (motion, whole)]
        np.testing.assert_allclose(*slopes, rtol=1e-4)


def test_gradients_and_integrals_are_those_of_the_whole() -> None:
    model, options = pendulum(), {"step": STEP, "outputs": 9}
    whole = da.solve_dynamics(model, 1.0, **options | {"outputs": 17})
    motion = da.solve_dynamics(model, 0.5, memory=2e3, **options).continued("500 ms")
    np.testing.assert_array_equal(motion.time, whole.time)
    for response in (da.Final("lower.angle"), da.Integral("lower.angle**2")):
        for method in (da.Direct(), da.Adjoint()):
            gradients = [da.sensitivity(one, response, method=method) for one in (motion, whole)]
            np.testing.assert_allclose(gradients[0].values, gradients[1].values, rtol=1e-10)
    again = motion.analysis.replay(motion, model.values({"length": 0.51}))
    other = da.solve_dynamics(model, 1.0, parameters={"length": 0.51}, **options)
    np.testing.assert_allclose(end(again), end(other), rtol=0, atol=1e-12)


def test_options_of_what_follows() -> None:
    model = pendulum()
    swings = {"low": da.Event("upper.angle", terminal=True)}
    result = da.solve_dynamics(model, 2.0, step=STEP, events=swings)
    assert result.status.outcome is da.Outcome.TERMINATED
    with pytest.raises(da.AnalysisError, match=r"ended by event 'low'.*other events="):
        result.continued(0.5)
    with pytest.raises(da.AnalysisError, match="ended by event 'low'"):
        result.continued(0.5, events=swings)
    motion = result.continued(0.5, events={}, step=STEP / 2, outputs=3)
    assert motion.time[-1] == pytest.approx(result.time[-1] + 0.5)
    assert motion.time.size == result.time.size + 2
    assert motion.status.outcome is da.Outcome.COMPLETED


def test_runs_that_cannot_continue_are_refused() -> None:
    model = pendulum()
    with pytest.raises(da.AnalysisError, match="duration"):
        da.solve_dynamics(model, 0.1, step=STEP).continued(-1.0)
    with pytest.raises(da.UnsupportedError, match="Equilibrium cannot be continued"):
        da.solve_equilibrium(model).continued(1.0)
    length = model.parameters["length"]
    with pytest.raises(da.AnalysisError, match="follow parameters"):
        da.solve_dynamics(model, length * da.Expression(1.0), step=STEP).continued(1.0)


def test_wrong_arguments_are_told():
    motion = da.solve_dynamics(pendulum(), 0.1, step=STEP)
    with pytest.raises(da.errors.KeywordError, match=r"did you mean 'outputs'.*known: duration, s"):
        motion.continued(0.1, outputz=3)
    with pytest.raises(da.errors.KeywordError, match=r"missing duration; needed: duration$"):
        motion.continued()
