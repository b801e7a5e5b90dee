"""Joints and drivers that cannot be: one message with the entity and the cure."""

from __future__ import annotations

import pytest

import dalembert as da
from dalembert import planar, spatial


def body(system: da.System, name: str, **more) -> spatial.Body:
    arguments = {"rotation": da.rotation.identity(), "mass": 1.0, "inertia": (0.1, 0.2, 0.15)}
    return system.add(spatial.Body(name, **arguments, **more))


def two(other: tuple = (0, 1, 0)):
    system = da.System("pair")
    a, b = body(system, "a", position=(0, 0, 0)), body(system, "b", position=(1, 0, 0))
    return system, a.frame(), b.frame(axis=other)


def cross_of_parallel_arms():
    system, i, j = two((0, 0, 1))
    system.add(spatial.Universal("U", i, j))
    system.build()


def driver_of_nothing(kind, joint, **more):
    def make():
        system, i, j = two()
        system.add(kind("D", system.add(joint("J", i, j)), 0.0, **more))

    return make


def driver_of_a_frame():
    _, i, j = two()
    spatial.RotationalDriver("D", i, j, 0.0)


def driver_of_a_body():
    system, *_ = two()
    spatial.TranslationalDriver("D", body(system, "c"), 0.0)


def slide_of_a_ball():
    system, i, j = two()
    ball = system.add(spatial.Spherical("S", i.body.center, j.body.center))
    spatial.TranslationalDriver("D", ball, 0.0)


def gears_apart():
    system, i, j = two()
    far = body(system, "c"), body(system, "d")
    first = system.add(spatial.Revolute("A", i, far[0]))
    second = system.add(spatial.Revolute("B", j, far[1]))
    system.add(spatial.GearPair("G", first, second, radius_i=1, radius_j=1))


def particle_on_a_hinge():
    system, i, _ = two()
    system.add(spatial.Revolute("A", i, system.add(spatial.Particle("dot", mass=1))))


def angle_without_x():
    _, i, j = two()
    spatial.Weld("W", i, j, angle=0.2)


def screw_without_pitch():
    system, i, j = two((0, 0, 1))
    system.add(spatial.Screw("S", i, j, pitch=0.0))
    system.build()


WRONG = {
    r"a direction needs a length": lambda: two((0, 0, 0)),
    r"axis and x are parallel": lambda: two()[1].body.frame(axis=(0, 0, 1), x=(0, 0, 2)),
    r"^U: the arms of its cross are parallel; give": cross_of_parallel_arms,
    "^D: joint must be a joint, .* got Frame": driver_of_a_frame,
    "^D: joint must be a joint, .* got Body": driver_of_a_body,
    "^D: joint must leave a displacement free; got Spherical S": slide_of_a_ball,
    r"^D: joint must leave a turn free; got Prismatic J": driver_of_nothing(
        spatial.RotationalDriver, spatial.Prismatic
    ),
    r"^D: joint must leave a displacement free; got Revolute J": driver_of_nothing(
        spatial.TranslationalDriver, spatial.Revolute
    ),
    r"^D: J has no turn 'roll'; it has angle_i, angle_j": driver_of_nothing(
        spatial.RotationalDriver, spatial.Universal, motion="roll"
    ),
    r"^G: A and B have no body in common.*put both hinges on one carrier": gears_apart,
    r"^A: dot is a particle and has no axes": particle_on_a_hinge,
    r"^W: angle= is counted from x axes.*give both frames": angle_without_x,
    r"^S: a screw needs a pitch, got 0 m": screw_without_pitch,
}


@pytest.mark.parametrize("message", WRONG)
def test_invalid_joints_are_refused(message):
    with pytest.raises(da.ModelError, match=message):
        WRONG[message]()


PLANE_WRONG = {
    "D: joint must leave a turn free; got Weld W": lambda s, w, r: planar.RotationalDriver(
        "D", w, 0.0
    ),
    "D: joint must leave a displacement free; got Revolute R": lambda s, w, r: (
        planar.TranslationalDriver("D", r, 0.0)
    ),
    "D: 'A' is a name; give the element": lambda s, w, r: planar.RotationalDriver("D", "A", 1.0),
    "D: has no law; give a law": lambda s, w, r: planar.RotationalDriver("D", r),
    "D: give a joint that leaves a turn free, or body_i and body_j": lambda s, w, r: (
        planar.RotationalDriver("D", law=0.0)
    ),
    "D: give the joint, or body_i and body_j, not both": lambda s, w, r: planar.RotationalDriver(
        "D", s.ground, s.ground, 0.0, joint=r
    ),
    "D: axis is that of its joint; leave it out": lambda s, w, r: planar.TranslationalDriver(
        "D", planar.Prismatic("P", s.ground.center, r.point_j), law=0.0, axis=(0, 1)
    ),
}


@pytest.mark.parametrize("message", PLANE_WRONG)
def test_invalid_planar_drivers_are_refused(message):
    system = da.System("s")
    bodies = [system.add(planar.Body(name, mass=1.0, inertia=1.0)) for name in "ab"]
    weld = system.add(planar.Weld("W", system.ground.center, bodies[0].center))
    revolute = system.add(planar.Revolute("R", system.ground.center, bodies[1].center))
    with pytest.raises(da.ModelError, match=message):
        PLANE_WRONG[message](system, weld, revolute)


def test_a_driver_of_the_plane_takes_no_joint_of_space():
    _, i, j = two()
    joint = spatial.Revolute("J", i, j)
    with pytest.raises(da.ModelError, match=r"^D: joint J is in space, and RotationalDriver is a"):
        planar.RotationalDriver("D", joint, 0.0)
