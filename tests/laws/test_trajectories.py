"""Laws of trajectory optimisation: what a plan says is what a run does; bad questions are told."""

from __future__ import annotations

import math

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.errors import AnalysisError, UnsupportedError


def pendulum(moving: str = "torque") -> da.Model:
    system = da.System("pendulum", gravity=(0.0, -9.81))
    torque = system.parameter("torque", 0.0, "N m", bounds=(-30.0, 30.0))
    length = system.parameter("length", 1.0, "m", bounds=(0.5, 2.0))
    bar = system.add(planar.Bar("bar", length=length, mass=1.0, angle=-math.pi / 2))
    system.add(planar.Revolute("pivot", system.ground.point(0, 0), bar.start))
    system.add(planar.Torque("motor", bar, {"torque": torque, "length": 2 * length}[moving]))
    return system.build()


UP = {"bar.angle": math.pi / 2, "bar.angular_velocity": 0.0}
FEW = da.DirectCollocation(intervals=16)


@pytest.fixture(scope="module")
def swing() -> da.TrajectoryResult:
    return da.optimize_trajectory(
        pendulum(),
        da.integral("torque**2"),
        ["torque"],
        1.5,
        end=UP,
        subject_to=[da.Limit(da.maximum("bar.angular_velocity"), upper=4.0)],
        method=FEW,
    )


def test_the_plan_is_a_motion(swing):
    """Objective, limits and controls are those of the motion that is run forward."""
    assert swing.success and swing.deviation < 1e-2
    cost = da.evaluate(swing.motion, da.integral("torque**2"))
    assert cost == pytest.approx(swing.fun, rel=1e-4)
    assert swing.motion["bar.angular_velocity"].max() < 4.01
    control = swing.control("torque")
    np.testing.assert_allclose(swing.motion["torque"], control(swing.motion.time), atol=1e-12)
    np.testing.assert_allclose(swing.planned.values("torque"), control.values[::2], atol=1e-12)
    between = swing.planned.at(control.times)
    near = swing.motion.at(control.times)
    np.testing.assert_allclose(between["bar.angle"], near["bar.angle"], atol=1e-2)
    assert "defect" in repr(swing) and swing.plot("bar.angle") is not None


def test_the_reaction_is_that_of_the_run(swing):
    """Multipliers of the plan are forces of the joint."""
    run = swing.motion.at(swing.planned.time)
    np.testing.assert_allclose(
        swing.planned.values("pivot.force.y"), run.values("pivot.force.y"), atol=0.2
    )


def test_a_run_under_controls_has_gradients(swing):
    """It begins where the model does, so its parameters may change."""
    exact, quotient = (
        da.sensitivity(swing.motion, da.final("bar.angle"), method=method).sel(parameter="length")
        for method in ("adjoint", "finite-difference")
    )
    assert exact.item() == pytest.approx(quotient.item(), rel=1e-4)


def test_a_cycle():
    """A pendulum that turns for ever ends as it began; without friction that needs no torque."""
    best = da.optimize_trajectory(
        pendulum(),
        da.integral("torque**2"),
        ["torque"],
        (0.2, 2.0),
        begin={"bar.angle": 0.0, "bar.angular_velocity": (6.0, 20.0)},
        end={"bar.angle": 2 * math.pi},
        cyclic=["bar.angular_velocity"],
        method=FEW,
    )
    assert best.success and best.fun < 1e-6


def test_invalid_tasks_are_refused():
    model, goal = pendulum(), da.integral("torque**2")
    with pytest.raises(AnalysisError, match="unknown parameter 'torqe'"):
        da.optimize_trajectory(model, goal, ["torqe"], 1.0)
    with pytest.raises(UnsupportedError, match="'length' would change"):
        da.optimize_trajectory(model, goal, ["length"], 1.0)
    with pytest.raises(AnalysisError, match="duration"):
        da.optimize_trajectory(model, goal, ["torque"], (1.0, math.inf))
    with pytest.raises(UnsupportedError, match="minimum"):
        da.optimize_trajectory(model, da.minimum("torque"), ["torque"], 1.0)
    with pytest.raises(AnalysisError, match="guess"):
        da.optimize_trajectory(model, goal, ["torque"], 1.0, guess="somehow")
    with pytest.raises(AnalysisError, match="give a list of names"):
        da.optimize_trajectory(model, goal, "torque", 1.0)
    with pytest.raises(AnalysisError, match="accuracy is 'fine'"):
        da.optimize_trajectory(model, goal, ["torque"], 1.0, accuracy="fine")
    for side in ("begin", "end"):
        wrong = {"is above": (3, 1), "give a number": math.nan, "with None": "far"}
        for words, value in wrong.items():
            with pytest.raises(AnalysisError, match=words):
                da.optimize_trajectory(model, goal, ["torque"], 1.0, **{side: {"bar.angle": value}})
        with pytest.raises(AnalysisError, match="give a dict"):
            da.optimize_trajectory(model, goal, ["torque"], 1.0, **{side: [1.0]})


def test_a_goal_out_of_reach_is_no_success():
    """30 N m do not lift a bar in a twentieth of a second, and it says what is left open."""
    best = da.optimize_trajectory(
        pendulum(), da.integral("torque**2"), ["torque"], 0.05, end=UP, method=FEW
    )
    assert not best.success and best.motion is None
    assert "left open" in best.status.message


@pytest.mark.thorough
@pytest.mark.parametrize("integrator", [da.RK4(), da.Radau(fixed=True), da.Trapezoidal()])
def test_shooting_plans_the_run_itself(integrator):
    """The plan is made of the steps that the run takes, implicit ones too."""
    method = da.MultipleShooting(intervals=8, steps=4, integrator=integrator)
    torque = da.integral("torque**2")
    best = da.optimize_trajectory(pendulum(), torque, ["torque"], 1.5, end=UP, method=method)
    assert best.success and best.deviation < 1e-6
    assert type(best.motion.analysis.integrator) is type(integrator)


def test_shooting_refuses_steps_that_it_cannot_take():
    torque = da.integral("torque**2")
    for integrator, words in ((da.DormandPrince(), "chooses its steps"), (da.HHT(), "remembers")):
        method = da.MultipleShooting(integrator=integrator)
        with pytest.raises(UnsupportedError, match=words):
            da.optimize_trajectory(pendulum(), torque, ["torque"], 1.0, end=UP, method=method)
    with pytest.raises(AnalysisError, match="even"):
        da.MultipleShooting(steps=3)
