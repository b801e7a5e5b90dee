"""Discs that fall into a box with friction: time of a step and penetration.

MuJoCo's contacts are soft: the discs penetrate, and the box has spheres in a plane.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

import dalembert as da
from benchmarks.cases.base import Case, Effort
from benchmarks.sample import Row, Sample
from benchmarks.solvers.base import installed
from dalembert import planar

RADIUS, MASS, FRICTION, GRAVITY = 0.1, 10.0, 0.3, 9.81
STEP = 1e-3
COUNTS = (10, 30, 100, 300, 1000, 3000, 10_000)


@dataclass(frozen=True, eq=False)
class Box:
    """Start of the discs, in rows above the floor of a box.

    Attributes
    ----------
    width : of the box [m]
    positions, velocities : (n, 2)
    """

    width: float
    positions: np.ndarray
    velocities: np.ndarray

    @classmethod
    def of(cls, count: int) -> Box:
        """As many rows as columns."""
        rng = np.random.default_rng(1)
        columns = max(2, int(np.ceil(np.sqrt(count))))
        width = 2.4 * RADIUS * columns
        row, column = np.divmod(np.arange(count), columns)
        x = (column + 0.5) / columns * width - width / 2 + 0.1 * RADIUS * rng.random(count)
        y = RADIUS * (1.05 + 2.1 * row)
        return cls(width, np.column_stack([x, y]), 0.3 * rng.normal(size=(count, 2)))


def model(box: Box) -> da.Model:
    """The discs and the box."""
    system = da.System("discs", gravity=(0.0, -GRAVITY))
    shapes: list[planar.contact.Shape] = []
    for k, (position, velocity) in enumerate(zip(box.positions, box.velocities, strict=True)):
        disc = planar.Body(
            f"disc{k}",
            mass=MASS,
            inertia=MASS * RADIUS**2 / 2,
            position=tuple(position),
            angle=0.0,
            velocity=tuple(velocity),
        )
        shapes.append(planar.contact.Circle(system.add(disc), RADIUS))
    left, right = (system.ground.point(x, 0.0) for x in (-box.width / 2, box.width / 2))
    for point, normal in ((left, (0.0, 1.0)), (left, (1.0, 0.0)), (right, (-1.0, 0.0))):
        shapes.append(planar.contact.HalfPlane(point, normal))
    system.add(planar.Collisions("contacts", shapes, friction=FRICTION))
    return system.build()


Run = Callable[[int], tuple[float, float]]
"""Steps → seconds of a step, and the maximum penetration [m]."""


def ours(box: Box, scheme: da.AnticipatedImpacts | da.MoreauJean) -> Run:
    """Steps of dalembert, built and compiled before."""
    discs = model(box)
    da.solve_nonsmooth(discs, 2 * STEP, step=STEP, integrator=scheme)

    def run(steps: int) -> tuple[float, float]:
        motion = da.solve_nonsmooth(discs, steps * STEP, step=STEP, integrator=scheme, outputs=11)
        seconds = motion.statistics["integration time [s]"] / steps
        return seconds, motion.statistics["maximum penetration [m]"]

    return run


def mujoco(box: Box) -> Run:
    """Steps of MuJoCo with its default solver."""
    import mujoco

    contact = f'friction="{FRICTION} 0 0" condim="3"'
    half = box.width / 2
    walls = ((0.0, "0 0 1"), (-half, "1 0 0"), (half, "-1 0 0"))
    planes = "".join(
        f'<geom type="plane" size="0 0 1" pos="{x} 0 0" zaxis="{axis}" {contact}/>'
        for x, axis in walls
    )
    joints = "".join(
        f'<joint type="{kind}" axis="{axis}"/>'
        for kind, axis in (("slide", "1 0 0"), ("slide", "0 0 1"), ("hinge", "0 1 0"))
    )
    bodies = "".join(
        f'<body pos="{x} 0 {z}">{joints}<geom type="sphere" size="{RADIUS}" mass="{MASS}" '
        f"{contact}/></body>"
        for x, z in box.positions
    )
    text = (
        f'<mujoco><option timestep="{STEP}" gravity="0 0 -{GRAVITY}"/><size memory="4G"/>'
        f"<worldbody>{planes}{bodies}</worldbody></mujoco>"
    )
    discs = mujoco.MjModel.from_xml_string(text)

    def run(steps: int) -> tuple[float, float]:
        state, deepest, seconds = mujoco.MjData(discs), 0.0, 0.0
        state.qvel.reshape(-1, 3)[:, :2] = box.velocities
        for _ in range(10):
            begin = time.perf_counter()
            mujoco.mj_step(discs, state, max(1, steps // 10))
            seconds += time.perf_counter() - begin
            deepest = min([deepest, *(c.dist for c in state.contact[: state.ncon])])
        return seconds / (10 * max(1, steps // 10)), abs(deepest)

    return run


def measure(effort: Effort) -> Iterator[Row]:
    counts = [n for n in COUNTS if n <= (30 if effort.quick else effort.sizes)]
    steps, first = 20 if effort.quick else 1000, dict[str, float]()
    for count in counts:
        box = Box.of(count)
        row = Row(f"{count} discs in a box", f"time of a step, {steps} steps of 1 ms")
        runs = {
            "dalembert": ours(box, da.AnticipatedImpacts()),
            "dalembert, MoreauJean": ours(box, da.MoreauJean()),
        }
        if installed("mujoco"):
            runs["MuJoCo"] = mujoco(box)
        rounds = range(min(effort.rounds, 3) if count < 1000 else 1)
        measured = {name: [run(steps) for _ in rounds] for name, run in runs.items()}
        for name, values in measured.items():
            seconds = [value[0] for value in values]
            note = f"penetration {values[0][1]:.1g} m"
            least = first.setdefault(name, min(seconds))
            if count > counts[0]:
                growth = np.log(min(seconds) / least) / np.log(count / counts[0])
                note += f", grows with exponent {growth:.2f}"
            row.samples[name] = Sample.of(seconds, "s", note)
        yield row


CASE = Case("discs", "that fall into a box with friction", measure)
