"""Implicit steps in which Newton's method fails are halved, and all that follows counts them."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.integrators.marching.steps import HALVINGS
from dalembert.structures import Frame, Material, rectangle

END, STEP = 0.1, 2e-3
TIP = [da.final("strip.end.y"), da.mean("strip.end.x")]


def leaf_spring() -> da.System:
    """A force pushes it all of a sudden to more than half its length."""
    steel, section = Material(206e9, 0.3, 7850.0), rectangle(0.02, 0.001)
    system = da.System("strip", gravity=(0, 0))
    force, length = system.parameter("F", 4.0, "N"), system.parameter("L", 0.5, "m")
    options = {"length": length, "elements": 4, **section.planar_beam(steel)}
    beam = system.add(planar.Beam("strip", system.ground.center, **options))
    system.add(planar.Force("push", beam.end.center, (0, -force)))
    return system


@pytest.fixture(scope="module")
def strip() -> da.Model:
    return leaf_spring().build()


def pushed(model: da.Model, **options) -> da.Motion:
    return da.solve_dynamics(model, END, integrator=da.HHT(), **options)


@pytest.fixture(scope="module")
def halved(strip) -> da.Motion:
    return pushed(strip, step=STEP)


def test_long_steps_are_halved(halved):
    assert halved.status.success
    steps = halved.record.steps
    assert steps.rejected > 0
    assert steps.count == round(END / STEP) + steps.rejected
    np.testing.assert_allclose(steps.t[1:], steps.t[:-1] + steps.h[:-1], atol=1e-15)
    assert steps.h.min() >= STEP / 2**HALVINGS
    assert any("halves" in text for text in halved.warnings)


def test_outputs_are_those_of_the_grid(halved):
    np.testing.assert_allclose(halved.time, np.arange(51) * STEP, atol=1e-15)


def test_the_motion_is_that_of_short_steps(strip, halved):
    exact = pushed(strip, step=1e-4)
    assert exact.record.steps.rejected == 0
    assert not any("halves" in text for text in exact.warnings)
    for name in ("strip.end.x", "strip.end.y"):
        computed = float(halved[name].values[-1])
        assert computed == pytest.approx(float(exact[name].values[-1]), abs=2e-3)


def test_gradients_are_those_of_the_steps_taken(halved):
    direct = da.sensitivity(halved, TIP, method="direct").values
    adjoint = da.sensitivity(halved, TIP, method="adjoint").values
    differences = da.sensitivity(halved, TIP, method="finite-difference").values
    np.testing.assert_allclose(adjoint, direct, rtol=1e-8)
    np.testing.assert_allclose(direct, differences, rtol=1e-5)


def test_few_states_are_kept(strip, halved):
    """Those between are repeated with the steps that were taken."""
    few = pushed(strip, step=STEP, outputs=[0.02, END], memory=1.0)
    assert few.record.steps.rejected == halved.record.steps.rejected
    assert float(few["strip.end.y"][-1]) == float(halved["strip.end.y"][-1])


def test_designs_of_a_batch_are_halved_too(strip):
    forces = [0.1, 4.0]
    batch = pushed(strip, step=STEP, parameters={"F": forces})
    for k, force in enumerate(forces):
        single = pushed(strip, step=STEP, parameters={"F": force})
        assert float(batch["strip.end.y"].values[k, -1]) == pytest.approx(
            float(single["strip.end.y"].values[-1]), rel=1e-9
        )


@pytest.mark.thorough
def test_steps_between_located_impacts_are_halved_too(halved):
    """A ball falls on a floor beside the leaf spring: the motion of neither is changed."""
    system = leaf_spring()
    height = system.parameter("height", 0.02, "m")
    ball = system.add(planar.Particle("ball", mass=1.0, position=(2.0, height)))
    system.add(planar.Force("weight", ball.center, (0.0, -9.81)))
    system.add(planar.UnilateralConstraint("floor", ball.y, restitution=0.5))
    motion = pushed(system.build(), step=STEP)
    assert motion.status.success
    assert motion.record.steps.rejected == halved.record.steps.rejected
    assert motion.impacts[0].time == pytest.approx(np.sqrt(0.04 / 9.81), abs=1e-12)
    assert float(motion["strip.end.y"][-1]) == pytest.approx(
        float(halved["strip.end.y"][-1]), abs=1e-3
    )
    ends = [*TIP, da.final("ball.y")]
    direct, adjoint = (
        da.sensitivity(motion, ends, method=method).values for method in ("direct", "adjoint")
    )
    np.testing.assert_allclose(adjoint, direct, rtol=1e-8, atol=1e-9)
    fall, after = np.sqrt(0.04 / 9.81), 0.1 - np.sqrt(0.04 / 9.81)
    assert direct[2, 2] == pytest.approx(0.5 * (after - fall) / fall + after / fall, rel=1e-9)


def test_what_no_step_solves_ends_the_run():
    """A spring with a pole at 0.1 s in its law: no step goes across."""
    system = da.System("pole", gravity=(0, 0))
    body = system.add(planar.Particle("body", mass=1.0, position=(1.0, 0.0)))
    system.add(planar.Force("pull", body.center, (-100 / body.x**3, 0.0)))
    motion = da.solve_dynamics(system.build(), 0.2, step=1e-2, integrator=da.HHT())
    assert not motion.status.success
    assert motion.record.steps.rejected >= HALVINGS


def test_steps_of_structures_are_halved_too():
    """A cantilever of short frames that a force pushes hard, and few iterations allowed."""
    structure = da.Structure("cantilever")
    modulus = structure.parameter("E", 206e9, "Pa")
    nodes = [structure.node(f"n{k}", k / 20, 0.0) for k in range(21)]
    section = {"area": 2e-4, "second_moment": 1.7e-9, "modulus": modulus, "density": 7850.0}
    for k in range(20):
        structure.add(Frame(f"e{k}", nodes[k], nodes[k + 1], **section))
    structure.support(nodes[0])
    structure.load(nodes[-1], fy=-1e4)
    few = da.HHT(max_iterations=4)
    motion = da.solve_transient(structure.build(), 3e-3, step=1e-3, nonlinear=True, integrator=few)
    assert motion.status.success
    assert motion.statistics["rejected steps"] > 0
    assert any("halves" in text for text in motion.warnings)
    np.testing.assert_allclose(motion.time, [0.0, 1e-3, 2e-3, 3e-3], atol=1e-15)
    tip = [da.final("n20.uy")]
    direct = da.sensitivity(motion, tip, method="direct").values
    adjoint = da.sensitivity(motion, tip, method="adjoint").values
    np.testing.assert_allclose(adjoint, direct, rtol=1e-8)
