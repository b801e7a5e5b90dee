"""``build()`` of a thousand bodies, of which angles are given only: positions have to be found."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import numpy as np

import dalembert as da
from benchmarks.cases.base import Case, Effort
from benchmarks.sample import Row, Sample
from dalembert import planar, spatial

GRAVITY = 9.81


def four_bars(bodies: int) -> da.System:
    """Vertical cranks, 1 m apart, with couplers between their tops."""
    system = da.System("four-bars", gravity=(0.0, -GRAVITY))
    last = None
    for i in range((bodies + 1) // 2):
        crank = bar(system, f"c{i}", np.pi / 2)
        system.add(planar.Revolute(f"O{i}", system.ground.point(i, 0.0), crank.start))
        if last is not None:
            coupler = bar(system, f"b{i}", 0.0)
            system.add(planar.Revolute(f"A{i}", last.end, coupler.start))
            system.add(planar.Revolute(f"B{i}", coupler.end, crank.end))
        last = crank
    return system


def open_chain(bodies: int) -> da.System:
    """Bars of 1 m, each pinned to the end of the one before, along a bow."""
    system = da.System("chain", gravity=(0.0, -GRAVITY))
    last = system.ground.center
    for k, angle in enumerate(np.linspace(-0.5, -2.0, bodies)):
        rod = bar(system, f"b{k}", angle)
        system.add(planar.Revolute(f"R{k}", last, rod.start))
        last = rod.end
    return system


def grid(bodies: int) -> da.System:
    """A square lattice of bars pinned at its nodes, two feet on the ground."""
    system = da.System("grid", gravity=(0.0, -GRAVITY))
    rows = max(1, round((bodies / 2) ** 0.5))
    ends: dict[tuple[int, int], planar.Point] = {(0, 0): system.ground.center}

    def add(name: str, here: tuple[int, int], there: tuple[int, int], angle: float) -> None:
        rod = bar(system, name, angle)
        system.add(planar.Revolute(f"S_{name}", ends[here], rod.start))
        if there in ends:
            system.add(planar.Revolute(f"E_{name}", rod.end, ends[there]))
        else:
            ends[there] = rod.end

    for i in range(rows):
        for j in range(rows):
            add(f"h{i}_{j}", (i, j), (i + 1, j), 0.0)
            if (i, j) in ends:
                add(f"v{i}_{j}", (i, j), (i, j + 1), np.pi / 2)
    return system


def spatial_chain(bodies: int) -> da.System:
    """Links on hinges about y and z in turn; attitudes are given, places are not."""
    system = da.System("spatial chain", gravity=(0.0, 0.0, -GRAVITY))
    axes = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    last = system.ground.frame((0.0, 0.0, 0.0), axis=axes[0])
    for k in range(bodies):
        mass = system.parameter(f"m{k}", 1.0)
        body = system.add(
            spatial.Body(
                f"b{k}", mass=mass, inertia=(0.01, 0.02, 0.015), rotation=da.rotation.identity()
            )
        )
        here = body.frame((-0.5, 0.0, 0.0), axis=axes[k % 2])
        system.add(spatial.Revolute(f"J{k}", last, here))
        last = body.frame((0.5, 0.0, 0.0), axis=axes[(k + 1) % 2])
    return system


def bar(system: da.System, name: str, angle: float) -> planar.Bar:
    length, mass = system.parameter(f"l_{name}", 1.0), system.parameter(f"m_{name}", 1.0)
    return system.add(planar.Bar(name, length=length, mass=mass, angle=float(angle)))


FAMILIES: dict[str, Callable[[int], da.System]] = {
    "chain of four-bars": four_bars,
    "open chain": open_chain,
    "grid of bars": grid,
    "spatial chain": spatial_chain,
}


def seconds(make: Callable[[int], da.System], bodies: int, rounds: int) -> list[float]:
    """Processor times of ``build()``."""
    spent = []
    for _ in range(rounds):
        system = make(bodies)
        begin = time.process_time()
        system.build()
        spent.append(time.process_time() - begin)
    return spent


def measure(effort: Effort) -> Iterator[Row]:
    most = 20 if effort.quick else min(1000, effort.sizes)
    for name, make in FAMILIES.items():
        few, many = (seconds(make, n, min(effort.rounds, 3)) for n in (most // 4, most))
        growth = np.log(np.median(many) / np.median(few)) / np.log(4)
        note = f"grows with exponent {growth:.2f}"
        samples = {"dalembert": Sample.of(many, "s", note)}
        yield Row(name, f"build of {most} bodies, angles given", samples)


CASE = Case("build", "of a thousand bodies", measure)
