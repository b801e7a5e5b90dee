"""Scenes of free bodies whose steps run in machine code, and runs with and without it."""

from __future__ import annotations

import numpy as np
import pytest

import dalembert as da
from dalembert import planar, spatial
from dalembert.analysis.nonsmooth.free_bodies.free_body_march import FreeBodyMarch
from dalembert.results.nonsmooth_motion import NonsmoothMotion


def planar_scene(seed: int) -> da.Model:
    """Discs of several sizes, some off their bodies' centres, in a box with a tilted wall."""
    rng = np.random.default_rng(seed)
    system = da.System("discs", gravity=(0, -9.81))
    contact, shapes, bodies = planar.contact, [], []
    for k in range(8):
        place = (0.5 * (k % 3) + 0.05 * rng.random(), 0.25 + 0.45 * (k // 3))
        start = {"position": place, "angle": rng.normal(), "velocity": tuple(rng.normal(size=2))}
        spin = rng.normal()
        if k == 7:
            body = planar.Particle(f"b{k}", mass=rng.uniform(1, 3), position=place)
            system.add(body)
            shapes.append(contact.Circle(body.center, 0.1))
            continue
        mass = {"mass": rng.uniform(1, 3), "inertia": 0.02}
        body = system.add(planar.Body(f"b{k}", angular_velocity=spin, **mass, **start))
        bodies.append(body)
        offset = (0.05, 0.02) if k % 3 == 2 else (0.0, 0.0)
        shapes.append(contact.Circle(body.point(*offset), rng.uniform(0.08, 0.18)))
    rope = bodies[0].center, system.ground.center
    system.add(planar.Spring("rope", *rope, stiffness=30.0, free_length=0.3))
    shapes.append(contact.HalfPlane(system.ground.point(0, 0), (0.1, 1)))
    shapes.append(contact.HalfPlane(system.ground.point(-0.4, 0), (1, 0)))
    shapes.append(contact.HalfPlane(system.ground.point(1.6, 0), (-1, 0)))
    laws = {"friction": 0.3, "restitution": 0.4, "tangential": 0.1}
    if seed % 2:
        laws["rolling"] = 0.002
    system.add(planar.Collisions("hits", shapes, **laws))
    return system.build()


def spatial_scene(seed: int) -> da.Model:
    """Spheres in a corner, with damping and principal inertias that differ."""
    rng = np.random.default_rng(seed)
    system = da.System("spheres", gravity=(0, 0, -9.81))
    contact, shapes = spatial.contact, []
    for k in range(6):
        place = np.array([0.4 * (k % 2), 0.4 * (k // 2 % 2), 0.3 + 0.5 * (k // 4)])
        body = spatial.Body(
            f"b{k}",
            mass=rng.uniform(1, 3),
            inertia=tuple(rng.uniform(0.01, 0.015, 3)),
            position=tuple(place + 0.05 * rng.random(3)),
            rotation=da.rotation.axis_angle(tuple(rng.normal(size=3)), 1.0),
            velocity=tuple(rng.normal(size=3)),
            angular_velocity=tuple(rng.normal(size=3)),
        )
        system.add(body)
        shapes.append(contact.Sphere(body.center, rng.uniform(0.1, 0.18)))
    for normal in np.eye(3):
        place = (-0.3 * (1 - normal[2])) * normal
        shapes.append(contact.HalfSpace(system.ground.frame(tuple(place), axis=tuple(normal))))
    laws = {"friction": 0.4, "restitution": 0.3}
    if seed % 2:
        laws |= {"rolling": 0.002, "spinning": 0.003}
    system.add(spatial.Collisions("hits", shapes, **laws))
    return system.build()


def planar_hulls(seed: int) -> da.Model:
    """Polygons, a capsule and discs, whose edges meet, between a floor and two walls."""
    rng = np.random.default_rng(seed)
    system = da.System("polygons", gravity=(0, -9.81))
    contact, shapes = planar.contact, []
    for k in range(6):
        place = (0.4 * (k % 2), 0.15 + 0.42 * (k // 2))
        start = {"position": place, "angle": 0.2 * rng.normal() if k > 1 else 0.0}
        start["velocity"] = tuple(rng.normal(size=2)) if k > 1 else (0.0, 0.0)
        body = system.add(planar.Body(f"b{k}", mass=rng.uniform(1, 3), inertia=0.02, **start))
        if k == 3:
            shapes.append(contact.Circle(body.center, 0.12))
        elif k == 4:
            shapes.append(contact.Capsule(body.point(-0.1, 0), body.point(0.1, 0), 0.08))
        else:
            shapes.append(contact.Rectangle(body.center, (0.36, 0.3)))
    for point, normal in (((0, 0), (0, 1)), ((-0.3, 0), (1, 0)), ((0.7, 0), (-1, 0))):
        shapes.append(contact.HalfPlane(system.ground.point(*point), normal))
    laws = {"friction": 0.3, "restitution": 0.3}
    if seed % 2:
        laws["rolling"] = 0.002
    system.add(planar.Collisions("hits", shapes, **laws))
    return system.build()


def spatial_hulls(seed: int) -> da.Model:
    """Boxes, one of them on another, a sphere and a capsule above a floor."""
    rng = np.random.default_rng(seed)
    system = da.System("boxes", gravity=(0, 0, -9.81))
    contact, shapes = spatial.contact, []
    for k in range(5):
        place = np.array([0.5 * (k % 2), 0.0, 0.1 + 0.25 * (k // 2)])
        start = {"position": tuple(place), "rotation": np.eye(3)}
        if k > 2:
            turn = da.rotation.axis_angle(tuple(rng.normal(size=3)), 0.3)
            start |= {"rotation": turn, "velocity": tuple(0.5 * rng.normal(size=3))}
        inertia = tuple(rng.uniform(0.01, 0.015, 3))
        body = system.add(spatial.Body(f"b{k}", mass=rng.uniform(1, 3), inertia=inertia, **start))
        if k == 3:
            shapes.append(contact.Sphere(body.center, 0.1))
        elif k == 4:
            shapes.append(contact.Capsule(body.point(-0.1, 0, 0), body.point(0.1, 0, 0), 0.08))
        else:
            shapes.append(contact.Box(body.center, (0.3, 0.25, 0.2)))
    shapes.append(contact.HalfSpace(system.ground.frame(axis=(0, 0, 1))))
    laws = {"friction": 0.4, "restitution": 0.3}
    if seed % 2:
        laws |= {"rolling": 0.002, "spinning": 0.003}
    system.add(spatial.Collisions("hits", shapes, **laws))
    return system.build()


def two_boxes(seed: int) -> da.Model:
    """A turning box falls on another one, which falls on a floor."""
    rng = np.random.default_rng(seed)
    system = da.System("boxes", gravity=(0, 0, -9.81))
    contact, shapes = spatial.contact, [spatial.contact.HalfSpace(system.ground.frame())]
    for k in range(2):
        axis = tuple(rng.normal(size=3))
        angle = float(rng.uniform(0.2, 2.5)) if k else 0.3
        start = {"position": (0.03 * k, 0.02 * k, 0.16 + 0.28 * k)}
        start["velocity"] = tuple(0.3 * rng.normal(size=3))
        start["angular_velocity"] = tuple(3.0 * rng.normal(size=3))
        start["rotation"] = da.rotation.axis_angle(axis, angle)
        body = system.add(spatial.Body(f"b{k}", mass=1.0, inertia=(0.01,) * 3, **start))
        shapes.append(contact.Box(body.center, (0.2, 0.2, 0.2)))
    system.add(spatial.Collisions("hits", shapes, friction=0.3))
    return system.build()


def turning_wall() -> da.Model:
    """Discs that fall on a spinning body with a flat side, whose gaps are not convex."""
    system = da.System("wheel", gravity=(0, -9.81))
    motion = {"position": (0, 0), "velocity": (0, 0), "angular_velocity": 6.0}
    plate = system.add(planar.Body("plate", mass=50.0, inertia=2.0, **motion))
    contact = planar.contact
    shapes = [contact.HalfPlane(plate.point(0, 0), (0, 1))]
    for k in range(4):
        place = (-0.6 + 0.4 * k, 0.15 + 0.02 * k)
        disc = system.add(planar.Body(f"d{k}", mass=1.0, inertia=0.005, position=place))
        shapes.append(contact.Circle(disc.center, 0.1))
    system.add(planar.Collisions("hits", shapes, friction=0.2, restitution=0.5))
    return system.build()


def both_ways(
    model: da.Model, monkeypatch: pytest.MonkeyPatch, **options
) -> tuple[NonsmoothMotion, NonsmoothMotion]:
    """Runs in machine code and by general steps."""
    compiled = da.solve_nonsmooth(model, **options)
    with monkeypatch.context() as patch:
        patch.setattr(FreeBodyMarch, "of", lambda *arguments: None)
        general = da.solve_nonsmooth(model, **options)
    return compiled, general


def falling_boxes(count: int, seed: int) -> da.Model:
    """Boxes in rows above each other that fall into a box."""
    rng, system = np.random.default_rng(seed), da.System("boxes", gravity=(0.0, 0.0, -9.81))
    friction, push = system.parameter("friction", 0.3), system.parameter("push", 0.0, "m/s")
    shapes: list[spatial.contact.Shape] = []
    columns = int(np.ceil(count ** (1 / 3) - 1e-9))
    for k in range(count):
        x, y, z = k // columns % columns, k % columns, k // columns**2
        place = 0.24 * (np.array([x, y]) - (columns - 1) / 2) + 0.01 * rng.random(2)
        speed = 0.3 * rng.normal(size=3)
        velocity = (speed[0] + push, speed[1], speed[2])
        start = {"position": (*place, 0.105 + 0.21 * z), "velocity": velocity}
        body = spatial.Body(f"box{k}", mass=10.0, inertia=(0.0667,) * 3, **start)
        shapes.append(spatial.contact.Box(system.add(body).center, (0.2,) * 3))
    half = 0.12 * columns
    shapes.append(spatial.contact.HalfSpace(system.ground.frame()))
    for axis in range(2):
        for sign in (1, -1):
            point, normal = np.zeros(3), np.zeros(3)
            point[axis], normal[axis] = -sign * half, sign
            frame = system.ground.frame(tuple(point), axis=tuple(normal))
            shapes.append(spatial.contact.HalfSpace(frame))
    system.add(spatial.Collisions("contacts", shapes, friction=friction))
    return system.build()
