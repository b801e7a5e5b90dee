"""Discs, spheres and boxes that fall into a box with friction: time of a step and penetration.

Contacts of the peers are compliant. MuJoCo is therefore compared twice: with equal steps of 1 ms,
and with steps so short that its penetration is ours, at least 1e-9 of the size of a body.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise

import numpy as np

import dalembert as da
from benchmarks.cases.base import Case, Effort
from benchmarks.falling_bodies import SIZE, STEP, FallingBodies
from benchmarks.sample import Row, Sample
from benchmarks.solvers.base import installed
from benchmarks.solvers.falling.base import Run
from benchmarks.solvers.falling.exudyn import exudyn
from benchmarks.solvers.falling.mujoco import at_penetration, mujoco
from benchmarks.solvers.falling.ours import ours

COUNTS = (10, 30, 100, 300, 1000, 3000, 10_000)
STEPS, QUICK = 1000, 50
EQUAL = 100
"""Maximum number of bodies of the comparison at equal penetration."""
LONGEST = 15
"""Maximum time of a run over ``limit``; longer ones are left out."""
PLURAL = {"disc": "discs", "sphere": "spheres", "box": "boxes"}


def solvers(kind: str) -> dict[str, Callable[[FallingBodies], Run]]:
    """Names → solvers that have the shape."""
    names: dict[str, Callable[[FallingBodies], Run]] = {
        "dalembert": partial(ours, scheme=da.AnticipatedImpacts()),
        "dalembert, MoreauJean": partial(ours, scheme=da.MoreauJean()),
    }
    if installed("mujoco"):
        names["MuJoCo"] = mujoco
    if installed("exudyn") and kind != "box":
        names["Exudyn"] = exudyn
    return names


def measure(kind: str, effort: Effort) -> Iterator[Row]:
    counts = [n for n in COUNTS if n <= (30 if effort.quick else effort.sizes)]
    steps, first, last = QUICK if effort.quick else STEPS, dict[str, float](), dict[str, float]()
    for before, count in pairwise([0, *counts]):
        bodies = FallingBodies.of(kind, count)
        name = f"{count} {PLURAL[kind]} in a box"
        row = Row(name, f"time of a step, {steps} steps of 1 ms")
        rounds = range(min(effort.rounds, 3) if count < 1000 else 1)
        runs = {
            solver: make(bodies)
            for solver, make in solvers(kind).items()
            if last.get(solver, 0.0) * steps * count / max(before, 1) < LONGEST * effort.limit
        }
        measured = {solver: [run(steps) for _ in rounds] for solver, run in runs.items()}
        for solver, values in measured.items():
            seconds = [value[0] for value in values]
            note = f"penetration {values[0][1]:.1g} m"
            least, last[solver] = first.setdefault(solver, min(seconds)), min(seconds)
            if count > counts[0]:
                growth = np.log(min(seconds) / least) / np.log(count / counts[0])
                note += f", grows with exponent {growth:.2f}"
            row.samples[solver] = Sample.of(seconds, "s", note)
        yield row
        if {"dalembert", "MuJoCo"} <= set(runs) and count <= EQUAL:
            yield equal_penetration(name, bodies, steps, measured["dalembert"], effort.limit)


def equal_penetration(
    name: str, bodies: FallingBodies, steps: int, values: list[tuple[float, float]], limit: float
) -> Row:
    """Time of the motion with the penetration of dalembert, or the smallest within the limit."""
    duration, deepest = steps * STEP, max(value[1] for value in values)
    target = max(deepest, 1e-9 * SIZE)
    row = Row(name, f"{duration:g} s of motion, penetration {target:.1g} m")
    row.samples["dalembert"] = Sample.of([steps * value[0] for value in values], "s")
    seconds, reached, step = at_penetration(bodies, duration, target, limit)
    note = f"steps of {step:.1g} s" + ("" if reached <= target else f", only {reached:.1g} m")
    row.samples["MuJoCo"] = Sample.of([seconds], "s", note)
    return row


CASES = [
    Case(PLURAL[kind], f"{PLURAL[kind]} that fall into a box with friction", partial(measure, kind))
    for kind in PLURAL
]
