"""Rigid contacts: same motion by every choice, exact gradients, energy, and what is refused."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from rigid_contacts import PARAMETERS, ball, spun, thrown

import dalembert as da
from dalembert import planar
from dalembert.errors import AnalysisError, ExpressionError, ModelError, UnsupportedError
from dalembert.integrators.marching.checkpoints import Checkpoints
from dalembert.sensitivity.checks.certificate import certify

CHOICES = {
    "Dormand-Prince": {"integrator": da.DormandPrince(rtol=1e-9)},
    "Dormand-Prince 853": {"integrator": da.DormandPrince853(rtol=1e-10)},
    "RK4": {"step": 0.002},
    "Heun": {"step": 5e-5, "integrator": da.Heun()},
    "KKT": {"integrator": da.DormandPrince(rtol=1e-9), "formulation": da.KKT()},
    "NullSpace": {"integrator": da.DormandPrince(rtol=1e-9), "formulation": da.NullSpace()},
    "partition": {
        "integrator": da.DormandPrince(rtol=1e-9),
        "formulation": da.VelocityPartitioning(),
    },
    "joints": {
        "integrator": da.DormandPrince(rtol=1e-9),
        "coordinates": da.JointCoordinates(),
    },
    "Baumgarte": {
        "integrator": da.DormandPrince(rtol=1e-9),
        "stabilization": da.Baumgarte(alpha=50.0),
    },
    "Radau": {"integrator": da.Radau(rtol=1e-8, atol=1e-10)},
    "BDF": {"integrator": da.BDF(rtol=1e-9, atol=1e-11)},
    "CVODES": {"integrator": da.CVODES(rtol=1e-10), "step": 0.02},
    "descriptor form": {"integrator": da.Radau(rtol=1e-8), "formulation": da.DAE(index=3)},
    "alpha": {"integrator": da.GeneralizedAlpha(), "step": 5e-5},
}


@functools.cache
def reference():
    return da.solve_dynamics(thrown(), 0.7, integrator=da.DormandPrince853(rtol=1e-12))


@pytest.mark.few(2)
@pytest.mark.parametrize("choice", CHOICES)
def test_every_choice_gives_the_same_impacts(choice):
    motion = da.solve_dynamics(thrown(), 0.7, **CHOICES[choice])
    assert motion.status.success and not motion.warnings
    expected = reference()
    assert [i.name for i in motion.impacts] == [i.name for i in expected.impacts]
    computed, wanted = (
        [[i.time, i.normal, *i.tangential] for i in m.impacts] for m in (motion, expected)
    )
    np.testing.assert_allclose(computed, wanted, rtol=2e-6)
    assert np.abs(motion.data["balance_error"]).max() < 2e-6 * motion.values("kinetic_energy").max()


def test_an_impact_keeps_the_law_and_the_impulses_balance():
    """``M (v⁺ − v⁻)`` is what the floor and the hinge give; restitution; friction at its limit."""
    motion = reference()
    for impact in motion.impacts:
        before, after = (motion.at(np.array([impact.time + s * 1e-10])) for s in (-1, 1))
        tip = {"A": "a.start", "B": "a.end", "C": "b.end"}[impact.name]
        speeds = [m.values(f"{tip}.velocity")[0] for m in (before, after)]
        assert speeds[1][1] == pytest.approx(-0.6 * speeds[0][1], rel=1e-6)
        momentum = [
            sum(mass * m.values(f"{bar}.velocity")[0] for bar, mass in (("a", 2.0), ("b", 1.0)))
            for m in (before, after)
        ]
        impulse = np.array([impact.tangential[0], impact.normal])
        np.testing.assert_allclose(momentum[1] - momentum[0], impulse, atol=1e-7)
        assert abs(impact.tangential[0]) <= 0.1 * impact.normal * (1 + 1e-12)


@pytest.mark.few(1)
@pytest.mark.parametrize("duration", [0.7, 1.0])
@pytest.mark.parametrize(
    "choice", ["Dormand-Prince", "RK4", "joints", "Radau", "BDF", "descriptor form"]
)
def test_direct_and_adjoint_gradients_agree(choice, duration):
    motion = da.solve_dynamics(thrown(), duration, **CHOICES[choice])
    tip = [da.final(thrown()[f"b.end.{axis}"]) for axis in "xy"]
    direct, adjoint = (da.sensitivity(motion, tip, method=m).values for m in ("direct", "adjoint"))
    np.testing.assert_allclose(direct, adjoint, rtol=1e-9, atol=1e-11)


@pytest.mark.thorough
def test_gradients_are_certified_by_differences():
    motion = da.solve_dynamics(thrown(), 0.7, integrator=da.DormandPrince())
    responses = [da.final(thrown()["b.end.x"]), da.at(0.5, thrown()["C.gap"])]
    assert certify(motion, responses, list(range(len(PARAMETERS)))).passed


@pytest.mark.thorough
def test_switches_of_forces_and_contacts_go_together():
    """Drag by the square of speeds that jump, a stop beside the floor, friction on it."""
    system = da.System("both", gravity=(0, -9.81))
    e, k, limit = (
        system.parameter(name, value)
        for name, value in (("restitution", 0.7), ("k", 300.0), ("limit", 0.25))
    )
    b = system.add(planar.Particle("b", mass=1.0, position=(0, 1.0), velocity=(1.0, 0)))
    system.add(planar.UnilateralConstraint("floor", b.y, b.vx, restitution=e, friction=0.05))
    system.add(planar.Stop("stop", b.x, upper=limit, stiffness=k, damping=0.1))
    drag = [-0.3 * abs(v) * v for v in (b.vx, b.vy)]
    system.add(planar.Force("drag", b.center, drag))
    model = system.build()
    motion = da.solve_dynamics(model, 1.6, integrator=da.DormandPrince())
    assert motion.status.success and len(motion.impacts) == 4
    assert certify(motion, [da.final(model[f"b.{s}"]) for s in "xy"], [0, 1, 2]).passed


@pytest.mark.few(1)
@pytest.mark.parametrize("options", [{"step": 0.01}, {"integrator": da.DormandPrince()}])
def test_integrals_and_their_gradients_go_through_all_bounces(options):
    """Areas of parabolas: ``∫ y dt = 2/3 h t_f + 4/3 h t_f e³/(1 − e³)`` until it rests."""
    model = ball(restitution=None).build()
    motion = da.solve_dynamics(model, 1.6, **options)
    fall, e = np.sqrt(2 / 9.81), 0.5
    area = da.integral(model["ball.y"])
    exact = fall * (2 / 3 + 4 / 3 * e**3 / (1 - e**3))
    assert da.evaluate(motion, area) == pytest.approx(exact, rel=1e-9)
    for method in ("direct", "adjoint"):
        derivative = da.sensitivity(motion, area, method=method).item()
        assert derivative == pytest.approx(4 * fall * e**2 / (1 - e**3) ** 2, rel=1e-9)


def test_both_sides_of_an_impact_are_outputs():
    motion = da.solve_dynamics(ball().build(), 0.6, integrator=da.DormandPrince())
    before, after = motion.impacts[0].time + np.array([-1e-15, 1e-15])
    inside = (motion.time > before) & (motion.time < after)
    assert np.all(np.diff(motion.time) > 0) and inside.sum() == 2
    speeds = motion.values("ball.vy")[inside]
    np.testing.assert_allclose(speeds, np.sqrt(2 * 9.81) * np.array([-1, 0.5]), rtol=1e-12)
    assert da.evaluate(motion, da.minimum("ball.vy")) == pytest.approx(speeds[0], rel=1e-12)
    again = motion.at(motion.time)
    np.testing.assert_array_equal(again.values("ball.vy"), motion.values("ball.vy"))


def test_plots_break_at_impacts():
    motion = da.solve_dynamics(ball().build(), 0.6, step=0.01, outputs=7)
    (line,) = motion.plot("ball.vy").lines
    time, speed = line.get_data()
    k = int(np.flatnonzero(np.isnan(speed))[0])
    impact = np.sqrt(2 * 9.81)
    np.testing.assert_allclose(time[k - 1 : k + 2], np.sqrt(2 / 9.81), rtol=1e-8)
    np.testing.assert_allclose(speed[[k - 1, k + 1]], [-impact, impact / 2], rtol=1e-8)


@pytest.mark.thorough
def test_few_states_are_kept_of_long_runs():
    options = {"step": 0.0005, "outputs": 20, "memory": 1e4}
    motion = da.solve_dynamics(thrown(), 0.7, **options)
    assert isinstance(motion.record.steps.x, Checkpoints)
    whole = da.solve_dynamics(thrown(), 0.7, step=0.0005)
    response = da.final(thrown()["b.end.x"])
    computed = [da.sensitivity(m, response, method="adjoint").values for m in (motion, whole)]
    np.testing.assert_allclose(*computed, rtol=1e-12)


def test_second_derivatives_are_refused():
    motion = da.solve_dynamics(ball(restitution=None).build(), 1.0, step=0.01)
    with pytest.raises(UnsupportedError, match="second derivatives through impacts"):
        da.hessian_product(motion, da.final(motion.model["ball.y"]), [1.0])


def test_in_space():
    model = spun()
    motion = da.solve_dynamics(model, 0.6, integrator=da.DormandPrince())
    assert motion.status.success and len(motion.impacts) >= 2
    assert min(motion.values(f"c{k}.gap").min() for k in range(8)) > -1e-12
    assert np.abs(motion.data["balance_error"]).max() < 1e-6
    computed = [
        da.sensitivity(motion, da.final(model["box.position.z"]), method=m).values
        for m in ("direct", "adjoint")
    ]
    np.testing.assert_allclose(*computed, rtol=1e-10)


@pytest.mark.parametrize("above", [1e-9, 1e-2])
def test_grazing_is_told(above):
    """A ball that flies up, and would just a little higher than the roof."""
    system = da.System("graze", gravity=(0, -9.81))
    v = system.parameter("v", np.sqrt(2 * 9.81))
    particle = system.add(planar.Particle("ball", mass=1.0, position=(0, 0), velocity=(0, v)))
    system.add(planar.UnilateralConstraint("roof", 1.0 - above - particle.y, restitution=0.5))
    model = system.build()
    motion = da.solve_dynamics(model, 0.6, step=0.01)
    assert len(motion.impacts) == 1
    assert motion.impacts[0].time == pytest.approx(
        np.sqrt(2 / 9.81) - np.sqrt(2 * above / 9.81), abs=1e-10
    )
    notes = da.sensitivity(motion, da.final(model["ball.y"])).attrs["notes"]
    assert any("roof is only grazed" in note for note in notes) == (above < 1e-6)


def test_order_that_is_not_decided_is_told():
    system = da.System("two", gravity=(0, -9.81))
    h = system.parameter("h", 0.5)
    bar = system.add(planar.Bar("bar", length=1.0, mass=1.0, position=(-0.5, h)))
    for name, tip in (("left", bar.start), ("right", bar.end)):
        system.add(planar.UnilateralConstraint(name, tip.y, restitution=0.5))
    model = system.build()
    motion = da.solve_dynamics(model, 0.5, step=0.01)
    assert len(motion.impacts) == 2
    assert "left and right at t = " in motion.statistics["simultaneous impacts"]
    notes = da.sensitivity(motion, da.final(model["bar.end.y"])).attrs["notes"]
    assert any("left, right close at one time" in note for note in notes)


def test_a_surface_that_moves_by_itself_gives_energy():
    """A plate that oscillates throws a ball; what it gives is in the balance."""
    system = ball(lambda b: b.y + 0.1 - 0.1 * da.cos(7 * da.t), restitution=0.8)
    motion = da.solve_dynamics(system.build(), 3.0, integrator=da.DormandPrince())
    assert motion.status.success and len(motion.impacts) > 3
    assert np.abs(motion.data["balance_error"]).max() < 1e-7
    assert motion.data["input_energy"][-1] != 0


REFUSED = {
    "inside": (lambda: ball(height=-0.1), {}, AnalysisError, "gap is -0.1 m at the start"),
    "restitution": (lambda: ball(restitution=1.2), {}, ModelError, "restitution is above 1"),
    "friction": (lambda: ball(friction=-0.1), {}, ModelError, "floor.friction: is -0.1"),
    "speed": (lambda: ball(lambda b: b.y + b.vy), {}, ExpressionError, "floor: depends on"),
    "bent": (lambda: ball(slip=lambda b: b.vx**2), {}, ModelError, "linear"),
    "every equation": (
        ball,
        {"formulation": da.AugmentedLagrangian()},
        UnsupportedError,
        "does not hold the rigid contact floor",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_invalid_impacts_are_refused(name):
    make, options, error, text = REFUSED[name]
    with pytest.raises(error, match=text):
        da.solve_dynamics(make().build(), 1.0, **options)
