"""MuJoCo: compliant contacts, so that bodies penetrate; a plane of spheres in place of discs."""

from __future__ import annotations

import time

import numpy as np

from benchmarks.falling_bodies import FRICTION, GRAVITY, MASS, SIZE, STEP, FallingBodies
from benchmarks.solvers.falling.base import Run


def mujoco(bodies: FallingBodies, step: float = STEP, stiff: bool = False) -> Run:
    """Steps of MuJoCo with its default solver, with its stiffest contacts if ``stiff``.

    Penetration is that of all steps, from a second run.
    """
    import mujoco

    model = mujoco.MjModel.from_xml_string(_mjcf(bodies, step, stiff))

    def start() -> mujoco.MjData:
        state = mujoco.MjData(model)
        columns = slice(0, bodies.dimension)
        state.qvel.reshape(bodies.count, -1)[:, columns] = bodies.velocities
        return state

    def run(steps: int) -> tuple[float, float]:
        state = start()
        begin = time.perf_counter()
        mujoco.mj_step(model, state, steps)
        seconds = (time.perf_counter() - begin) / steps
        state, deepest = start(), 0.0
        for _ in range(steps):
            mujoco.mj_step(model, state)
            deepest = min(deepest, state.contact.dist[: state.ncon].min(initial=0.0))
        return seconds, abs(float(deepest))

    return run


def _mjcf(bodies: FallingBodies, step: float, stiff: bool) -> str:
    """The model in MuJoCo's format; the plane of discs is x-z."""
    flat = bodies.dimension == 2
    contact = f'friction="{FRICTION} 0 0" condim="3"'
    contact += f' solref="{2 * step} 1"' if stiff else ""

    def triple(vector: np.ndarray) -> str:
        values = (vector[0], 0.0, vector[1]) if flat else vector
        return " ".join(repr(float(v)) for v in values)

    planes = "".join(
        f'<geom type="plane" size="0 0 1" pos="{triple(p)}" zaxis="{triple(n)}" {contact}/>'
        for p, n in bodies.walls()
    )
    axes = ("slide", "1 0 0"), ("slide", "0 0 1"), ("hinge", "0 1 0")
    joints = "".join(f'<joint type="{kind}" axis="{axis}"/>' for kind, axis in axes)
    size = f'type="box" size="{SIZE} {SIZE} {SIZE}"'
    size = size if bodies.kind == "box" else f'type="sphere" size="{SIZE}"'
    parts = "".join(
        f'<body pos="{triple(place)}">{joints if flat else "<freejoint/>"}'
        f'<geom {size} mass="{MASS}" {contact}/></body>'
        for place in bodies.positions
    )
    return (
        f'<mujoco><option timestep="{step}" gravity="0 0 -{GRAVITY}"/><size memory="4G"/>'
        f"<worldbody>{planes}{parts}</worldbody></mujoco>"
    )


def at_penetration(
    bodies: FallingBodies, duration: float, target: float, limit: float
) -> tuple[float, float, float]:
    """Seconds of a run, its penetration and its step, halved until the penetration is the target.

    Contacts are the stiffest for the step, with a time constant of two steps. The search ends when
    the next run would take longer than the limit in seconds.
    """
    step = STEP
    while True:
        steps = round(duration / step)
        each, deepest = mujoco(bodies, step, stiff=True)(steps)
        if deepest <= target or 2 * each * steps > limit:
            return each * steps, deepest, step
        step /= 2
