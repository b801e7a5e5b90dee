"""dalembert, on every backend there is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

import dalembert as da
from benchmarks.mechanism import GROUND, Joint, Mechanism
from benchmarks.solvers.base import Contestant, Run
from dalembert import planar, spatial
from dalembert.symbolic.evaluation.backends import BACKENDS
from dalembert.symbolic.native.c_compiler import find_compiler

COMPILABLE = 100
"""Bodies up to which a C compiler is done in a minute."""
NAMES = {"vm": "dalembert", "jit": "dalembert, jit", "c": "dalembert, C"}


def fastest() -> list[str]:
    """The virtual machine, and a compiled backend where there is one."""
    fast = "jit" if "jit" in BACKENDS else "c"
    return ["vm", fast] if fast == "jit" or find_compiler() else ["vm"]


def build(mechanism: Mechanism) -> da.Model:
    """The model; every mass is a parameter."""
    return (_planar if mechanism.planar else _spatial)(mechanism).build()


def _planar(mechanism: Mechanism) -> da.System:
    system = da.System(mechanism.name, gravity=tuple(map(float, mechanism.gravity[:2])))
    made = []
    for k, body in enumerate(mechanism.bodies):
        angle = float(np.arctan2(body.rotation[1, 0], body.rotation[0, 0]))
        made.append(
            system.add(
                planar.Body(
                    f"b{k}",
                    mass=system.parameter(f"m{k}", body.mass),
                    inertia=float(body.inertia[2]),
                    position=tuple(map(float, body.position[:2])),
                    angle=angle,
                    velocity=tuple(map(float, body.velocity[:2])),
                    angular_velocity=float(body.spin[2]),
                    points=_points(mechanism, k),
                )
            )
        )
    for k, joint in enumerate(mechanism.joints):
        points = [
            (system.ground if n == GROUND else made[n]).point(
                *mechanism.body(n).local(joint.place)[:2]
            )
            for n in (joint.first, joint.second)
        ]
        system.add(planar.Revolute(f"j{k}", *points))
    return system


def _spatial(mechanism: Mechanism) -> da.System:
    system = da.System(mechanism.name, gravity=tuple(map(float, mechanism.gravity)))
    made = []
    for k, body in enumerate(mechanism.bodies):
        made.append(
            system.add(
                spatial.Body(
                    f"b{k}",
                    mass=system.parameter(f"m{k}", body.mass),
                    inertia=tuple(map(float, body.inertia)),
                    position=tuple(map(float, body.position)),
                    rotation=body.rotation.tolist(),
                    velocity=tuple(map(float, body.velocity)),
                    angular_velocity=tuple(map(float, body.spin)),
                    points=_points(mechanism, k),
                )
            )
        )
    for k, joint in enumerate(mechanism.joints):
        sides = [
            (system.ground if n == GROUND else made[n], mechanism.body(n))
            for n in (joint.first, joint.second)
        ]
        system.add(_joint(f"j{k}", joint, sides))
    return system


def _joint(name: str, joint: Joint, sides) -> object:
    places = [body.local(joint.place) for _, body in sides]
    if joint.kind == "spherical":
        points = [
            part.point(*map(float, place)) for (part, _), place in zip(sides, places, strict=True)
        ]
        return spatial.Spherical(name, *points)
    columns = (0, 1) if joint.kind == "universal" else (2, 2)
    frames = []
    for (part, body), place, column in zip(sides, places, columns, strict=True):
        axis = body.rotation.T @ joint.axes[:, column]
        frames.append(part.frame(tuple(map(float, place)), axis=tuple(map(float, axis))))
    kinds = {
        "revolute": spatial.Revolute,
        "universal": spatial.Universal,
        "prismatic": spatial.Prismatic,
    }
    return kinds[joint.kind](name, *frames)


def _points(mechanism: Mechanism, number: int) -> dict[str, tuple[float, ...]]:
    """The observed point, if it is of this body."""
    body, place = mechanism.observed
    local = mechanism.bodies[body].local(place)[: 2 if mechanism.planar else 3]
    return {"seen": tuple(map(float, local))} if body == number else {}


def place_of(mechanism: Mechanism, motion: da.Motion) -> np.ndarray:
    """The observed point at the end."""
    found = motion.values(f"b{mechanism.observed[0]}.seen.position")
    return np.append(found.ravel(), [0.0] * mechanism.planar)


def runner(mechanism: Mechanism, duration: float, backend: str, **options) -> Run:
    model = build(mechanism)

    def run(steps: int) -> tuple[float, np.ndarray]:
        motion = da.solve_dynamics(
            model, duration, step=duration / steps, outputs=[duration], backend=backend, **options
        )
        return motion.statistics["integration time [s]"], place_of(mechanism, motion)

    return run


def contestants(
    mechanism: Mechanism, duration: float, first: int, backends: Sequence[str] = ("vm",)
) -> list[Contestant]:
    """RK4 with projection in absolute coordinates; of trees in joint coordinates."""
    options = {"coordinates": da.JointCoordinates()} if mechanism.tree else {}
    chosen = [b for b in backends if b != "c" or len(mechanism.bodies) <= COMPILABLE]
    return [Contestant(NAMES[b], runner(mechanism, duration, b, **options), first) for b in chosen]


def reference(mechanism: Mechanism, duration: float) -> np.ndarray:
    """The observed point by the method of order 8 with tight tolerances."""
    motion = da.solve_dynamics(
        build(mechanism),
        duration,
        outputs=[duration],
        integrator=da.DormandPrince853(rtol=1e-12, atol=1e-13),
        coordinates=da.JointCoordinates() if mechanism.tree else da.AbsoluteCoordinates(),
    )
    return place_of(mechanism, motion)
