"""Gradients of discs that fall into a box with friction: run and adjoint, in plain runs."""

from __future__ import annotations

import time
from collections.abc import Iterator

import dalembert as da
from benchmarks.cases.base import Case, Effort
from benchmarks.cases.discs import FRICTION, GRAVITY, MASS, RADIUS, STEP, Box
from benchmarks.sample import Row, Sample
from dalembert import planar

COUNTS, PARAMETERS = (10, 30, 100), ("radius", "friction")


def model(box: Box) -> da.Model:
    """The discs, with parameters."""
    system = da.System("discs", gravity=(0.0, -GRAVITY))
    radius, friction = (
        system.parameter("radius", RADIUS, "m"),
        system.parameter("friction", FRICTION),
    )
    speed, mass = system.parameter("speed", 0.0, "m/s"), system.parameter("mass", MASS, "kg")
    shapes: list[planar.contact.Shape] = []
    for k, (position, velocity) in enumerate(zip(box.positions, box.velocities, strict=True)):
        disc = planar.Body(
            f"disc{k}",
            mass=mass,
            inertia=mass * radius**2 / 2,
            position=tuple(position),
            angle=0.0,
            velocity=(velocity[0] + speed, velocity[1]),
        )
        shapes.append(planar.contact.Circle(system.add(disc), radius))
    left, right = (system.ground.point(x, 0.0) for x in (-box.width / 2, box.width / 2))
    for point, normal in ((left, (0.0, 1.0)), (left, (1.0, 0.0)), (right, (-1.0, 0.0))):
        shapes.append(planar.contact.HalfPlane(point, normal))
    system.add(planar.Collisions("contacts", shapes, friction=friction))
    return system.build()


def measure(effort: Effort) -> Iterator[Row]:
    steps, response = 50 if effort.quick else 1000, da.final("disc3.x")
    for count in COUNTS[: 1 if effort.quick else None]:
        discs = model(Box.of(count))
        analysis = da.Nonsmooth(steps * STEP, step=STEP, outputs=2)
        warm = da.Nonsmooth(2 * STEP, step=STEP).run(discs)
        da.sensitivity(warm, response, method="adjoint")  # compiles
        row = Row(f"{count} discs in a box", f"gradient in plain runs, {steps} steps of 1 ms")
        ratios: dict[str, list[float]] = {"adjoint": [], "direct": []}
        for _ in range(min(effort.rounds, 3)):
            begin = time.perf_counter()
            motion = analysis.run(discs)
            run = time.perf_counter() - begin
            for method, chosen in (("adjoint", None), ("direct", list(PARAMETERS))):
                begin = time.perf_counter()
                da.sensitivity(motion, response, chosen, method=method)
                ratios[method].append((time.perf_counter() - begin) / run)
        row.samples["dalembert"] = Sample.of(ratios["adjoint"], "", "adjoint, 4 parameters")
        row.samples["dalembert, direct"] = Sample.of(ratios["direct"], "", "2 parameters")
        yield row


CASE = Case("discs-gradient", "gradients of discs that fall into a box", measure)
