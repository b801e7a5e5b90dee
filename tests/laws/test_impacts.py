"""Rigid contacts: same motion by every choice, exact gradients, energy, and what is refused."""

from __future__ import annotations

import functools

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.errors import AnalysisError, ExpressionError, ModelError, UnsupportedError
from dalembert.integrators.checkpoints import Checkpoints
from dalembert.results.status import Outcome
from dalembert.sensitivity.checks.certificate import certify

PARAMETERS = {"e": 0.6, "mu": 0.1, "length": 0.5, "spin": 3.0, "height": 0.6, "mass": 2.0}


@functools.cache
def thrown() -> da.Model:
    """Two bars on a hinge that are thrown on a floor."""
    system = da.System("thrown", gravity=(0, -9.81))
    e, mu, length, spin, height, mass = (
        system.parameter(name if name != "e" else "restitution", value)
        for name, value in PARAMETERS.items()
    )
    a = planar.Bar(
        "a",
        length=length,
        mass=mass,
        position=(0, height),
        angle=0.3,
        velocity=(1.0, 0),
        angular_velocity=spin,
    )
    b = planar.Bar("b", length=0.4, mass=1.0, angle=-0.8)
    system.add(a), system.add(b)
    system.add(planar.Revolute("hinge", a.end, b.start))
    for name, tip in (("A", a.start), ("B", a.end), ("C", b.end)):
        system.add(
            planar.UnilateralConstraint(
                name,
                tip.y,
                tip.velocity[0],
                restitution=e,
                friction=mu,
                tangential_restitution=0.1,
            )
        )
    return system.build()


CHOICES = {
    "Dormand-Prince": {"integrator": da.DormandPrince(rtol=1e-9)},
    "Dormand-Prince 853": {"integrator": da.DormandPrince853(rtol=1e-10)},
    "RK4": {"step": 0.002},
    "Heun": {"step": 5e-5, "integrator": da.Heun()},
    "Kkt": {"integrator": da.DormandPrince(rtol=1e-9), "formulation": da.Kkt()},
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
}


@functools.cache
def reference():
    return da.solve_dynamics(thrown(), 0.7, integrator=da.DormandPrince853(rtol=1e-12))


@pytest.mark.parametrize("choice", CHOICES)
def test_every_choice_gives_the_same_impacts(choice):
    motion = da.solve_dynamics(thrown(), 0.7, **CHOICES[choice])
    assert motion.status.success and not motion.warnings
    expected = reference()
    assert [i.name for i in motion.impacts] == [i.name for i in expected.impacts]
    found, wanted = (
        [[i.time, i.normal, *i.tangential] for i in m.impacts] for m in (motion, expected)
    )
    np.testing.assert_allclose(found, wanted, rtol=2e-6)
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
        given = np.array([impact.tangential[0], impact.normal])
        np.testing.assert_allclose(momentum[1] - momentum[0], given, atol=1e-7)
        assert abs(impact.tangential[0]) <= 0.1 * impact.normal * (1 + 1e-12)


@pytest.mark.parametrize("duration", [0.7, 1.0])
@pytest.mark.parametrize("choice", ["Dormand-Prince", "RK4", "joints"])
def test_direct_and_adjoint_gradients_agree(choice, duration):
    motion = da.solve_dynamics(thrown(), duration, **CHOICES[choice])
    tip = [da.final(thrown()[f"b.end.{axis}"]) for axis in "xy"]
    direct, adjoint = (da.sensitivity(motion, tip, method=m).values for m in ("direct", "adjoint"))
    np.testing.assert_allclose(direct, adjoint, rtol=1e-9, atol=1e-11)


def test_gradients_are_certified_by_differences():
    motion = da.solve_dynamics(thrown(), 0.7, integrator=da.DormandPrince())
    responses = [da.final(thrown()["b.end.x"]), da.at(0.5, thrown()["C.gap"])]
    assert certify(motion, responses, list(range(len(PARAMETERS)))).passed


def test_joints_transmit_what_lasting_contacts_give():
    """Reactions found along the tree of joints are those of the equations of all bodies."""
    options = {"parameters": {"restitution": 0.2}, "integrator": da.DormandPrince(rtol=1e-10)}
    absolute, joints = (
        da.solve_dynamics(thrown(), 1.0, outputs=[0.9, 1.0], coordinates=chosen, **options)
        for chosen in (da.AbsoluteCoordinates(), da.JointCoordinates())
    )
    assert joints.status.success and joints.values("A.normal_force")[-1] > 1
    found = [motion.values("hinge.force") for motion in (absolute, joints)]
    np.testing.assert_allclose(*found, atol=1e-5)


def test_contact_is_lasting_when_bounces_have_ended():
    """In the end both bars lie on the floor, which carries their weight."""
    motion = da.solve_dynamics(
        thrown(), 2.0, parameters={"restitution": 0.2}, integrator=da.DormandPrince()
    )
    assert motion.status.success
    gaps = np.array([motion.values(f"{name}.gap") for name in "ABC"])
    forces = np.array([motion.values(f"{name}.normal_force") for name in "ABC"])
    assert gaps.min() > -1e-12 and forces.min() > -1e-9
    assert np.abs(gaps[:, -1]).max() < 1e-12
    assert forces[:, -1].sum() == pytest.approx(3 * 9.81, rel=1e-9)
    assert np.abs(forces * gaps).max() < 1e-10  # either apart or pressing


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
        found = da.sensitivity(motion, area, method=method).item()
        assert found == pytest.approx(4 * fall * e**2 / (1 - e**3) ** 2, rel=1e-9)


def test_both_sides_of_an_impact_are_outputs():
    motion = da.solve_dynamics(ball().build(), 0.6, integrator=da.DormandPrince())
    before, after = motion.impacts[0].time + np.array([-1e-15, 1e-15])
    found = (motion.time > before) & (motion.time < after)
    assert np.all(np.diff(motion.time) > 0) and found.sum() == 2
    speeds = motion.values("ball.vy")[found]
    np.testing.assert_allclose(speeds, np.sqrt(2 * 9.81) * np.array([-1, 0.5]), rtol=1e-12)
    assert da.evaluate(motion, da.minimum("ball.vy")) == pytest.approx(speeds[0], rel=1e-12)
    again = motion.at(motion.time)
    np.testing.assert_array_equal(again.values("ball.vy"), motion.values("ball.vy"))


@pytest.mark.parametrize("options", [{"step": 0.01}, {"integrator": da.DormandPrince()}])
@pytest.mark.parametrize("speed", [-1.0, 0.0, 1.0])
def test_starts_on_the_surface(options, speed):
    """Closing it bounces at once, at rest it begins closed, opening it flies."""
    system = da.System("start", gravity=(0, -9.81))
    v = system.parameter("v", speed)
    particle = system.add(planar.Particle("ball", mass=1.0, position=(0, 0), velocity=(0, v)))
    system.add(planar.UnilateralConstraint("floor", particle.y, restitution=0.5))
    motion = da.solve_dynamics(system.build(), 0.1, **options)
    away = max(speed, -0.5 * speed)
    height = away * 0.1 - 9.81 * 0.1**2 / 2 if away else 0.0
    assert motion.values("ball.y")[-1] == pytest.approx(height, abs=1e-14)
    assert [i.time for i in motion.impacts] == ([0.0] if speed < 0 else [])


def test_few_states_are_kept_of_long_runs():
    options = {"step": 0.0005, "outputs": 20, "memory": 1e4}
    motion = da.solve_dynamics(thrown(), 0.7, **options)
    assert isinstance(motion.record.steps.x, Checkpoints)
    whole = da.solve_dynamics(thrown(), 0.7, step=0.0005)
    response = da.final(thrown()["b.end.x"])
    found = [da.sensitivity(m, response, method="adjoint").values for m in (motion, whole)]
    np.testing.assert_allclose(*found, rtol=1e-12)


def test_second_derivatives_are_refused():
    motion = da.solve_dynamics(ball(restitution=None).build(), 1.0, step=0.01)
    with pytest.raises(UnsupportedError, match="second derivatives through impacts"):
        da.hessian_product(motion, da.final(motion.model["ball.y"]), [1.0])


def test_a_box_settles_on_its_face():
    """Corners whose gaps are differences, where rounding ends the bounces before time does."""
    system = da.System("box", gravity=(0, -9.81))
    e = system.parameter("e_n", 0.6)
    at = {"position": (0, 1.0), "angle": 0.3, "velocity": (1.0, 0)}
    box = system.add(planar.Body("box", mass=1.0, inertia=0.01, **at))
    for k, (x, y) in enumerate(((-0.15, -0.1), (0.15, -0.1), (0.15, 0.1), (-0.15, 0.1))):
        corner = box.point(x, y)
        law = {"restitution": e, "friction": 0.3}
        system.add(planar.UnilateralConstraint(f"c{k}", corner.y, corner.velocity[0], **law))
    motion = da.solve_dynamics(system.build(), 2.0, integrator=da.DormandPrince())
    assert motion.status.success and not motion.warnings
    assert motion.values("box.y")[-1] == pytest.approx(0.1, abs=1e-13)
    assert motion.values("box.vx")[-1] == pytest.approx(0.0, abs=1e-13)
    pressing = sum(motion.values(f"c{k}.normal_force")[-1] for k in range(2))
    assert pressing == pytest.approx(9.81, rel=1e-12)
    assert np.abs(motion.data["balance_error"]).max() < 1e-8


def spun() -> da.Model:
    """A box in space that falls on a corner."""
    system = da.System("spun", gravity=(0, 0, -9.81))
    e, spin = system.parameter("restitution", 0.7), system.parameter("spin", 4.0)
    box = spatial.Body(
        "box",
        mass=1.2,
        inertia=(0.02, 0.03, 0.04),
        position=(0, 0, 0.5),
        rotation=da.rotation.axis_angle((1, 2, 3), 0.7),
        angular_velocity=(spin, 1.0, -2.0),
    )
    system.add(box)
    for k, (x, y, z) in enumerate((i, j, k) for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)):
        corner = box.point(0.1 * x, 0.15 * y, 0.05 * z)
        system.add(
            spatial.UnilateralConstraint(
                f"c{k}", corner.z, corner.velocity[0], restitution=e, friction=0.2
            )
        )
    return system.build()


def test_in_space():
    model = spun()
    motion = da.solve_dynamics(model, 0.6, integrator=da.DormandPrince())
    assert motion.status.success and len(motion.impacts) >= 2
    assert min(motion.values(f"c{k}.gap").min() for k in range(8)) > -1e-12
    assert np.abs(motion.data["balance_error"]).max() < 1e-6
    found = [
        da.sensitivity(motion, da.final(model["box.position.z"]), method=m).values
        for m in ("direct", "adjoint")
    ]
    np.testing.assert_allclose(*found, rtol=1e-10)


def ball(gap=None, slip=None, height=1.0, **law):
    system = da.System("ball", gravity=(0, -9.81))
    particle = system.add(planar.Particle("ball", mass=1.0, position=(0, height)))
    gap = particle.y if gap is None else gap(particle)
    slip = None if slip is None else slip(particle)
    if law.get("restitution", 0.5) is None:
        law["restitution"] = system.parameter("e_n", 0.5)
    system.add(planar.UnilateralConstraint("floor", gap, slip, **{"restitution": 0.5} | law))
    return system


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
    assert "left and right at t = " in motion.statistics["closed at one time"]
    notes = da.sensitivity(motion, da.final(model["bar.end.y"])).attrs["notes"]
    assert any("left, right close at one time" in note for note in notes)


def test_a_surface_that_moves_by_itself_gives_energy():
    """A plate that oscillates throws a ball; what it gives is in the balance."""
    system = ball(lambda b: b.y + 0.1 - 0.1 * da.cos(7 * da.t), restitution=0.8)
    motion = da.solve_dynamics(system.build(), 3.0, integrator=da.DormandPrince())
    assert motion.status.success and len(motion.impacts) > 3
    assert np.abs(motion.data["balance_error"]).max() < 1e-7
    assert motion.data["input_energy"][-1] != 0


def test_a_belt_that_moves_drags_along():
    system = ball(slip=lambda b: b.vx - 2.0, height=0.0, restitution=0.0, friction=0.5)
    motion = da.solve_dynamics(system.build(), 1.0, step=0.01)
    reached = 2.0 / (0.5 * 9.81)
    assert motion.values("ball.vx")[-1] == pytest.approx(2.0, rel=1e-13)
    assert motion.values("ball.x")[-1] == pytest.approx(2.0 * (1 - reached / 2), rel=1e-12)
    assert np.abs(motion.data["balance_error"]).max() < 1e-12


def test_terminal_events_end_runs_with_impacts():
    motion = da.solve_dynamics(
        ball().build(),
        3.0,
        step=0.01,
        events={"carried": da.Event("floor.normal_force - 5", terminal=True)},
    )
    assert motion.status.outcome is Outcome.TERMINATED
    fall = np.sqrt(2 / 9.81)
    assert motion.status.time == pytest.approx(3 * fall, abs=1e-6)


def test_analyses_that_see_no_contacts_say_so():
    system = ball(height=-0.2)
    spring = {"stiffness": 50.0, "free_length": 0.1}
    particle = system.elements["ball"]
    system.add(planar.Spring("spring", system.ground.point(0, 0.2), particle.center, **spring))
    resting = da.solve_equilibrium(system.build())
    assert any("the gap of floor is -" in text for text in resting.warnings)
    assert resting.values("floor.normal_force").item() == 0.0


REFUSED = {
    "inside": (lambda: ball(height=-0.1), {}, AnalysisError, "gap is -0.1 at the start"),
    "restitution": (lambda: ball(restitution=1.2), {}, ModelError, "restitution is above 1"),
    "friction": (lambda: ball(friction=-0.1), {}, ModelError, "floor.friction: is -0.1"),
    "speed": (lambda: ball(lambda b: b.y + b.vy), {}, ExpressionError, "floor: depends on"),
    "bent": (lambda: ball(slip=lambda b: b.vx**2), {}, ModelError, "linear"),
    "implicit": (ball, {"integrator": da.Radau()}, UnsupportedError, "does not stop at"),
    "every equation": (
        ball,
        {"formulation": da.AugmentedLagrangian()},
        UnsupportedError,
        "does not hold the rigid contact floor",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_refused(name):
    make, options, error, text = REFUSED[name]
    with pytest.raises(error, match=text):
        da.solve_dynamics(make().build(), 1.0, **options)
