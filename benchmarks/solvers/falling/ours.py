"""Rigid contacts of dalembert: no compliance, residual of the complementarity conditions."""

from __future__ import annotations

import numpy as np

import dalembert as da
from benchmarks.falling_bodies import FRICTION, GRAVITY, MASS, SIZE, STEP, FallingBodies
from benchmarks.solvers.falling.base import Run
from dalembert import planar, spatial


def ours(bodies: FallingBodies, scheme: da.AnticipatedImpacts | da.MoreauJean) -> Run:
    """Steps of dalembert, built and compiled before."""
    model = (_planar if bodies.dimension == 2 else _spatial)(bodies)
    da.solve_nonsmooth(model, 2 * STEP, step=STEP, integrator=scheme)

    def run(steps: int) -> tuple[float, float]:
        motion = da.solve_nonsmooth(model, steps * STEP, step=STEP, integrator=scheme, outputs=11)
        if not motion.status.success:
            raise RuntimeError(f"{bodies.count} of {bodies.kind}: {motion.status}")
        seconds = motion.statistics["integration time [s]"] / steps
        return seconds, motion.statistics["maximum penetration [m]"]

    return run


def _planar(bodies: FallingBodies) -> da.Model:
    system = da.System("discs", gravity=(0.0, -GRAVITY))
    shapes: list[planar.contact.Shape] = []
    for k, (place, speed) in enumerate(zip(bodies.positions, bodies.velocities, strict=True)):
        start = {"position": tuple(place), "angle": 0.0, "velocity": tuple(speed)}
        disc = system.add(planar.Body(f"disc{k}", mass=MASS, inertia=bodies.inertia, **start))
        shapes.append(planar.contact.Circle(disc, SIZE))
    for point, normal in bodies.walls():
        shapes.append(planar.contact.HalfPlane(system.ground.point(*point), tuple(normal)))
    system.add(planar.Collisions("contacts", shapes, friction=FRICTION))
    return system.build()


def _spatial(bodies: FallingBodies) -> da.Model:
    system = da.System(bodies.kind, gravity=(0.0, 0.0, -GRAVITY))
    shapes: list[spatial.contact.Shape] = []
    for k, (place, speed) in enumerate(zip(bodies.positions, bodies.velocities, strict=True)):
        start = {"position": tuple(place), "rotation": np.eye(3), "velocity": tuple(speed)}
        inertia = (bodies.inertia,) * 3
        body = spatial.Body(f"{bodies.kind}{k}", mass=MASS, inertia=inertia, **start)
        system.add(body)
        if bodies.kind == "sphere":
            shapes.append(spatial.contact.Sphere(body.center, SIZE))
        else:
            shapes.append(spatial.contact.Box(body.center, (2 * SIZE,) * 3))
    for point, normal in bodies.walls():
        frame = system.ground.frame(tuple(point), axis=tuple(normal))
        shapes.append(spatial.contact.HalfSpace(frame))
    system.add(spatial.Collisions("contacts", shapes, friction=FRICTION))
    return system.build()
