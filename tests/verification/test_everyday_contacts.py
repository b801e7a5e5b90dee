"""Everyday scenes with contacts, by the default scheme at obvious steps, against closed forms.

A ball that slides, then rolls; a ball on an incline with rolling friction; a block below and above
the angle of friction; a spinning ball braked by spinning friction; a ball that bounces off a moving
wall; a cradle of different masses with gaps (Meriam & Kraige, Dynamics; Stronge, Impact Mechanics).
"""

from __future__ import annotations

import numpy as np
import pytest
from rigid_contacts import other_warnings

import dalembert as da
from dalembert import planar, spatial

contact = planar.contact
G, R = 9.81, 0.1


def run(system: da.System, duration: float, step: float) -> da.Motion:
    motion = da.solve_nonsmooth(system.build(), duration, step=step)
    assert motion.status.success and not other_warnings(motion)
    return motion


def slope(angle: float) -> da.System:
    return da.System("slope", gravity=(G * np.sin(angle), -G * np.cos(angle)))


def ball(system: da.System, **start: tuple[float, float]) -> planar.Body:
    start = {"position": (0, R)} | start
    return system.add(planar.Body("ball", mass=1.0, inertia=0.4 * R**2, **start))


def test_a_sliding_ball_rolls_at_last():
    system = slope(0.0)
    shapes = [contact.Circle(ball(system, velocity=(2, 0)), R), contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, friction=0.2))
    assert run(system, 0.6, 5e-3)["ball.vx"][-1].item() == pytest.approx(2 * 5 / 7, rel=1e-9)


def test_rolling_friction_on_an_incline():
    system = slope(0.2)
    shapes = [contact.Circle(ball(system), R), contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, friction=0.5, rolling=0.005))
    speed = G * (np.sin(0.2) - 0.005 / R * np.cos(0.2)) / 1.4
    assert run(system, 1.0, 1e-2)["ball.vx"][-1].item() == pytest.approx(speed, rel=1e-9)


@pytest.mark.parametrize("share", [1.05, 0.9])
def test_a_block_slides_above_the_angle_of_friction(share):
    friction, system = np.tan(0.4) * share, slope(0.4)
    block = system.add(planar.Body("block", mass=1.0, inertia=0.01, position=(0, 0.05)))
    shapes = [contact.Rectangle(block, (0.4, 0.1)), contact.HalfPlane(system.ground)]
    system.add(planar.Collisions("floor", shapes, friction=friction))
    speed = max(0.0, 0.5 * G * (np.sin(0.4) - friction * np.cos(0.4)))
    assert run(system, 0.5, 1e-2)["block.vx"][-1].item() == pytest.approx(speed, abs=1e-9)


def test_a_moving_wall_returns_its_own_speed():
    """``v⁺ = w − e (v − w)``."""
    system = da.System("racket")
    wall = system.add(planar.Body("wall", mass=1.0, inertia=1.0))
    rail = system.add(planar.Prismatic("rail", system.ground.center, wall.center, axis=(1, 0)))
    system.add(planar.TranslationalDriver("drive", rail, -1.5 * da.t))
    body = ball(system, position=(-0.8, 0), velocity=(2, 0))
    shapes = [contact.Circle(body, R), contact.HalfPlane(wall, normal=(-1, 0))]
    system.add(planar.Collisions("hits", shapes, restitution=0.6))
    assert run(system, 0.3, 5e-3)["ball.vx"][-1].item() == pytest.approx(-3.6, rel=1e-9)


def test_a_cradle_of_different_masses():
    system, masses, shapes = da.System("cradle"), (1.0, 2.0, 0.5), []
    for k, mass in enumerate(masses):
        start = {"position": (0.25 * k, 0), "velocity": (float(k == 0), 0)}
        shapes.append(
            contact.Circle(system.add(planar.Particle(f"b{k}", mass=mass, **start)).center, R)
        )
    system.add(planar.Collisions("hits", shapes, restitution=1.0))
    speed = 2 / (1 + 2.0) * 2 * 2.0 / (2.0 + 0.5)
    assert run(system, 0.6, 5e-3)["b2.vx"][-1].item() == pytest.approx(speed, rel=1e-9)


def test_spinning_friction_brakes_a_ball():
    """``dω/dt = −c m g/I``."""
    system = da.System("top", gravity=(0, 0, -G))
    start = {"position": (0, 0, R), "angular_velocity": (0, 0, 5.0)}
    body = system.add(spatial.Body("ball", mass=1.0, inertia=(0.004,) * 3, **start))
    shapes = [
        spatial.contact.Sphere(body.center, R),
        spatial.contact.HalfSpace(system.ground.frame()),
    ]
    system.add(spatial.Collisions("floor", shapes, friction=0.3, spinning=0.001))
    motion = run(system, 0.5, 1e-2)
    assert motion.record.ends.v[5, -1] == pytest.approx(5 - 0.5 * 0.001 * G / 0.004, rel=1e-9)
