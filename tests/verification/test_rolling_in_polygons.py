"""A disc that rolls without slip over the sides of polygons, by an exact motion from edge to edge.

Along a side at the angle ``φ`` it accelerates by ``2/3 g sin φ``. In a dent of the angle ``δ`` its
angular momentum about the new contact remains, so that its speed is multiplied by
``(1/2 + cos δ)/(3/2)``.
"""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar

G, RADIUS, DISC, MASS, START = 9.81, 0.5, 0.1, 2.0, 0.8
contact = planar.contact


def disc(system: da.System, x: float, y: float) -> planar.Body:
    inertia = MASS * DISC**2 / 2
    return system.add(planar.Body("disc", mass=MASS, inertia=inertia, position=(x, y)))


def rolled(count: int, duration: float, step: float, scheme) -> da.Motion:
    """In a trough, half of a regular polygon about the circle of the radius."""
    system = da.System("trough", gravity=(0, -G))
    path = RADIUS - DISC
    body = disc(system, path * np.sin(START), -path * np.cos(START))
    angles = -np.pi * np.arange(count + 1) / count
    corners = RADIUS / np.cos(np.pi / count / 2) * np.column_stack([np.cos(angles), np.sin(angles)])
    trough = contact.Outline(system.ground, [(-1, 0), (-1, -1), (1, -1), (1, 0), *corners])
    system.add(planar.Collisions("touch", [contact.Circle(body, DISC), trough], friction=2.0))
    return da.solve_nonsmooth(system.build(), duration, step=step, integrator=scheme)


def exact_speed(count: int, duration: float) -> float:
    side, path = np.pi / count, RADIUS - DISC
    angle = (np.floor((START + np.pi / 2) / side) + 0.5) * side - np.pi / 2
    half, place, speed = path * np.tan(side / 2), -path * np.tan(START - angle), 0.0
    while True:
        acceleration = 2 / 3 * G * np.sin(angle)
        at_end = np.sqrt(speed**2 + 2 * acceleration * (half - place))
        needed = (at_end - speed) / acceleration
        if needed > duration:
            return float(speed + acceleration * duration)
        speed = at_end * (0.5 + np.cos(side)) / 1.5
        duration, angle, place = duration - needed, angle - side, -half


@pytest.mark.thorough
@pytest.mark.parametrize("scheme", [da.AnticipatedImpacts(), da.MoreauJean()])
@pytest.mark.parametrize("count", [24, 120])
def test_disc_in_a_trough_of_sides(count, scheme):
    motion = rolled(count, 0.6, 4e-3, scheme)
    speed = DISC * motion["disc.angular_velocity"][-1].item()
    assert motion.status.success and motion.data["penetration"].max() < 1e-9
    assert speed == pytest.approx(exact_speed(count, 0.6), rel=0.02)


def test_a_convex_outline_is_a_polygon():
    """Its corners touch a ball that is between the normals of their sides, not one beside them."""
    runs = []
    angles = 2 * np.pi * (np.arange(30) + 0.5) / 30
    corners = RADIUS * np.column_stack([np.cos(angles), np.sin(angles)])
    for shape in (contact.Outline, contact.Polygon):
        system = da.System("drum", gravity=(0, -G))
        path = RADIUS + DISC
        body = disc(system, path * np.sin(0.15), path * np.cos(0.15))
        shapes = [contact.Circle(body, DISC), shape(system.ground, corners)]
        system.add(planar.Collisions("touch", shapes, friction=1.0))
        runs.append(da.solve_nonsmooth(system.build(), 0.5, step=4e-3)["disc.position"].values[-1])
    np.testing.assert_allclose(*runs, atol=1e-6)
