"""Long steps end with a short correction where it arrives, and with the whole one elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.symbolic.evaluation.lanes import LaneColumns

STEP = 1e-3


def ladder(count: int) -> da.Model:
    """Four-bars in a row, driven by gravity."""
    system = da.System("ladder", gravity=(0.0, -9.81))
    length, last = system.parameter("l", 1.0), None
    for k in range(count + 1):
        crank = system.add(planar.Bar(f"crank{k}", length=length, mass=1.0, angle=1.2))
        system.add(planar.Revolute(f"O{k}", system.ground.point(k, 0), crank.start))
        if last is not None:
            coupler = system.add(planar.Bar(f"coupler{k}", length=1.0, mass=2.0))
            system.add(planar.Revolute(f"A{k}", last.end, coupler.start))
            system.add(planar.Revolute(f"B{k}", coupler.end, crank.end))
        last = crank
    return system.build()


@pytest.fixture(scope="module")
def marched():
    """The kernel of a long step, its mode and the state of the start."""
    model = ladder(4)
    kernel = da.Dynamics(1.0, step=STEP, backend="vm").kernel(model)
    x, mode = kernel.initial(model.start, 0.0, model.nominal)
    return kernel, mode, x, model.nominal


def test_both_ways_meet(marched):
    """From states on the manifold, and from some that are off it, by so little and so much."""
    kernel, mode, x, p = marched
    step = kernel.fixed.step_of(mode)
    q = step.prepared.forms.values(p)
    assert step.prepared.forms.lanes is not None
    for away, arrives in ((0.0, True), (1e-6, True), (1e-2, False)):
        moved = x.copy()
        moved[: kernel.equations.coordinate_count] += away * np.cos(np.arange(1, 1 + 27))
        whole = step.function(0.0, STEP, moved, p).full().ravel()
        mostly = step.prepared.forms.function(0.0, STEP, moved, q).full().ravel()
        short = step.prepared.forms.lanes(0.0, STEP, moved, q).full().ravel()
        np.testing.assert_allclose(mostly, whole, rtol=1e-12, atol=1e-12)
        assert np.isfinite(short).all() == arrives
        if arrives:
            np.testing.assert_allclose(short, mostly, rtol=0, atol=0)
        else:
            np.testing.assert_allclose(mostly, whole, rtol=0, atol=0)


@pytest.mark.thorough
def test_lanes_that_do_not_arrive_are_run_alone():
    """Steps so coarse that two iterations leave violations: the batch is that of single runs."""
    model, lengths = ladder(4), np.array([0.9, 1.0, 1.1])
    how = {"step": 0.25, "outputs": [2.0]}
    batch = da.solve_dynamics(model, 2.0, parameters={"l": lengths}, backend="jit", **how)
    for k, length in enumerate(lengths):
        alone = da.solve_dynamics(model, 2.0, parameters={"l": length}, backend="vm", **how)
        assert float(alone["crank0.angle"][-1]) == pytest.approx(
            float(batch["crank0.angle"][k, -1]), abs=1e-9
        )
    assert batch.statistics["designs run on their own"] > 0


def test_a_long_step_has_lanes(marched):
    kernel, mode, *_ = marched
    assert LaneColumns(kernel.fixed.marched(mode).forms.side_by_side, True, (4,)).side_by_side
