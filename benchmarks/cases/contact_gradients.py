"""Gradients of discs that fall into a box with friction, in processor time of plain runs."""

from __future__ import annotations

import time
from collections.abc import Iterator

import dalembert as da
from benchmarks.cases.base import Case, Effort
from benchmarks.falling_bodies import FRICTION, GRAVITY, MASS, SIZE, STEP, FallingBodies
from benchmarks.sample import Row, Sample
from dalembert import planar

COUNTS, PARAMETERS = (10, 30, 100), ("radius", "friction")


def model(bodies: FallingBodies) -> da.Model:
    """The discs, with parameters."""
    system = da.System("discs", gravity=(0.0, -GRAVITY))
    size, friction = system.parameter("radius", SIZE, "m"), system.parameter("friction", FRICTION)
    push, mass = system.parameter("push", 0.0, "m/s"), system.parameter("mass", MASS, "kg")
    shapes: list[planar.contact.Shape] = []
    for k, (place, speed) in enumerate(zip(bodies.positions, bodies.velocities, strict=True)):
        start = {"position": tuple(place), "angle": 0.0, "velocity": (speed[0] + push, speed[1])}
        disc = planar.Body(f"disc{k}", mass=mass, inertia=mass * size**2 / 2, **start)
        shapes.append(planar.contact.Circle(system.add(disc), size))
    for point, normal in bodies.walls():
        shapes.append(planar.contact.HalfPlane(system.ground.point(*point), tuple(normal)))
    system.add(planar.Collisions("contacts", shapes, friction=friction))
    return system.build()


def measure(effort: Effort) -> Iterator[Row]:
    steps, response = 50 if effort.quick else 1000, da.final("disc3.x")
    for count in COUNTS[: 1 if effort.quick else None]:
        discs = model(FallingBodies.of("disc", count))
        analysis = da.Nonsmooth(steps * STEP, step=STEP, outputs=2)
        warm = da.Nonsmooth(2 * STEP, step=STEP).run(discs)
        da.sensitivity(warm, response, method="adjoint")  # compiles
        row = Row(f"{count} discs in a box", f"gradient in plain runs, {steps} steps of 1 ms")
        ratios: dict[str, list[float]] = {"adjoint": [], "direct": []}
        for _ in range(min(effort.rounds, 3)):
            begin = time.process_time()
            motion = analysis.run(discs)
            run = time.process_time() - begin
            for method, chosen in (("adjoint", None), ("direct", list(PARAMETERS))):
                begin = time.process_time()
                da.sensitivity(motion, response, chosen, method=method)
                ratios[method].append((time.process_time() - begin) / run)
        row.samples["dalembert"] = Sample.of(ratios["adjoint"], "", "adjoint, 4 parameters")
        row.samples["dalembert, direct"] = Sample.of(ratios["direct"], "", "2 parameters")
        yield row


CASE = Case("discs-gradient", "gradients of discs that fall into a box", measure)
