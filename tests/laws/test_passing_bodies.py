"""Corners that turn past a wall, closely and without contact."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.analysis.nonsmooth.free_bodies.free_body_march import FreeBodyMarch

SIDE, CLEARANCE, SPIN = 0.2, 1e-4, 10.0
HEIGHT = SIDE / np.sqrt(2) + CLEARANCE
SCHEMES = [da.AnticipatedImpacts(), da.MoreauJean()]


def spinning_square(height: float = HEIGHT) -> da.Model:
    """Above a floor."""
    system, kit = da.System("square", gravity=(0.0, 0.0)), planar.contact
    start = {"position": (0.0, height), "angle": 0.3, "angular_velocity": SPIN}
    body = system.add(planar.Body("box", mass=1.0, inertia=0.01, **start))
    corners = [(x * SIDE / 2, y * SIDE / 2) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    shapes = [kit.Polygon(body, corners), kit.HalfPlane(system.ground.center)]
    system.add(planar.Collisions("hits", shapes, friction=0.3))
    return system.build()


def spinning_cube() -> da.Model:
    """About an edge direction, along the wall."""
    system, kit = da.System("cube", gravity=(0.0, 0.0, 0.0)), spatial.contact
    start = {"position": (0.0, 0.0, HEIGHT), "angular_velocity": (0.0, SPIN, 0.0)}
    rotation = da.rotation.axis_angle((0.0, 1.0, 0.0), 0.3)
    body = spatial.Body("box", mass=1.0, inertia=(0.01,) * 3, rotation=rotation, **start)
    shapes = [kit.HalfSpace(system.ground.frame()), kit.Box(system.add(body).center, (SIDE,) * 3)]
    system.add(spatial.Collisions("hits", shapes, friction=0.3))
    return system.build()


@pytest.mark.few(1)
@pytest.mark.parametrize("compiled", [True, False])
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("scene", [spinning_square, spinning_cube])
def test_a_corner_passes_a_wall_without_an_impulse(scene, scheme, compiled, monkeypatch):
    """At the closest positions, linear parts of the gap close within a step."""
    if not compiled:
        monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    for step in (4e-3, 2e-3):
        motion = da.solve_nonsmooth(scene(), 0.4, step=step, integrator=scheme)
        assert motion.status.success
        assert not motion.record.key.size
        end = motion.record.ends.v[:, -1]
        assert np.abs(end).max() == pytest.approx(SPIN, rel=1e-12)
        assert np.linalg.norm(end) == pytest.approx(SPIN, rel=1e-12)


@pytest.mark.few(1)
@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_corner_hits_a_wall_that_is_in_its_way(scheme):
    """The same square, nearer by twice the clearance."""
    model = spinning_square(HEIGHT - 2 * CLEARANCE)
    motion = da.solve_nonsmooth(model, 0.4, step=1e-3, integrator=scheme)
    assert motion.status.success and motion.record.key.size
    assert motion.statistics["maximum penetration [m]"] < 1e-9 * SIDE
    assert motion["box.angular_velocity"].values[-1] < SPIN


def hinged_bar(clearance: float) -> da.Model:
    """A bar that turns about its fixed centre above a floor; no step is as exact as its gap."""
    system, kit = da.System("bar", gravity=(0.0, 0.0)), planar.contact
    start = {"position": (0.0, 0.0), "angle": 0.3, "angular_velocity": SPIN}
    bar = system.add(planar.Body("bar", mass=1.0, inertia=0.02, **start))
    system.add(planar.Revolute("pin", system.ground.center, bar.center))
    floor = system.ground.point(0.0, -np.hypot(0.2, 0.02) - clearance)
    shapes = [kit.Rectangle(bar, (0.4, 0.04)), kit.HalfPlane(floor)]
    system.add(planar.Collisions("hits", shapes))
    return system.build()


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("scene", ["hinged bar", "free square", "free square, general steps"])
@pytest.mark.parametrize("clearance", [1e-6, 3e-6, 1e-5, 3e-5])
def test_micrometres_are_enough_to_pass(clearance, scene, scheme, monkeypatch):
    """The path of a corner in a step of 2 ms rises by ``r (h ω)²/8``, 10 µm and 7 µm, from its
    chord: without this, an impact would be prepared for in the step before the closest position."""
    if scene == "free square, general steps":
        monkeypatch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
    model = hinged_bar(clearance)
    if scene != "hinged bar":
        model = spinning_square(SIDE / np.sqrt(2) + clearance)
    for step in (2e-3, 1.9e-3, 1e-3):
        motion = da.solve_nonsmooth(model, 0.3, step=step, integrator=scheme)
        assert motion.status.success and not motion.record.key.size
        assert np.abs(motion.record.ends.v[:, -1]).max() == pytest.approx(SPIN, rel=1e-9)
