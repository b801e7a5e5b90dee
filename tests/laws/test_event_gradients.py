"""Responses at events: the instant moves with the parameters, and the gradient says by how much.

Direct and adjoint gradients agree to round-off, and with differences of the same steps in which
the event is located anew.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest
from registry import INTEGRATORS
from thorough import crossed

import dalembert as da
from dalembert import planar

DIFFERENCE = da.FiniteDifference("richardson", 3e-4)
SUNDIALS = {"CVODES", "IDA"}
ENDS = [True, False]


def pendulum():
    """Swings down from above the horizontal; heavy enough damping to be no conservative case."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    length, start = system.parameter("length", 0.8), system.parameter("start", 0.3)
    mass, damping = system.parameter("mass", 1.4), system.parameter("damping", 0.11)
    rod = system.add(planar.Bar("rod", length=length, mass=mass, angle=start))
    pin = system.add(planar.Revolute("pin", system.ground.center, rod.start))
    system.add(planar.Torque("drag", rod, -damping * rod.angular_velocity))
    system.initial(rod.angle, start)
    return (
        system.build(),
        rod.angle + 1.0,
        [pin.name + ".force_norm", "rod.angular_velocity", "rod.end.x"],
    )


def four_bar():
    """A falling four-bar with a parametric coupler; the event watches a point of it."""
    system = da.System("four-bar", gravity=(0.0, -9.81))
    l1, l2, l3 = (system.parameter(f"l{k}", v) for k, v in enumerate((0.3, 1.0, 0.6), 1))
    omega = system.parameter("omega", 1.0)
    crank = planar.Bar("crank", length=l1, mass=5 * l1, angle=1.57, angular_velocity=omega)
    crank, coupler, rocker = (
        system.add(bar)
        for bar in (
            crank,
            planar.Bar("coupler", length=l2, mass=5 * l2, angle=0.2),
            planar.Bar("rocker", length=l3, mass=5 * l3, angle=1.2),
        )
    )
    system.add(planar.Revolute("O1", system.ground.point(0, 0), crank.start))
    system.add(planar.Revolute("A", crank.end, coupler.start))
    system.add(planar.Revolute("B", coupler.end, rocker.end))
    system.add(planar.Revolute("O2", system.ground.point(1, 0), rocker.start))
    system.initial(crank.angle, 1.57)
    return (
        system.build(),
        coupler.center.y - 0.35,
        ["A.force_norm", "rocker.angular_acceleration", "coupler.x"],
    )


def slider_crank():
    """A slider pushed against a spring turns a crank; the event is a position of the slider."""
    system = da.System("slider-crank")
    radius, rod_length = system.parameter("radius", 0.15), system.parameter("rod_length", 0.4)
    stiffness, push = system.parameter("stiffness", 300.0), system.parameter("push", 25.0)
    crank = system.add(planar.Bar("crank", length=radius, mass=1.2, angle=0.6))
    rod = system.add(planar.Bar("rod", length=rod_length, mass=0.8, angle=-0.2))
    slider = system.add(planar.Body("slider", mass=0.5, inertia=0.01, position=(0.5, 0)))
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    system.add(planar.Revolute("A", crank.end, rod.start))
    system.add(planar.Revolute("B", rod.end, slider.center))
    system.add(planar.Prismatic("guide", system.ground.center, slider.center, axis=(1, 0)))
    wall = system.ground.point(0.8, 0)
    system.add(planar.Spring("spring", slider.center, wall, stiffness, free_length=0.3))
    system.add(planar.Force("thrust", slider.center, (-push * da.cos(3 * da.t), 0.0)))
    system.initial(crank.angle, 0.6)
    return system.build(), slider.x - 0.46, ["guide.force.y", "crank.angle", "slider.vx"]


MECHANISMS = {"pendulum": pendulum, "four-bar": four_bar, "slider-crank": slider_crank}


@functools.cache
def mechanism(name: str):
    return MECHANISMS[name]()


def run(name: str, terminal: bool, integrator=None, **options):
    model, measure, _ = mechanism(name)
    options = {"step": 0.013, "integrator": integrator or da.RK4()} | options
    events = {"passes": da.Event(measure, terminal=terminal)}
    motion = da.solve_dynamics(model, 1.0, events=events, **options)
    wanted = da.Outcome.TERMINATED if terminal else da.Outcome.COMPLETED
    assert motion.status.outcome is wanted
    assert motion.events
    return motion


def responses(name: str, terminal: bool) -> list[da.Response]:
    """Every kind of response, over measures with velocities, accelerations and reactions."""
    first, second, third = mechanism(name)[2]
    responses = [
        da.event_time("passes"),
        da.at_event("passes", first),
        da.at_event("passes", second),
        da.at_event("passes", f"{third}**2 + 0.3*t"),
    ]
    if terminal:
        responses += [kind(first) for kind in (da.final, da.integral, da.mean, da.rms)]
        responses += [da.maximum(first), da.minimum(second), da.maximum(third, smooth=0.3)]
        responses.append(da.at(0.05, first))
    return responses


def check(motion, listed, same=1e-9, differences=1e-6, step=DIFFERENCE) -> None:
    adjoint = da.sensitivity(motion, listed, method="adjoint").values
    direct = da.sensitivity(motion, listed, method="direct").values
    expected = step.gradient(motion, listed, range(adjoint.shape[1]))
    size = np.abs(adjoint).max(axis=1, keepdims=True)
    assert size[0] > 0
    size[size == 0] = 1.0  # samples at the start, where they are held
    assert np.all(np.abs(direct - adjoint) <= same * size)
    assert np.all(np.abs(expected - adjoint) <= differences * size)


@pytest.mark.few(1)
@pytest.mark.parametrize("terminal", [True, False])
@pytest.mark.parametrize("name", MECHANISMS)
def test_every_kind_of_response(name, terminal):
    check(run(name, terminal), responses(name, terminal))


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("integrator", "terminal"), crossed([n for n in INTEGRATORS if n not in SUNDIALS], ENDS)
)
def test_every_integrator(integrator, terminal):
    motion = run("pendulum", terminal, INTEGRATORS[integrator])
    check(motion, responses("pendulum", terminal))


CHOICES = {
    "few outputs": {"outputs": 8},
    "one output": {"outputs": [0.7]},
    "few states kept": {"memory": 1e3},
    "seldom corrected": {"stabilization": da.Projection(every=4), "step": 0.005},
    "energy": {"stabilization": da.EnergyProjection()},
    "partition": {"formulation": da.VelocityPartitioning()},
    "index 3": {"formulation": da.DAE(index=3), "integrator": da.Radau()},
    "joint coordinates": {"coordinates": da.JointCoordinates()},
}


@pytest.mark.few(2)
@pytest.mark.parametrize(("choice", "terminal"), crossed(CHOICES, ENDS))
def test_every_choice(choice, terminal):
    check(run("four-bar", terminal, **CHOICES[choice]), responses("four-bar", terminal))


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("beyond", "integrator"),
    crossed([0.0, 1e-13, -1e-13, 1e-10, -1e-10], ["RK4", "BackwardEuler", "Newmark", "BDF"], 2),
)
def test_events_at_the_end_of_a_step(integrator, beyond):
    """Where the last step or the last interval is nearly nothing, gradients stay what they are."""
    model, _, (force, _, _) = mechanism("pendulum")
    options = {"step": 0.02, "integrator": INTEGRATORS[integrator]}
    free = da.solve_dynamics(model, 0.4, **options)
    level = float(free.values("rod.angle")[-3]) + beyond
    for terminal in (True, False):
        events = {"passes": da.Event(f"rod.angle - ({level!r})", terminal)}
        motion = da.solve_dynamics(model, 0.4, events=events, **options)
        listed = [da.event_time("passes"), da.at_event("passes", force)]
        if terminal:
            listed += [da.final("rod.end.x"), da.integral(force), da.rms("rod.angular_velocity")]
        check(motion, listed)


def test_later_occurrences_and_events_thought_of_afterwards():
    motion = run("slider-crank", False)
    _, measure, (force, _, _) = mechanism("slider-crank")
    assert len(motion.events) > 4
    turns = da.Event("slider.vx", direction=-1)
    listed = [da.event_time("passes", 4), da.at_event("passes", force, 3)]
    listed += [da.event_time(turns), da.at_event(turns, "slider.x", 2)]
    check(motion, listed)
    assert da.evaluate(motion, listed[0]) == pytest.approx(motion.events[3].time, abs=1e-12)
    same = da.event_time(da.Event(measure), 4)
    assert da.evaluate(motion, same) == pytest.approx(motion.events[3].time, abs=1e-12)
    # where the slider turns back, its speed has none and its place only that of the fixed time
    assert da.evaluate(motion, da.at_event(turns, "slider.vx")) == pytest.approx(0, abs=1e-10)


def test_events_before_the_terminal_one():
    model, measure, (force, _, _) = mechanism("pendulum")
    events = {"ends": da.Event(measure, terminal=True), "level": "rod.angle"}
    motion = da.solve_dynamics(model, 1.0, step=0.01, events=events)
    assert [e.name for e in motion.events] == ["level", "ends"]
    check(motion, [da.event_time("level"), da.at_event("level", force)])
    unchanged = da.sensitivity(motion, da.final("rod.angle")).values
    assert np.abs(unchanged).max() < 1e-12  # it ends at an angle that is no parameter


# driven mechanisms -------------------------------------------------------------------------------


@pytest.mark.few(1)
@pytest.mark.parametrize("solve", [da.solve_kinematics, da.solve_inverse_dynamics])
def test_driven_mechanisms(solve):
    """A crank with a Scotch yoke: ``x = r cos(ω t + ½ a t²)`` passes a place."""
    system = da.System("yoke")
    names = {"r": 0.2, "omega": 1.7, "a": 0.4, "place": 0.05}
    r, omega, a, place = (system.parameter(n, v) for n, v in names.items())
    crank = system.add(planar.Bar("crank", length=r, mass=1.0, angle=0.1))
    yoke = system.add(planar.Body("yoke", mass=2.0, inertia=0.1, position=(0.2, 0)))
    system.add(planar.Revolute("O", system.ground.center, crank.start))
    system.add(planar.Prismatic("guide", system.ground.center, yoke.center, axis=(1, 0)))
    system.add(planar.PinInSlot("slot", yoke.center, crank.end, axis=(0, 1)))
    law = da.Polynomial(0.0, omega, a)
    system.add(planar.RotationalDriver("motor", system.ground, crank, law))
    motion = solve(system.build(), 3.0, step=0.05)
    passes = da.Event(yoke.x - place)
    driver = "motor.moment" if solve is da.solve_inverse_dynamics else "crank.end.y"
    listed = [da.event_time(passes, n) for n in (1, 2)]
    listed += [da.at_event(passes, m) for m in ("yoke.vx", "yoke.ax", driver)]
    check(motion, listed)
    angle = np.arccos(names["place"] / names["r"])
    time = (-names["omega"] + np.sqrt(names["omega"] ** 2 + 2 * names["a"] * angle)) / names["a"]
    assert da.evaluate(motion, listed[0]) == pytest.approx(time, abs=1e-12)
    rate = -np.sin(angle) * names["r"] * (names["omega"] + names["a"] * time)
    by_place = da.sensitivity(motion, listed[0], wrt=["place"]).item()
    assert by_place == pytest.approx(1 / rate, rel=1e-10)


# where there is no derivative --------------------------------------------------------------------


def test_an_event_that_is_only_just_reached_is_refused():
    """The cube of a measure passes zero with no rate."""
    model, measure, _ = mechanism("pendulum")
    motion = da.solve_dynamics(model, 1.0, step=0.01, events={"touch": measure**3})
    assert da.evaluate(motion, da.at_event("touch", measure)) == pytest.approx(0, abs=1e-6)
    with pytest.raises(da.SingularityError, match=r"'touch' at t = 0.39\d+ s grazes"):
        da.sensitivity(motion, da.event_time("touch"))


def test_two_events_that_end_the_run_together_are_refused():
    model, measure, _ = mechanism("pendulum")
    events = {"one": da.Event(measure, True), "other": da.Event(2 * measure, True)}
    motion = da.solve_dynamics(model, 1.0, step=0.01, events=events)
    with pytest.raises(da.SingularityError, match="'one' and 'other' happen in the same instant"):
        da.sensitivity(motion, da.final("rod.x"))
    events["other"] = da.Event(2 * measure, True, direction=1)  # it falls, so this never happens
    motion = da.solve_dynamics(model, 1.0, step=0.01, events=events)
    check(motion, [da.final("rod.x")])


def test_events_that_do_not_happen_are_named():
    motion = run("four-bar", False)
    often = len(motion.events)
    with pytest.raises(da.AnalysisError, match=f"'passes' happened {often} times .* occurrence 7"):
        da.evaluate(motion, da.event_time("passes", 7))
    with pytest.raises(da.AnalysisError, match=r"'crank\.x - 9' never happened"):
        da.evaluate(motion, da.event_time(da.Event("crank.x - 9")))
    with pytest.raises(da.AnalysisError, match=r"no event 'pases' .*known: passes"):
        da.evaluate(motion, da.event_time("pases"))
    with pytest.raises(da.AnalysisError, match="the first one is 1"):
        da.event_time("passes", 0)
    with pytest.raises(da.AnalysisError, match="needs an event"):
        da.AtEvent("crank.x")


def test_an_event_lost_by_other_parameters_is_an_error():
    """Thrown up by 3 m/s a ball reaches 0.45 m, by 2 m/s only 0.2 m."""
    system = da.System("throw", gravity=(0.0, -9.81))
    speed = system.parameter("speed", 3.0)
    system.add(planar.Particle("ball", mass=1.0, velocity=(0.0, speed)))
    analysis = da.Dynamics(1.0, step=0.01, events={"up": da.Event("ball.y - 0.4", True)})
    motion = analysis.run(system.build())
    with pytest.raises(da.AnalysisError, match=r"'ball\.y - 0\.4' does not happen again"):
        analysis.replay(motion, np.array([2.0]))


def test_analyses_without_events_say_so():
    system = da.System("hanging", gravity=(0.0, -9.81))
    rod = system.add(planar.Bar("rod", length=1.0, mass=1.0, angle=-1.5))
    system.add(planar.Revolute("pin", system.ground.center, rod.start))
    equilibrium = da.solve_equilibrium(system.build())
    with pytest.raises(da.UnsupportedError, match="Equilibrium has no events"):
        da.evaluate(equilibrium, da.event_time(da.Event("rod.angle")))
