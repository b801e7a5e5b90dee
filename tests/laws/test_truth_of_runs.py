"""What a run leaves is held against the model's own equations and its energy before it counts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.analysis.dynamics.residual_check import EnergyBalance
from dalembert.analysis.model_residuals import ModelResiduals
from dalembert.formulations.base import Level
from dalembert.results.status import Outcome


def swinging(stiffness: float = 0.0) -> da.System:
    system = da.System("swinging", gravity=(0.0, -9.81))
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0, angle=0.3, angular_velocity=1.0))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bar.start))
    wheel = system.add(planar.Body("wheel", mass=1.0, inertia=0.2, angular_velocity=5.0))
    system.add(planar.Revolute("A", bar.end, wheel.center))
    if stiffness:
        peg = system.ground.point(1.5, 0.2)
        system.add(planar.Spring("rod", peg, bar.end, stiffness=stiffness, free_length=0.5))
    return system


@pytest.fixture(scope="module")
def motion():
    return da.solve_dynamics(swinging().build(), 0.5, step=0.01)


# each level ---------------------------------------------------------------------------------


def spoilt(motion, field: str, row: int, by: float) -> ModelResiduals:
    values = getattr(motion.trajectory, field).copy()
    values[row, 30] += by
    trajectory = replace(motion.trajectory, **{field: values})
    return ModelResiduals(motion.model, trajectory, motion.parameters)


def test_a_true_motion_leaves_nothing_open(motion):
    residuals = ModelResiduals(motion.model, motion.trajectory, motion.parameters)
    assert max(residuals.of_level(level).share for level in Level) < 1e-12
    assert residuals.of_motion.share < 1e-12
    trajectory, natural = motion.trajectory, motion.model.scales.energy
    assert EnergyBalance(residuals.energies, trajectory.work, trajectory.t, natural).worst[0] < 1e-6


def test_each_level_notices_its_own_number(motion):
    """Position, speed, acceleration, force: which equation, by how much, and when."""
    residual = spoilt(motion, "y", 0, 0.01).of_level(Level.POSITION)
    assert residual.text == "O[0] is violated by 0.01 m at t = 0.3 s" and residual.share > 5e-3
    residual = spoilt(motion, "v", 1, 0.5).of_level(Level.SPEED)
    assert "[1] is violated by 0.5 m/s at t = 0.3 s" in residual.text and residual.share > 0.01
    residual = spoilt(motion, "a", 3, 2.0).of_level(Level.ACCELERATION)
    assert residual.text == "A[0] is violated by 2 m/s² at t = 0.3 s" and residual.share > 0.01
    residual = spoilt(motion, "multiplier", 3, 4.0).of_motion
    assert residual.share > 0.01 and residual.text.startswith("the equation of motion of bar.")
    residual = spoilt(motion, "a", 5, 2.0).of_motion
    assert residual.text == "the equation of motion of wheel.angle is open by 0.4 N m at t = 0.3 s"


def test_what_is_not_a_number_is_open_without_limit(motion):
    assert spoilt(motion, "a", 2, np.nan).of_level(Level.ACCELERATION).share == np.inf
    assert spoilt(motion, "multiplier", 2, np.nan).of_motion.share == np.inf


# energy -------------------------------------------------------------------------------------


@pytest.mark.parametrize("outputs", [None, [1.0]])
def test_energy_from_nowhere_is_a_status(outputs):
    """Explicit steps beyond the stability of a stiff spring, seen at the end alone, too."""
    model = swinging(1e4).build()
    motion = da.solve_dynamics(model, 1.0, step=5e-4, integrator=da.Euler(), outputs=outputs)
    assert motion.status.outcome is Outcome.UNBALANCED and not motion.status.success
    assert "J appeared by t = " in motion.status.message


def test_a_stop_does_not_throw():
    """A drop from one metre on a stiff floor: no higher than before, or the run says so."""
    system = da.System("drop", gravity=(0.0, -9.81))
    ball = system.add(planar.Particle("ball", mass=1.0, position=(0.0, 1.0)))
    system.add(planar.Stop("floor", ball.y, lower=0.0, stiffness=1e6))
    model = system.build()
    for step in (0.01, 0.005, 0.002, 0.001):
        motion = da.solve_dynamics(model, 2.0, step=step)
        top = motion["ball.y"].values.max()
        assert motion.status.success == (top < 1.3), (step, top, motion.status)


def test_coarse_steps_are_told_and_may_be_refused():
    """What coarse steps of a damped method lose is a warning, or a status if so wished."""
    model = swinging(200.0).build()
    choices = {"step": 0.05, "integrator": da.BackwardEuler()}
    loose = da.solve_dynamics(model, 1.0, balance=1.0, **choices)
    assert loose.status.success and any("J vanished" in text for text in loose.warnings)
    strict = da.solve_dynamics(model, 1.0, balance=0.01, **choices)
    assert strict.status.outcome is Outcome.UNBALANCED
    with pytest.raises(da.AnalysisError, match="balance is 0"):
        da.solve_dynamics(model, 1.0, balance=0.0)


# constraints that nothing holds -----------------------------------------------------------------


def test_drift_is_told_and_beyond_a_tenth_refused():
    model = swinging().build()
    choices = {"integrator": da.Euler(), "stabilization": da.Stabilization(), "balance": 1.0}
    motion = da.solve_dynamics(model, 1.0, step=0.005, **choices)
    assert motion.status.success and any("nothing holds it" in text for text in motion.warnings)
    lost = da.solve_dynamics(model, 3.0, step=0.05, **choices)
    assert lost.status.outcome is Outcome.VIOLATED and "Projection()" in lost.status.message


def test_what_drifts_is_compared_with_what_moves():
    """A stiff stop that nothing touches makes the natural speeds fast, and excuses no drift."""
    shares = []
    for stiffness in (0.0, 1e9):
        system = swinging()
        if stiffness:
            wheel = next(body for body in system.bodies if body.name == "wheel")
            system.add(planar.Stop("far", wheel.y, lower=-9.0, stiffness=stiffness))
        choices = {"integrator": da.Euler(), "stabilization": da.Stabilization(), "balance": 1.0}
        motion = da.solve_dynamics(system.build(), 0.5, step=0.005, **choices)
        residuals = ModelResiduals(motion.model, motion.trajectory, motion.parameters)
        shares.append([residuals.of_level(level, drifts=True).share for level in Level])
    np.testing.assert_allclose(*shares, rtol=1e-9)
    assert min(shares[0][:2]) > 1e-3


# steps too long -----------------------------------------------------------------------------


def rocking(**held) -> da.Model:
    """A pinned bar on a spring or a stop: it swings about its pin with ``k l²/J``."""
    system = da.System("rocking")
    bar = system.add(planar.Bar("bar", length=2.0, mass=3.0, angular_velocity=0.1))
    system.add(planar.Revolute("O", system.ground.point(0, 0), bar.start))
    if "spring" in held:
        peg, stiffness = system.ground.point(2.0, 1.0), held["spring"]
        system.add(planar.Spring("rod", peg, bar.end, stiffness=stiffness, free_length=1.0))
    if "stop" in held:
        system.add(planar.Stop("floor", bar.end.y, lower=-1.0, stiffness=held["stop"]))
    return system.build()


@pytest.mark.parametrize(("name", "held"), [("rod", {"spring": 1e4}), ("floor", {"stop": 1e4})])
def test_the_longest_step_for_a_spring_or_a_stop_is_told(name, held):
    """RK4 is stable up to ``h ω = 2√2``; methods that are always stable get no warning."""
    model, omega = rocking(**held), np.sqrt(1e4 * 2.0**2 / (3.0 * 2.0**2 / 3))
    longest = 2 * np.sqrt(2) / omega
    for share, reported in ((1.02, True), (0.98, False)):
        warnings = da.solve_dynamics(model, 5.0, step=share * longest).warnings
        computed = [text for text in warnings if text.startswith(f"{name} alone oscillates at")]
        assert bool(computed) == reported, warnings
        if computed:
            below = float(computed[0].split("use steps below ")[1].split(" s")[0])
            assert below == pytest.approx(longest, rel=5e-3)
    for integrator in (da.Radau(fixed=True), da.DormandPrince()):
        motion = da.solve_dynamics(model, 0.2, step=2 * longest, integrator=integrator)
        assert not any("swings" in text for text in motion.warnings)
