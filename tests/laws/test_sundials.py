"""CVODES and IDAS: tolerances, what they refuse, how they fail, gradients to tolerance."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from test_stabilization import OUTPUTS, chain, exact

import dalembert as da
from dalembert import planar
from dalembert.analysis.dynamics.dynamics import Dynamics

CASES = {
    "CVODES": (da.CVODES, da.RangeSpace()),
    "IDA": (da.IDA, da.RangeSpace()),
    "IDA on a DAE": (da.IDA, da.DAE(index=1)),
}
STABILIZATIONS = [da.Stabilization(), da.Baumgarte(), da.Projection()]


@pytest.mark.few(5)
@pytest.mark.parametrize("stabilization", STABILIZATIONS, ids=lambda s: type(s).__name__)
@pytest.mark.parametrize("case", CASES)
def test_tolerance_is_met_at_steps_and_between(case, stabilization):
    """Errors of positions, speeds and multipliers follow the tolerance over six decades."""
    method, formulation = CASES[case]
    for tolerance in 10.0 ** -np.arange(5, 12, 2):
        motion = da.solve_dynamics(
            chain(),
            0.64,
            step=0.16,
            integrator=method(tolerance, tolerance),
            formulation=formulation,
            stabilization=stabilization,
            outputs=OUTPUTS,
        )
        assert motion.status.success
        for name in ("y", "v", "multiplier"):
            true = getattr(exact().trajectory, name)
            error = np.abs(getattr(motion.trajectory, name) - true).max()
            assert error < 200 * tolerance * (1 + np.abs(true).max()), name


@pytest.mark.parametrize("formulation", [da.DAE(2), da.DAE(3), da.DAE(2, stabilized=True)])
def test_ida_refuses_a_higher_index_by_name(formulation):
    with pytest.raises(da.UnsupportedError, match=r"index [23]; use integrator=BDF"):
        da.solve_dynamics(chain(), 0.1, integrator=da.IDA(), formulation=formulation)


def test_cvodes_needs_accelerations():
    with pytest.raises(da.UnsupportedError, match="RangeSpace"):
        da.solve_dynamics(chain(), 0.1, integrator=da.CVODES(), formulation=da.DAE())


@pytest.mark.few(1)
@pytest.mark.parametrize("method", [da.CVODES, da.IDA])
def test_failure_inside_an_interval_is_a_status(method, capfd):
    """``ẍ = −1/x³`` reaches x = 0 at t = 1: what was done before stays, nothing is printed."""
    system = da.System("fall")
    body = system.add(planar.Particle("body", mass=1.0, position=(1.0, 0.0)))
    system.add(planar.Force("pull", body.center, (-1 / body.x**3, 0.0)))
    motion = da.solve_dynamics(system.build(), 2.0, step=0.15, integrator=method())
    assert motion.status.outcome is da.Outcome.DIVERGED
    assert "SUNDIALS took" in motion.status.message
    np.testing.assert_allclose(motion.time, 0.15 * np.arange(7))
    x = motion.data.position.values[:, 0, 0]
    np.testing.assert_allclose(x, np.sqrt(1 - motion.time**2), atol=1e-6)
    assert capfd.readouterr() == ("", "")


def test_multipliers_worse_than_the_tolerance_are_told():
    """A large factor of Penalty takes the digits; the cure that is named helps."""
    system = da.System("parallelogram", gravity=(0.0, -9.81))
    place, local = (0.5 + 0.3 * np.cos(0.7), 0.3 * np.sin(0.7)), (-0.5, 0.0, 0.5)
    platform = system.add(planar.Bar("platform", length=1.0, mass=1.0, position=place, angle=0.0))
    for k, x in enumerate(local):
        crank = system.add(planar.Bar(f"crank{k}", length=0.3, mass=0.2, angle=0.7))
        system.add(planar.Revolute(f"A{k}", system.ground.point(x + 0.5, 0), crank.start))
        system.add(planar.Revolute(f"B{k}", crank.end, platform.point(x, 0)))
    model, formulation = system.build(), da.Penalty(factor=1e8)
    lost = da.solve_dynamics(model, 0.1, integrator=da.IDA(), formulation=formulation)
    assert not lost.status.success and "Use a larger rtol" in lost.status.message
    assert da.solve_dynamics(
        model, 0.1, integrator=da.IDA(rtol=1e-8), formulation=formulation
    ).status.success


def pendulum() -> da.Model:
    """Its length and first speed are parameters."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    length, speed = system.parameter("length", 0.8), system.parameter("speed", 1.5)
    bar = planar.Bar("bar", length=length, mass=1.0, angle=-0.4, angular_velocity=speed)
    bar = system.add(bar)
    system.add(planar.Revolute("pin", system.ground.point(0, 0), bar.start))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("method", [da.CVODES, da.IDA])
def test_gradients_are_right_to_about_the_tolerance(method):
    """Direct and adjoint against the exact gradients of short RK4 steps."""
    model, responses = pendulum(), [da.final("bar.angle"), da.integral("pin.force_norm")]
    outputs = np.linspace(0, 0.6, 13)
    fine = Dynamics(0.6, step=1e-3, outputs=outputs).run(model)
    true = da.sensitivity(fine, responses).values
    motion = Dynamics(0.6, step=0.2, integrator=method(1e-9, 1e-9), outputs=outputs).run(model)
    for way in (da.Direct(), da.Adjoint()):
        gradient = da.sensitivity(motion, responses, method=way).values
        np.testing.assert_allclose(gradient, true, rtol=0, atol=1e-6 * np.abs(true).max())


@pytest.mark.thorough
@pytest.mark.parametrize("method", [da.CVODES, da.IDA])
def test_outputs_cost_no_accuracy(method):
    """A thousand intervals: starting anew in each made 1e-5 of the run and its gradients."""
    model, responses = pendulum(), [da.final("bar.angle"), da.integral("pin.force_norm")]
    fine = da.solve_dynamics(model, 1.0, integrator=da.DormandPrince853(1e-12, 1e-12))
    true = da.sensitivity(fine, responses).values
    motion = da.solve_dynamics(model, 1.0, integrator=method(1e-8, 1e-10))
    assert motion.statistics["steps"] == 1000
    np.testing.assert_allclose(motion.trajectory.y[:, -1], fine.trajectory.y[:, -1], atol=5e-7)
    direct, adjoint = (
        da.sensitivity(motion, responses, method=way).values for way in ("direct", "adjoint")
    )
    size = np.abs(true).max(axis=1, keepdims=True)
    np.testing.assert_allclose(direct / size, true / size, rtol=0, atol=1e-6)
    np.testing.assert_allclose(adjoint / size, direct / size, rtol=0, atol=2e-7)


@pytest.mark.parametrize("method", [da.CVODES, da.IDA])
def test_too_many_steps_are_told_as_that(method):
    """A force that shakes 160,000 times within one interval: no singular position is blamed."""
    system = da.System("shaken")
    body = system.add(planar.Bar("body", mass=1.0, length=1.0, angle=0.3))
    system.add(planar.Revolute("pin", system.ground.center, body.start))
    system.add(planar.Torque("shaker", body, 1e3 * da.sin(1e5 * da.t)))
    motion = da.solve_dynamics(system.build(), 10.0, step=10.0, integrator=method(1e-8, 1e-10))
    assert motion.status.outcome is da.Outcome.DIVERGED
    assert "max_num_steps" in motion.status.message and "Radau" in motion.status.message
    assert "singular" not in motion.status.message


@pytest.mark.parametrize("method", [da.CVODES, da.IDA])
@pytest.mark.parametrize("options", [{"rtol": 0.0}, {"atol": -1.0}])
def test_wrong_tolerances_are_refused(method, options):
    with pytest.raises(da.UnsupportedError, match="positive"):
        method(**options)


@pytest.mark.few(1)
@pytest.mark.parametrize("coordinates", [da.AbsoluteCoordinates(), da.JointCoordinates()], ids=repr)
def test_ida_starts_anew_in_short_intervals(coordinates):
    """Turning four-bar, 160 intervals: right start values are no failure."""
    model, end = four_bar(), 0.8
    exact_motion = da.solve_dynamics(model, end, outputs=[end], integrator=da.Radau(1e-10, 1e-10))
    motion = da.solve_dynamics(
        model, end, step=0.005, outputs=[end], integrator=da.IDA(), coordinates=coordinates
    )
    assert motion.status.success
    np.testing.assert_allclose(motion.trajectory.y, exact_motion.trajectory.y, atol=1e-5)


def four_bar():
    """Fast crank, coupler on a spring with damping."""
    system = da.System("four bar", gravity=(0.0, -9.81))
    corners = np.array([(0.0, 0.0), (0.3, 0.4), (1.3, 0.9), (1.2, 0.0)])
    end = system.ground.center
    for k, (start, stop) in enumerate(pairwise(corners)):
        way = stop - start
        link = planar.Bar(
            f"link{k}",
            length=float(np.hypot(*way)),
            mass=1.0,
            angle=float(np.arctan2(way[1], way[0])),
            position=tuple((start + stop) / 2),
            angular_velocity=9.0 if k == 0 else 0.0,
        )
        system.add(link)
        system.add(planar.Revolute(f"pin{k}", end, link.start))
        end = link.end
        if k == 1:
            tip, held = system.ground.point(0.5, 1.6), link.point(0.1, 0.2)
            spring = planar.Spring("s", tip, held, stiffness=20.0, free_length=0.4, damping=0.5)
            system.add(spring)
    system.add(planar.Revolute("pin3", end, system.ground.point(*corners[-1])))
    return system.build()
