"""Bodies that move farther in a step than others are thick, and contacts that give energy."""

from __future__ import annotations

import functools
import re

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial

STEP, SPEED, SIDE = 0.01, 5.0, 0.02
PASSES = "move through each other within the step at t = "


@functools.cache
def thrown(kind: str, dimension: int) -> da.Model:
    """A ball or a cube against a plate of 4 mm."""
    flat = dimension == 2
    system = da.System("throw")
    height = system.parameter("height", 0.5, "m")
    if flat:
        shapes, start = planar.contact, {"position": (0, height), "velocity": (0.1, -SPEED)}
        body = system.add(planar.Body("body", mass=1.0, inertia=1e-3, **start))
        own = {"ball": lambda: shapes.Circle(body, SIDE / 2)}
        own["cube"] = lambda: shapes.Rectangle(body, (SIDE, SIDE))
        plate = shapes.Rectangle(system.ground.point(0, 0), (1.0, 4e-3))
        system.add(planar.Collisions("hit", [own[kind](), plate], restitution=0.5))
        return system.build()
    solids, start = spatial.contact, {"position": (0, 0, height), "velocity": (0.1, 0, -SPEED)}
    solid = system.add(spatial.Body("body", mass=1.0, inertia=(1e-3, 1e-3, 1e-3), **start))
    own = {"ball": lambda: solids.Sphere(solid, SIDE / 2)}
    own["cube"] = lambda: solids.Box(solid, (SIDE, SIDE, SIDE))
    plate = solids.Box(system.ground.point(0, 0, 0), (1.0, 1.0, 4e-3))
    system.add(spatial.Collisions("hit", [own[kind](), plate], restitution=0.5))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", [da.MoreauJean(), da.MoreauJean(projection=False)])
@pytest.mark.parametrize(
    ("kind", "dimension"), [("ball", 2), ("cube", 2), ("ball", 3), ("cube", 3)]
)
def test_a_body_that_moves_through_a_plate_is_warned_about(kind, dimension, scheme):
    """It moves by 50 mm in a step; the proposed step stops it at the plate."""
    through, model = 0, thrown(kind, dimension)
    for height in 0.5 + SPEED * STEP * np.arange(4) / 4:
        run = functools.partial(da.solve_nonsmooth, model, 0.2, integrator=scheme)
        motion = run(step=STEP, parameters={"height": height})
        if motion["body.y" if dimension == 2 else "body.z"][-1] > 0:
            continue
        through += 1
        (warning,) = [text for text in motion.warnings if PASSES in text]
        assert warning.startswith("body and ") and warning.endswith("AnticipatedImpacts()")
        shorter = float(re.search("use step=([^ ]*) or shorter", warning).group(1))
        fine = run(step=shorter, parameters={"height": height})
        assert not [text for text in fine.warnings if PASSES in text]
        assert fine["body.y" if dimension == 2 else "body.z"][-1] > 0.1
    assert through


@pytest.mark.parametrize("kind", ["ball", "cube"])
def test_anticipated_impacts_stop_at_a_thin_plate(kind):
    motion = da.solve_nonsmooth(thrown(kind, 2), 0.2, step=STEP)
    assert motion["body.y"].min() > SIDE / 2
    assert not [text for text in motion.warnings if PASSES in text]


def test_bodies_that_pass_beside_each_other_are_not_warned_about():
    """The faces between them close by their linear parts, but the bodies never overlap."""
    system = da.System("beside")
    start = {"position": (-0.1, 0.03), "velocity": (SPEED, SPEED)}
    body = system.add(planar.Body("body", mass=1.0, inertia=1e-3, **start))
    shapes = [planar.contact.Rectangle(body, (SIDE, SIDE))]
    shapes.append(planar.contact.Rectangle(system.ground.point(0, 0), (0.1, 0.1)))
    system.add(planar.Collisions("hit", shapes))
    motion = da.solve_nonsmooth(system.build(), 0.03, step=STEP, integrator=da.MoreauJean())
    assert not motion.record.step.size
    assert not [text for text in motion.warnings if PASSES in text]


def test_contacts_that_give_energy_are_warned_about():
    """A rod that strikes the floor at its end, with a slip that friction ends (Kane's paradox)."""
    lean, start = 0.963, {"velocity": (0.376, -1.0), "angular_velocity": 1.393}
    system, law = da.System("rod"), {"restitution": 0.9, "friction": 0.304}
    middle = (0.0, 0.5 * np.sin(lean) + 1e-3)
    rod = planar.Bar("rod", length=1.0, mass=2.0, position=middle, angle=lean, **start)
    shapes = [
        planar.contact.Vertex(system.add(rod).start),
        planar.contact.HalfPlane(system.ground),
    ]
    system.add(planar.Collisions("floor", shapes, **law))
    run = functools.partial(da.solve_nonsmooth, system.build(), 0.02, step=1e-3)
    motion = run(integrator=da.MoreauJean())
    gain = float(motion["energy"].max() - motion["energy"][0])
    assert gain > 0.1 * motion["energy"][0]
    (warning,) = [text for text in motion.warnings if text.startswith("contacts gave")]
    assert float(warning.split()[2]) == pytest.approx(gain, rel=0.01)
    assert not [text for text in run().warnings if text.startswith("contacts gave")]


def turning_bar(turn: float) -> da.Model:
    """A bar that turns by an angle per step beside a post, clear of it at all ends of steps."""
    system, shapes = da.System("bar", gravity=(0, 0)), planar.contact
    spin = {"angle": 0.3, "angular_velocity": turn / STEP}
    bar = system.add(planar.Body("bar", mass=1.0, inertia=0.1, **spin))
    post = shapes.Circle(system.ground.point(0, 0.4), SIDE)
    capsule = shapes.Capsule(bar.point(-0.5, 0), bar.point(0.5, 0), SIDE / 2)
    system.add(planar.Collisions("hit", [capsule, post]))
    return system.build()


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize("turn", [0.5 * np.pi, np.pi])
def test_a_bar_that_turns_past_a_post_within_a_step_is_warned_about(turn, scheme):
    """With the proposed step the post stops it."""
    warnings = []
    for step in (STEP, None):
        step = step or float(re.search(r"use step=(\S+) or shorter", warnings[0])[1])
        motion = da.solve_nonsmooth(turning_bar(turn), 0.1, step=step, integrator=scheme)
        assert motion.status.success
        warnings.append(" ".join(text for text in motion.warnings if "a body turns by" in text))
    assert warnings[0].startswith("shapes overlap by") and not warnings[1]
    assert motion.record.key.size


def test_a_disc_may_turn_as_fast_as_it_likes():
    system, shapes = da.System("disc", gravity=(0, -9.81)), planar.contact
    spin = {"position": (0, SIDE), "angular_velocity": 3 / STEP}
    disc = system.add(planar.Body("disc", mass=1.0, inertia=1e-4, **spin))
    sides = [shapes.Circle(disc, SIDE), shapes.HalfPlane(system.ground.center)]
    system.add(planar.Collisions("hit", sides, friction=0.01))
    motion = da.solve_nonsmooth(system.build(), 0.1, step=STEP)
    assert motion.record.key.size and not motion.warnings


@pytest.mark.parametrize(("overlap", "passes"), [(2e-6, False), (2e-3, True)])
def test_corners_that_graze_each_other_do_not_pass(overlap: float, passes: bool):
    """A sharp corner falls past another one, which it overlaps within a step."""
    system, kit = da.System("corners"), planar.contact
    start = {"position": (-overlap, 0.07), "velocity": (0, -10.0)}
    body = system.add(planar.Body("falling", mass=1.0, inertia=0.1, **start))
    corners = {-1: [(0, 0), (-1, 0.3), (-1, -0.3)], 1: [(0, 0), (1, -0.3), (1, 0.3)]}
    shapes = [kit.Polygon(system.ground, corners[-1]), kit.Polygon(body, corners[1])]
    system.add(planar.Collisions("hits", shapes))
    motion = da.solve_nonsmooth(system.build(), 0.02, step=1e-2, integrator=da.MoreauJean())
    assert any(PASSES in text for text in motion.warnings) == passes
