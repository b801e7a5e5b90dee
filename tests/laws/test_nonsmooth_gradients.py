"""Gradients of motions with many impacts: of the steps, and of impacts that move in time.

Where no impact comes, the derivatives are those of the steps, and differences of the run confirm
them. Impacts are taken at the ends of steps, so that the run itself jumps with its parameters; the
derivatives are those of the motion, to the order of the step, with exact ones beside.
"""

from __future__ import annotations

import functools

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial


def run(model: da.Model, duration: float, step: float, **options) -> da.Motion:
    scheme = options.pop("integrator", da.MoreauJean())
    motion = da.solve_nonsmooth(model, duration, step=step, integrator=scheme, **options)
    assert motion.status.success
    return motion


def both(motion: da.Motion, *responses) -> np.ndarray:
    """Direct derivatives, which are the adjoint ones."""
    direct = da.sensitivity(motion, list(responses), method="direct").values
    adjoint = da.sensitivity(motion, list(responses), method="adjoint").values
    np.testing.assert_allclose(adjoint, direct, rtol=1e-8, atol=1e-10 * abs(direct).max())
    return direct


def confirmed(motion: da.Motion, *responses) -> None:
    gradient = both(motion, *responses)
    values = da.sensitivity(motion, list(responses), method=da.FiniteDifference("richardson"))
    np.testing.assert_allclose(gradient, values.values, rtol=1e-5, atol=1e-7 * abs(gradient).max())


@functools.cache
def bouncing() -> da.Model:
    system = da.System("ball", gravity=(0.0, -10.0))
    height, speed = system.parameter("height", 5.0, "m"), system.parameter("speed", -0.1, "m/s")
    bounce = system.parameter("bounce", 0.8)
    start = {"position": (0.0, height), "velocity": (0.0, speed)}
    ball = system.add(planar.Body("ball", mass=1.0, inertia=0.004, **start))
    floor = [planar.contact.HalfPlane(system.ground.point(0.0, 0.0), (0.0, 1.0))]
    system.add(
        planar.Collisions("floor", [planar.contact.Circle(ball, 1e-9), *floor], restitution=bounce)
    )
    return system.build()


SCHEMES = {
    "anticipated": da.AnticipatedImpacts(),
    "Moreau": da.MoreauJean(),
    "not projected": da.MoreauJean(projection=False),
}
schemes = pytest.mark.parametrize("scheme", SCHEMES.values(), ids=SCHEMES)


@pytest.mark.few(1)
@schemes
def test_bouncing_ball(scheme):
    """The case of Ma et al. (2021): exact derivatives of height and speed after one bounce."""
    exact = [
        [0.8378281129, 0.1015317211, 9.0999549761],
        [1.7999100067, 0.9820008999, 10.0004999875],
    ]
    end = [da.final("ball.y"), da.final("ball.vy")]
    errors = []
    steps = (2e-2, 5e-3) if scheme.projection else (5e-4, 4e-4)  # penetrations of a small ball
    for step in steps:
        gradient = both(run(bouncing(), 1.9, step, integrator=scheme), *end)
        errors.append(abs(gradient / exact - 1).max())
    assert errors[0] < 0.4
    assert errors[1] < 0.06


def test_two_elastic_discs():
    """They change their speeds, ∂x₂(T)/∂(x₁, x₂, v, w) = (1, 0, 1, 0) (NimblePhysics, issue 97)."""
    system = da.System("discs", gravity=(0.0, 0.0))
    first, second = system.parameter("first", 0.0), system.parameter("second", 0.52)
    v, w = system.parameter("v", 1.0), system.parameter("w", 0.0)
    discs = []
    for name, x, speed in (("left", first, v), ("right", second, w)):
        like = {"mass": 1.0, "inertia": 0.1, "position": (x, 0.0), "velocity": (speed, 0.0)}
        discs.append(planar.contact.Circle(system.add(planar.Body(name, **like)), 0.1))
    system.add(planar.Collisions("discs", discs, restitution=1.0))
    gradient = both(run(system.build(), 1.0, 4e-3), da.final("right.x"))
    np.testing.assert_allclose(gradient, [[1.0, 0.0, 1.0, 0.0]], atol=8e-3)


def test_block_that_slides():
    """``x = v t + (g sin α − μ g cos α) t²/2`` down an incline."""
    system = da.System("block", gravity=(0.0, -10.0))
    slope, friction = system.parameter("slope", 0.5, "rad"), system.parameter("friction", 0.3)
    speed = system.parameter("speed", 0.4, "m/s")
    along = (da.cos(slope), -da.sin(slope))
    low = 0.1 - 1e-7  # rounding does not decide whether it touches
    start = {"position": (low * da.sin(slope), low * da.cos(slope)), "angle": 0.0}
    start |= {"velocity": (speed * along[0], speed * along[1])}
    block = system.add(planar.Body("block", mass=2.0, inertia=1e9, **start))
    floor = [
        planar.contact.HalfPlane(system.ground.point(0.0, 0.0), (da.sin(slope), da.cos(slope)))
    ]
    system.add(
        planar.Collisions("floor", [planar.contact.Circle(block, 0.1), *floor], friction=friction)
    )
    motion = run(system.build(), 0.5, 1e-2, integrator=da.MoreauJean(projection=False))
    confirmed(motion, da.final("block.x"), da.final("block.vy"))
    way = both(motion, da.final("block.x"))[0] / np.cos(0.5)
    np.testing.assert_allclose(way[1:], [-10 * np.cos(0.5) * 0.125, 0.5], rtol=1e-6)


@pytest.mark.thorough
def test_ball_that_slips_and_rolls_in_space():
    """Slip at first, then rolling: friction turns in space, ``v = 5 v₀/7`` in the end."""
    system = da.System("bowl", gravity=(0.0, 0.0, -9.81))
    speed, friction = system.parameter("speed", 1.0, "m/s"), system.parameter("friction", 0.2)
    size = system.parameter("radius", 0.1, "m")
    start = {"position": (0.0, 0.0, size), "velocity": (speed, 0.2, 0.0)}
    about = 0.4 * 2.0 * size**2
    ball = spatial.Body("ball", mass=2.0, inertia=(about,) * 3, rotation=np.eye(3), **start)
    system.add(ball)
    floor = [spatial.contact.HalfSpace(system.ground.frame())]
    system.add(
        spatial.Collisions("floor", [spatial.contact.Sphere(ball, size), *floor], friction=friction)
    )
    model = system.build()
    slipping = run(model, 0.1, 1e-2)
    confirmed(slipping, da.final("ball.x"), da.final("ball.vy"))
    rolling = both(run(model, 0.4, 2.5e-3), da.final("ball.vx"))
    np.testing.assert_allclose(rolling, [[5 / 7, 0.0, 0.0]], atol=1e-5)


def sliding(**values: float) -> da.Model:
    """A disc that does not turn, at rest on a floor, with a parameter of each kind."""
    system = da.System("slider", gravity=(0.0, 0.0))
    names = {"mass": 1.5, "size": 0.1, "speed": 1.0, "place": 0.3, "weight": 9.81}
    names |= {"friction": 0.2, "floor": 0.05, "bounce": 0.3}
    value = {name: system.parameter(name, start) for name, start in (names | values).items()}
    start = {"position": (value["place"], value["floor"] + value["size"])}
    start |= {"velocity": (value["speed"], 0.0)}
    body = system.add(planar.Body("body", mass=value["mass"], inertia=1e9, **start))
    pull = (0.0, -value["mass"] * value["weight"])
    system.add(planar.Force("pull", body.center, pull))
    shapes = [planar.contact.Circle(body, value["size"])]
    shapes.append(planar.contact.HalfPlane(system.ground.point(0.0, value["floor"])))
    law = {"friction": value["friction"], "restitution": value["bounce"]}
    system.add(planar.Collisions("touch", shapes, **law))
    return system.build()


@pytest.mark.thorough
def test_all_parameters_of_anticipated_impacts():
    """``x = x₀ + v t − μ g t²/2``, ``y`` = floor + radius; differences of the run confirm it."""
    motion = run(sliding(), 0.2, 1e-2, integrator=da.AnticipatedImpacts())
    responses = [da.final("body.x"), da.final("body.vx"), da.final("body.y")]
    gradient = both(motion, *responses)
    g, t, friction = 9.81, 0.2, 0.2
    exact = np.zeros((3, 8))
    exact[0, [2, 3, 4, 5]] = t, 1.0, -friction * t**2 / 2, -g * t**2 / 2
    exact[1, [2, 4, 5]] = 1.0, -friction * t, -g * t
    exact[2, [1, 6]] = 1.0
    np.testing.assert_allclose(gradient, exact, atol=1e-9)
    names = ["mass", "speed", "place", "weight", "friction"]  # others move the closed gap
    chosen = da.sensitivity(motion, responses, names).values
    differences = da.sensitivity(
        motion, responses, names, method=da.FiniteDifference("richardson")
    ).values
    np.testing.assert_allclose(chosen, differences, atol=1e-6)


@pytest.mark.thorough
def test_discs_before_their_next_impacts():
    """Two layers of discs that slide, roll and press in a short window, against differences."""
    system = da.System("discs", gravity=(0.0, -9.81))
    size, mass = system.parameter("size", 0.1, "m"), system.parameter("mass", 2.0, "kg")
    speed, friction = system.parameter("speed", 0.4, "m/s"), system.parameter("friction", 0.3)
    shapes = []
    depth = 1e-7  # remains closed
    for k in range(4):
        low = 2 * size * k - depth * k
        disc = planar.Body(
            f"disc{k}",
            mass=mass,
            inertia=mass * size**2 / 2,
            position=(low, size - depth),
            angle=0.0,
            velocity=(speed * (1 - 0.2 * k), 0.0),
        )
        shapes.append(planar.contact.Circle(system.add(disc), size))
    shapes.append(planar.contact.HalfPlane(system.ground))
    system.add(planar.Collisions("touch", shapes, friction=friction))
    scheme = da.MoreauJean(projection=False)
    motion = run(system.build(), 0.03, 1e-3, integrator=scheme)
    confirmed(motion, da.final("disc0.x"), da.final("disc3.angle"), da.final("disc3.vx"))


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
def test_pendulum_at_a_wall(scheme):
    """Joints, an impact, and a wall that moves by the clock, against located impacts."""
    system = da.System("pendulum", gravity=(0.0, -9.81))
    length, bounce = system.parameter("length", 0.5, "m"), system.parameter("bounce", 0.6)
    bar = system.add(planar.Bar("bar", length=length, mass=1.0, angle=-0.6))
    system.add(planar.Revolute("O", system.ground.center, bar.start))
    gap = bar.end.x - 0.05 * da.cos(2.0 * da.t)
    system.add(planar.UnilateralConstraint("wall", gap, restitution=bounce))
    model, end = system.build(), [da.final("bar.angle"), da.final("bar.angular_velocity")]
    located = da.solve_dynamics(model, 0.5, step=1e-3)
    assert len(located.impacts) == 1
    exact = da.sensitivity(located, end).values
    gradient = both(run(model, 0.5, 2e-3, integrator=scheme), *end)
    np.testing.assert_allclose(gradient, exact, atol=0.03 * abs(exact).max())


def dropped_bar(tilt: float) -> da.Model:
    system = da.System("dumb-bell", gravity=(0.0, -9.81))
    height = system.parameter("height", 0.3, "m")
    bar = planar.Body("bar", mass=1.0, inertia=0.05, position=(0.0, height), angle=tilt)
    system.add(bar)
    ends = [planar.contact.Circle(bar.point(x, 0.0), 0.02) for x in (-0.5, 0.5)]
    floor = [planar.contact.HalfPlane(system.ground.point(0.0, 0.0), (0.0, 1.0))]
    system.add(planar.Collisions("floor", [*ends, *floor], restitution=0.5))
    return system.build()


def test_impacts_on_one_body_one_after_the_other_in_one_step_are_refused():
    motion = run(dropped_bar(1e-3), 0.3, 1e-3)
    with pytest.raises(da.SingularityError, match="come within one step"):
        da.sensitivity(motion, da.final("bar.y"))


@pytest.mark.thorough
def test_impacts_on_one_body_in_one_instant_are_one():
    """A bar that falls level moves as one ball does: ``y = e g t* (T − t*) − g (T − t*)²/2``."""
    motion = run(dropped_bar(0.0), 0.3, 2e-4)
    computed = both(motion, da.final("bar.y")).item()
    fall, e = np.sqrt(2 * 0.28 / 9.81), 0.5
    after = 0.3 - fall
    assert computed == pytest.approx(e * (after - fall) / fall + after / fall, abs=2e-3)
    assert any("in one instant" in note for note in gradient_notes(motion))


def gradient_notes(motion: da.Motion) -> list[str]:
    return da.sensitivity(motion, da.final("bar.y")).attrs["notes"]


def test_impacts_of_different_bodies_in_one_step():
    """Each moves by itself, as if the other were not there."""
    system = da.System("balls", gravity=(0.0, -10.0))
    heights = [system.parameter(name, 1.0, "m") for name in ("left", "right")]
    balls = []
    for x, height in enumerate(heights):
        like = {"mass": 1.0, "inertia": 0.1, "position": (float(x), height)}
        balls.append(planar.contact.Circle(system.add(planar.Body(f"ball{x}", **like)), 0.1))
    floor = [planar.contact.HalfPlane(system.ground.point(0.0, 0.0), (0.0, 1.0))]
    system.add(planar.Collisions("floor", [*balls, *floor], restitution=0.5))
    gradient = both(run(system.build(), 0.6, 4e-3), da.final("ball0.y"), da.final("ball1.y"))
    fall, e = np.sqrt(2 * 0.9 / 10), 0.5
    left = 0.6 - fall  # y = e g t* (T − t*) − g (T − t*)²/2 with dt*/dH = 1/(g t*)
    exact = (e * 10 * (left - fall) + 10 * left) / (10 * fall)
    np.testing.assert_allclose(gradient, exact * np.eye(2), atol=2e-2)


def test_other_measures_are_refused():
    motion = run(bouncing(), 0.5, 1e-2)
    with pytest.raises(da.UnsupportedError, match="means over steps"):
        da.sensitivity(motion, da.final("ball.ay"))


def test_notes_of_gradients():
    gradient = da.sensitivity(run(bouncing(), 1.9, 2e-2), da.final("ball.y"))
    text = " ".join(gradient.attrs["notes"])
    assert "1 impact moves in time" in text
    assert "slip" not in text


@pytest.mark.few(1)
@pytest.mark.parametrize("height", [0.1, 0.5])
@pytest.mark.parametrize("theta", [0.5, 0.8])
def test_gyroscopic_forces_are_part_of_gradients(height, theta):
    """A ball with unequal moments of inertia, rolling or free."""
    system = da.System("ball", gravity=(0.0, 0.0, -10.0))
    moment = system.parameter("moment", 0.03, "kg*m^2")
    spin = system.parameter("spin", 4.0, "rad/s")
    start = {"position": (0.0, 0.0, height), "angular_velocity": (1.0, spin, 2.0)}
    ball = system.add(spatial.Body("ball", mass=1.0, inertia=(0.02, moment, 0.04), **start))
    shapes = [spatial.contact.Sphere(ball.center, 0.1)]
    floor = spatial.contact.HalfSpace(system.ground.frame())
    system.add(spatial.Collisions("floor", [*shapes, floor], friction=0.4))
    motion = run(system.build(), 0.2, 1e-2, integrator=da.MoreauJean(theta=theta))
    rates = [da.final(motion.model["ball.angular_velocity"][k]) for k in range(3)]
    confirmed(motion, *rates)


def test_contacts_that_an_impact_opens_carry_the_body_before():
    """A ball hits the overhang of a body on the floor, which turns about one of its corners; the
    other one opens. Differences of runs with wide steps are the reference."""

    def run(speed: float) -> da.Motion:
        system, contact = da.System("overhang", gravity=(0, -9.81)), planar.contact
        body = planar.Body("body", mass=1.0, inertia=0.01, position=(0, 0.1))
        start = {"position": (0.17, 0.36), "velocity": (0, system.parameter("speed", speed))}
        ball = planar.Body("ball", mass=0.5, inertia=1e-3, **start)
        corners = [(-0.1, -0.1), (0.1, -0.1), (0.2, 0.1), (-0.2, 0.1)]
        shapes = [contact.Polygon(system.add(body), corners)]
        shapes += [contact.Circle(system.add(ball), 0.05)]
        shapes += [contact.HalfPlane(system.ground.point(0, 0))]
        system.add(planar.Collisions("hits", shapes, restitution=0.3))
        return da.solve_nonsmooth(system.build(), 0.12, step=5e-4)

    ends = [run(speed)["body.angle"].values[-1] for speed in (-1.05, -0.95)]
    gradient = da.sensitivity(run(-1.0), da.final("body.angle"))
    assert gradient.values.item() == pytest.approx((ends[1] - ends[0]) / 0.1, rel=1e-2)
