"""Mechanics that is easily got wrong: revolving gears, zero lengths, far guesses, wrong inputs."""

from __future__ import annotations

import re

import numpy as np
import pytest

import dalembert as da
from dalembert import planar
from dalembert.elements.laws import CycloidalRise


def planetary() -> da.System:
    """Fixed sun 0.2 m, planet 0.1 m on an arm that turns once per second."""
    system = da.System("planetary")
    arm = system.add(planar.Body("arm", mass=1, inertia=1, position=(0.3, 0), angle=0))
    sun = system.add(planar.Body("sun", mass=1, inertia=1, position=(0, 0), angle=0))
    planet = system.add(planar.Body("planet", mass=1, inertia=1, position=(0.3, 0), angle=0))
    system.add(planar.Revolute("pivot", system.ground.center, arm.point(-0.3, 0)))
    system.add(planar.Revolute("pin", arm.center, planet.center))
    system.add(planar.Weld("fixed", system.ground.center, sun.center))
    system.add(
        planar.GearPair(
            "mesh",
            sun.center,
            planet.center,
            radius_i=0.2,
            radius_j=0.1,
        )
    )
    system.add(planar.RotationalDriver("motor", system.ground, arm, 2 * np.pi * da.t))
    return system


@pytest.mark.parametrize("solve", [da.solve_kinematics, da.solve_dynamics])
def test_planet_turns_by_willis(solve):
    """φ_planet = (1 + r_sun/r_planet) φ_arm, over more than a turn."""
    motion = solve(planetary().build(), 1.3, step=0.01)
    assert motion.status.success
    assert motion["planet.angle"].values[-1] == pytest.approx(3 * 2 * np.pi * 1.3, abs=1e-9)


def test_spring_of_length_zero():
    """A linear spring without free length is harmonic, from rest at its own anchor too."""
    system = da.System("drop", gravity=(0.0, -9.81))
    bob = system.add(planar.Particle("bob", mass=1.0, position=(0, 0)))
    system.add(planar.Spring("spring", system.ground.center, bob.center, stiffness=100.0))
    motion = da.solve_dynamics(system.build(), 1.0, step=0.005)
    assert motion["bob.y"].values[-1] == pytest.approx(-0.0981 * (1 - np.cos(10.0)), abs=1e-6)


def test_guess_out_of_reach_is_corrected():
    """A slider guessed beyond its dead centre is pulled back; the mechanism can be assembled."""
    system = da.System("slider-crank")
    slider = system.add(planar.Body("slider", mass=1, inertia=1, position=(3.1, 0), angle=0))
    crank = system.add(planar.Bar("crank", length=1.0, mass=1, angle=0.5))
    rod = system.add(planar.Bar("rod", length=2.0, mass=1))
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, slider.center))
    system.add(planar.Prismatic("C", system.ground.center, slider.center))
    model = system.build()
    assert model.start.residual < 1e-10
    assert model.diagnosis.corrections


@pytest.mark.parametrize("direction", np.arange(0, 2 * np.pi, np.pi / 4))
def test_point_goes_to_the_nearest_place_of_a_curve(direction):
    corners = [(np.cos(a), np.sin(a)) for a in np.arange(0, 2 * np.pi, np.pi / 4)]
    system = da.System("cam")
    place = 1.1 * np.array([np.cos(direction), np.sin(direction)])
    pin = system.add(planar.Particle("pin", mass=1, position=place))
    system.add(planar.PointOnCurve("cam", system.ground, pin.center, da.SplineCurve(corners)))
    assert np.linalg.norm(system.build().start.y[:2] - place) < 0.5


@pytest.mark.parametrize("formulation", [da.KKT(), da.RangeSpace()])
def test_inertia_zero_by_parameter(formulation):
    """A parameter that is zero acts as the number zero."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    inertia = system.parameter("inertia", 0.0)
    bob = system.add(planar.Body("bob", mass=1.0, inertia=inertia, position=(1, 0), angle=0))
    system.add(planar.Revolute("pin", system.ground.center, bob.point(-1, 0)))
    motion = da.solve_dynamics(system.build(), 0.5, step=0.01, formulation=formulation)
    assert motion.status.success


def test_friction_by_the_load_is_refused():
    """Friction that depends on a reaction, which depends on the friction, is told at once."""
    system = da.System("sledge", gravity=(0.0, -9.81))
    sledge = system.add(
        planar.Body("sledge", mass=2, inertia=1, position=(0, 0), angle=0, velocity=(3, 0))
    )
    joint = system.add(planar.Prismatic("rail", system.ground.center, sledge.center))
    load = system.lookup("rail.force_norm")
    system.add(planar.JointFriction("friction", joint, coulomb=0.3 * load, transition=1e-3))
    with pytest.raises(da.ModelError, match=r"^friction: depends on rail.lambda0; only"):
        system.build()


def test_start_in_a_singular_position():
    """An aligned parallelogram is taken by what passes such positions, and by nothing else."""
    system = da.System("parallelogram")
    mass = system.parameter("m", 1.0)
    cranks = [
        system.add(planar.Bar(f"crank{k}", length=1.0, mass=mass, angle=0.0, angular_velocity=0.5))
        for k in range(2)
    ]
    coupler = system.add(planar.Bar("coupler", length=2.0, mass=1, angle=0.0))
    for k, crank in enumerate(cranks):
        system.add(planar.Revolute(f"O{k}", system.ground.point(2 * k, 0), crank.start))
        system.add(planar.Revolute(f"A{k}", crank.end, coupler.point(2 * k - 1, 0)))
    model = system.build()
    assert model.diagnosis.degrees_of_freedom == 1
    assert any("singular position" in text for _, text in model.diagnosis.messages)
    alone = (da.solve_equilibrium, da.linearize, lambda m: da.solve_dynamics(m, 1.0, step=0.01))
    for refusing in alone:
        with pytest.raises(da.SingularityError, match="A1 lose their independence"):
            refusing(model)
    motion = da.solve_dynamics(model, 1.0, step=0.01, formulation=da.AugmentedLagrangian())
    for crank in ("crank0", "crank1"):
        np.testing.assert_allclose(motion[f"{crank}.angle"], 0.5 * motion.time, atol=1e-8)
    with pytest.raises(da.SingularityError, match="singular position"):
        da.sensitivity(motion, da.final("crank0.angle"))


def _body(system: da.System, name="b"):
    return system.add(planar.Body(name, mass=1, inertia=1, position=(0, 0), angle=0))


def _speed_in_constraint(system):
    body = _body(system)
    system.add(planar.UserConstraint("user", body.x - body.vy))


def _speed_in_stop(system):
    system.add(planar.Stop("stop", _body(system).vy, lower=-1.0, stiffness=10.0))


def _foreign_parameter_in_force(system):
    system.add(planar.Force("force", _body(system), (da.System("other").parameter("q", 1.0), 0.0)))


def _foreign_parameter_in_point(system):
    anchor = system.ground.point(da.System("other").parameter("q", 1.0), 0.0)
    system.add(planar.Spring("spring", anchor, _body(system).center, stiffness=1.0))


def _distance_not_positive(system):
    bob = system.add(planar.Particle("bob", mass=1, position=(0.5, 0)))
    system.add(planar.DistanceDriver("driver", system.ground.center, bob.center, -0.5))


def _particle_without_turn(system):
    bob = system.add(planar.Particle("bob", mass=1, position=(0, 0)))
    system.add(planar.Prismatic("rail", _body(system).center, bob.center))


def _particle_with_an_arm(system):
    bob = system.add(planar.Particle("bob", mass=1, position=(0, 0)))
    system.add(planar.Revolute("pin", system.ground.center, bob.point(0.1, 0)))


def _particle_rolls(system):
    bob = system.add(planar.Particle("bob", mass=1, position=(0, 0.1)))
    system.add(planar.RollingDisc("wheel", system.ground.center, bob.center, radius=0.1))


def _rise_longer_than_its_period(system):
    law = CycloidalRise(height=1.0, duration=1.0, fall=1.0, period=1.5)
    system.add(planar.RotationalDriver("motor", system.ground, _body(system), law))


def _rise_that_jumps_back(system):
    law = CycloidalRise(height=1.0, duration=1.0, period=1.5)
    system.add(planar.RotationalDriver("motor", system.ground, _body(system), law))


@pytest.mark.parametrize(
    "describe",
    [
        _speed_in_constraint,
        _speed_in_stop,
        _foreign_parameter_in_force,
        _foreign_parameter_in_point,
        _distance_not_positive,
        _particle_without_turn,
        _particle_with_an_arm,
        _particle_rolls,
        _rise_longer_than_its_period,
        _rise_that_jumps_back,
    ],
)
def test_wrong_descriptions_are_refused(describe):
    """A ``ModelError`` that names the element, when it is made or when the system is built."""
    system = da.System("wrong", gravity=(0.0, -9.81))

    def build():
        describe(system)
        system.build()

    with pytest.raises(da.ModelError):
        build()


def test_outputs_after_a_terminal_event_are_left_out():
    """The motion ends at the event, and that is its last time."""
    system = da.System("fall", gravity=(0.0, -9.81))
    bob = system.add(planar.Particle("bob", mass=1.0, position=(0, 1)))
    hit = da.Event(bob.y, terminal=True)
    motion = da.solve_dynamics(
        system.build(), 1.0, step=0.01, events={"hit": hit}, outputs=[0.6, 0.9]
    )
    assert motion.status.outcome is da.Outcome.TERMINATED
    assert motion.time[-1] == pytest.approx(np.sqrt(2 / 9.81), abs=1e-12)


def test_a_prescribed_speed_survives_inconsistent_guesses():
    """``system.initial`` is met exactly where given speeds contradict the joints."""
    system = da.System("pendulum")
    rod = system.add(
        planar.Bar(
            "rod", length=1.0, mass=1.0, angle=0.4, velocity=(1.0, 1.0), angular_velocity=-2.0
        )
    )
    system.add(planar.Revolute("pin", system.ground.center, rod.start))
    system.initial(rod.angular_velocity, 3.0)
    model = system.build()
    assert model.start.projected_speeds
    assert model.start.v[2] == pytest.approx(3.0, abs=1e-12)


def crank_of_a_short_rod():
    """A driven crank with a rod too short to turn with it: locked where the rod is upright."""
    system = da.System("lock")
    crank = system.add(planar.Bar("crank", length=0.5, mass=1.0, angle=0.2))
    rod = system.add(planar.Bar("rod", length=0.3, mass=1.0, angle=-0.3))
    slider = system.add(planar.Body("slider", mass=1.0, inertia=1.0, position=(0.8, 0.0)))
    ground, axis = system.ground.point(0, 0), (1.0, 0.0)
    system.add(planar.Revolute("O", ground, crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, slider.center))
    system.add(planar.Prismatic("rail", ground, slider.center, axis=axis))
    law = da.laws.Polynomial(velocity=1.0, start=0.2)
    system.add(planar.RotationalDriver("motor", system.ground, crank, law))
    return system.build()


@pytest.mark.few(2)
@pytest.mark.parametrize(
    "choice",
    [
        {"integrator": da.Radau(), "formulation": da.DAE(2, stabilized=True)},
        {"integrator": da.DormandPrince()},
        {"step": 0.002},
        {"step": 0.01},
        {"step": 0.002, "coordinates": da.JointCoordinates()},
    ],
    ids=repr,
)
def test_a_lock_is_found_and_what_was_reached_is_kept(choice):
    """Where 0.5 sin φ = 0.3, however the equations fail there."""
    motion = da.solve_dynamics(crank_of_a_short_rod(), 1.2, **choice)
    lock = np.arcsin(0.6) - 0.2
    assert motion.status.outcome is da.Outcome.SINGULAR
    match = re.search(r"t = ([\d.]+)", motion.status.message)
    assert match and float(match[1]) == pytest.approx(lock, abs=0.02)
    assert motion.time[-1] > lock - 0.01
    assert "solve_kinematics shows" in motion.status.message


@pytest.mark.parametrize(
    "choice",
    [{"formulation": "KKT"}, {"integrator": da.RK4}, {"stabilization": None}, {"coordinates": 1}],
    ids=repr,
)
def test_values_that_are_no_strategy_are_refused_with_a_suggestion(choice):
    """A name, a class or a number in place of an object."""
    (name,) = choice
    with pytest.raises(da.AnalysisError, match=rf"{name}.* such as \w+\(\)"):
        da.solve_dynamics(planetary().build(), 0.1, **choice)
