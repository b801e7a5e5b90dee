"""Gradients through marches that keep few of their states equal those through all of them."""

import tracemalloc

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.integrators.marching.checkpoints import EVERY, Checkpoints

RESPONSES = [
    da.final("rocker.angle"),
    da.at(0.37, "crank.angular_velocity"),
    da.mean("A.force_norm"),
]


@pytest.fixture(scope="module")
def model():
    system = da.System("four-bar", gravity=(0.0, -9.81))
    l1 = system.parameter("l1", 0.3)
    m2 = system.parameter("m2", 5.0)
    turning = system.parameter("turning", 1.0)
    crank = system.add(
        planar.Bar("crank", length=l1, mass=1.5, angle=1.5708, angular_velocity=turning)
    )
    coupler = system.add(planar.Bar("coupler", length=1.0, mass=m2))
    rocker = system.add(planar.Bar("rocker", length=0.6, mass=3.0, angle=1.0))
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    return system.build()


def agree(few, all_, tolerance):
    return np.abs(few - all_).max() <= tolerance * np.abs(all_).max()


@pytest.mark.thorough
@pytest.mark.parametrize("method", ["adjoint", "direct"])
def test_few_states_give_the_same_gradient(model, method):
    options = {"step": 1 / 20_000, "outputs": 11}
    whole = da.solve_dynamics(model, 1.0, **options)
    few = da.solve_dynamics(model, 1.0, memory=1e4, **options)
    assert isinstance(few.record.steps.x, Checkpoints)
    assert few.record.steps.x.number.size <= 20_000 / EVERY + 1 + 2 * 11
    expected = da.sensitivity(whole, RESPONSES, method=method).values
    assert agree(da.sensitivity(few, RESPONSES, method=method).values, expected, 1e-12)


@pytest.mark.few(1)
@pytest.mark.parametrize(
    "options",
    [
        {"step": 1 / 3000, "stabilization": da.Projection(every=7)},
        {"step": 1 / 3000, "formulation": da.VelocityPartitioning()},
        {"step": 1 / 1500, "integrator": da.GeneralizedAlpha(rho_inf=0.9)},
        {"integrator": da.DormandPrince(rtol=1e-13, atol=1e-13)},
    ],
    ids=["every seventh", "partitioning", "generalized alpha", "adaptive"],
)
def test_whatever_the_steps(model, options):
    whole = da.solve_dynamics(model, 1.0, outputs=3, **options)
    few = da.solve_dynamics(model, 1.0, outputs=3, memory=0.0, **options)
    checkpoints, steps = few.record.steps.x, few.record.steps
    assert steps.count > EVERY and checkpoints.number.size < steps.count / 50
    assert np.allclose(np.asarray(checkpoints), whole.record.steps.x, rtol=1e-10, atol=1e-12)
    expected = da.sensitivity(whole, RESPONSES, method="adjoint").values
    assert agree(da.sensitivity(few, RESPONSES, method="adjoint").values, expected, 1e-9)


def test_fixed_steps_are_repeated_to_the_last_bit(model):
    whole, few = (
        da.solve_dynamics(model, 0.2, step=1e-4, outputs=[0.2], memory=m) for m in (1e9, 0.0)
    )
    assert np.array_equal(np.asarray(few.record.steps.x), whole.record.steps.x)


def test_replays_of_a_run_with_few_states_keep_few(model):
    few = da.solve_dynamics(model, 0.2, step=1e-4, outputs=5, memory=0.0)
    again = few.analysis.replay(few, few.parameters)
    assert np.array_equal(again.record.steps.x.stored[:, -1], few.record.steps.x.stored[:, -1])
    assert again.record.steps.x.number.size <= few.record.steps.x.number.size + 10
    assert np.array_equal(again.trajectory.y, few.trajectory.y)


def test_events_are_found_among_states_that_were_not_kept(model):
    event = da.Event("crank.angle - 1.7", terminal=True)
    whole, few = (
        da.solve_dynamics(
            model, 1.0, step=1e-4, outputs=[0.05, 1.0], memory=m, events={"there": event}
        )
        for m in (1e9, 0.0)
    )
    assert few.events and few.events[0].time == whole.events[0].time
    assert np.array_equal(few.trajectory.y, whole.trajectory.y)


@pytest.mark.few(1)
@pytest.mark.parametrize(("memory", "each"), [(2.0**27, 1.4), (1e4, 0.5)], ids=["all", "few"])
def test_memory_of_a_long_run(model, memory, each):
    """States are kept once, and nothing else as large is made of them on the way."""
    steps = 20_000
    options = {"step": 1 / steps, "outputs": 11, "memory": memory, "backend": "vm"}
    da.solve_dynamics(model, 1.0, **options)
    tracemalloc.start()
    motion = da.solve_dynamics(model, 1.0, **options)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    states = 8 * motion.record.steps.x.shape[0] * steps
    assert peak < each * states + 2e6
