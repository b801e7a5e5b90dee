"""Free bodies that sleep: the motion of all others, the forces at rest, and what wakes them."""

import numpy as np
import pytest
from thorough import sampled

import dalembert as da
from dalembert import planar, spatial
from dalembert.results.nonsmooth_motion import NonsmoothMotion

SLEEP, AVERAGE = {"sleep_after": 0.05}, "bodies that sleep, on average"
GRAVITY, MASS = 9.81, 1.0


def bricks(count: int, *others: tuple[tuple[float, float], tuple[float, float]]) -> da.Model:
    """A column of bricks on the floor, and balls by their positions and velocities."""
    system, contact = da.System("bricks", gravity=(0, -GRAVITY)), planar.contact
    shapes: list[planar.contact.Shape] = [contact.HalfPlane(system.ground.center)]
    for k in range(count):
        place = {"position": (0.0, 0.1 + 0.201 * k)}
        mass = system.parameter("mass", MASS, "kg") if k == 0 else MASS
        brick = system.add(planar.Body(f"brick{k}", mass=mass, inertia=0.01, **place))
        shapes.append(contact.Rectangle(brick.center, (0.3, 0.2)))
    for k, (position, velocity) in enumerate(others):
        start = {"position": position, "velocity": velocity}
        ball = system.add(planar.Body(f"ball{k}", mass=MASS, inertia=0.005, **start))
        shapes.append(contact.Circle(ball.center, 0.1))
    system.add(planar.Collisions("hits", shapes, friction=0.5))
    return system.build()


def solved(model: da.Model, duration: float, **options) -> NonsmoothMotion:
    motion = da.solve_nonsmooth(model, duration, step=1e-3, **options)
    assert motion.status.success, motion.status
    return motion


def test_contacts_of_sleeping_bodies_keep_their_forces():
    motion = solved(bricks(3), 0.5, **SLEEP)
    assert motion.statistics[AVERAGE] > 2
    forces = motion.contact_forces(0.45)
    for k in range(3):
        below = "ground" if k == 0 else f"brick{k - 1}"
        error = forces.between(below, f"brick{k}") - (0, (3 - k) * MASS * GRAVITY)
        assert np.abs(error).max() < 1e-5 * MASS * GRAVITY  # those of the last step awake
    assert (motion.record.ends.v[:, -1] == 0).all()


def test_column_that_a_ball_hits_moves_as_without_sleep():
    model = bricks(4, ((-1.5, 0.55), (4.1, 0.5)))  # no whole or half number of steps away
    awake, asleep = (solved(model, 0.6, **options) for options in ({}, SLEEP))
    assert asleep.statistics[AVERAGE] > 1
    assert abs(awake["brick2.x"][-1]) > 0.02  # it was hit
    for name in ("brick0.x", "brick2.x", "brick2.angle", "brick3.y", "ball0.x"):
        difference = np.abs(awake[name] - asleep[name]).max()
        assert difference < 1e-3 * SLEEP["sleep_after"], name  # of bodies with sleep_speed


def test_impact_on_a_sleeping_body_has_the_same_impulse():
    system, contact = da.System("table", gravity=(0, -GRAVITY)), planar.contact
    discs = []
    for k, (x, speed) in enumerate([(0.0, 0.0), (-1.0, 2.0)]):
        start = {"position": (x, 0.1), "velocity": (speed, 0.0)}
        body = system.add(planar.Body(f"disc{k}", mass=MASS, inertia=0.005, **start))
        discs.append(contact.Circle(body.center, 0.1))
    shapes = [*discs, contact.HalfPlane(system.ground.center)]
    system.add(planar.Collisions("hits", shapes, restitution=0.8))
    motion = solved(system.build(), 0.8, **SLEEP)
    assert motion.statistics[AVERAGE] > 0.3
    assert motion["disc0.vx"][-1] == pytest.approx(1.8, abs=1e-9)  # (1 + e) v/2
    assert motion["disc1.vx"][-1] == pytest.approx(0.2, abs=1e-9)


def test_forces_that_grow_wake_bodies():
    system = da.System("block", gravity=(0, -GRAVITY))
    block = system.add(planar.Body("block", mass=MASS, inertia=0.01, position=(0, 0.1)))
    push = da.where(da.t < 0.3, 0.0, 8.0)
    system.add(planar.Force("push", block.center, (push, 0.0)))
    shapes = [planar.contact.Rectangle(block.center, (0.3, 0.2))]
    shapes.append(planar.contact.HalfPlane(system.ground.center))
    system.add(planar.Collisions("floor", shapes, friction=0.5))
    motion = solved(system.build(), 0.5, **SLEEP)
    assert motion.statistics[AVERAGE] > 0.4
    acceleration = 8.0 / MASS - 0.5 * GRAVITY
    assert motion["block.x"][-1] == pytest.approx(acceleration * 0.2**2 / 2, rel=0.02)


def test_slow_bodies_out_of_balance_do_not_sleep():
    """A body on a soft spring turns back slowly, and one without shapes flies on."""
    system = da.System("space", gravity=(0, 0))
    body = system.add(planar.Body("body", mass=MASS, inertia=0.01, position=(0.51, 0)))
    system.add(planar.Body("shapeless", mass=MASS, inertia=0.01, velocity=(1.0, 0.0)))
    ends = system.ground.center, body.center
    system.add(planar.Spring("spring", *ends, stiffness=1.0, free_length=0.5))
    wall = planar.contact.HalfPlane(system.ground.point(0, -1))
    system.add(planar.Collisions("hits", [planar.contact.Circle(body.center, 0.1), wall]))
    motion = solved(system.build(), 6.0, **SLEEP)
    assert motion["body.x"][-1] == pytest.approx(0.5 + 0.01 * np.cos(6.0), abs=1e-6)
    assert motion["shapeless.x"][-1] == pytest.approx(6.0)


@pytest.mark.parametrize("seed", sampled(range(6), 3))
def test_heaps_of_boxes_come_to_rest(seed: int):
    rng = np.random.default_rng(seed)
    system = da.System("heap", gravity=(0, 0, -GRAVITY))
    shapes: list[spatial.contact.Shape] = [spatial.contact.HalfSpace(system.ground)]
    for k in range(8):
        place = (*(0.25 * rng.random(2)), 0.15 + 0.25 * k)
        start = {"position": place, "rotation": np.linalg.qr(rng.normal(size=(3, 3)))[0]}
        start["rotation"] *= np.linalg.det(start["rotation"])
        body = system.add(
            spatial.Body(f"box{k}", mass=MASS, inertia=(0.003, 0.004, 0.006), **start)
        )
        shapes.append(spatial.contact.Box(body.center, (0.2, 0.15, 0.1)))
    system.add(spatial.Collisions("hits", shapes, friction=0.5))
    motion = solved(system.build(), 3.0, **SLEEP)
    assert motion.statistics[AVERAGE] > 1
    assert motion.statistics["maximum penetration [m]"] < 1e-10
    assert (motion.record.ends.v[:, -1] == 0).all()


def test_gradients_of_bodies_that_sleep_are_refused():
    motion = solved(bricks(2), 0.1, **SLEEP)
    with pytest.raises(da.UnsupportedError, match="sleep_after"):
        da.sensitivity(motion, da.final("brick0.y"))


def test_joints_do_not_sleep():
    system = da.System("pendulum", gravity=(0, -GRAVITY))
    rod = system.add(planar.Body("rod", mass=MASS, inertia=0.01, position=(0, 1)))
    system.add(planar.Revolute("hinge", system.ground.point(0, 1), rod.center))
    floor = planar.contact.HalfPlane(system.ground.center)
    shapes = [planar.contact.Circle(rod.center, 0.1), floor]
    system.add(planar.Collisions("hits", shapes))
    model, analysis = system.build(), da.Nonsmooth(duration=0.1, step=1e-3, sleep_after=0.1)
    for start in (lambda: analysis.run(model), analysis.checks(model)[""]):
        with pytest.raises(da.UnsupportedError, match="sleep_after needs free rigid bodies"):
            start()


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"sleep_after": 0.0}, "sleep_after is 0"),
        ({"sleep_after": 0.1, "sleep_speed": -1.0}, "sleep_speed is -1"),
        ({"sleep_after": 0.1, "separate_impacts": True}, "exclude each other"),
    ],
)
def test_options_are_checked(options: dict, text: str):
    with pytest.raises(da.AnalysisError, match=text):
        da.solve_nonsmooth(bricks(1), 0.1, step=1e-3, **options)
