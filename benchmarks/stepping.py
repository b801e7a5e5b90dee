"""Single steps of a cart and pole in a Python loop, and 4,096 of them side by side, beside MuJoCo.

Both take RK4 steps of 10 ms of the same mechanism under the same forces, which agree to 1e-10. The
loop sets the force and takes one step at a time. The lanes take steps with a force each; MuJoCo's
``rollout`` runs in as many threads. A value above 1 in the last column: dalembert is faster.

    python -m benchmarks.stepping
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable

import numpy as np

import dalembert as da
from dalembert import planar

LOOP, LANES, HORIZON, STEP = 20_000, 4096, 100, 0.01
MODEL = """
<mujoco><option timestep="0.01" integrator="RK4" gravity="0 0 -9.81">
<flag contact="disable" constraint="disable"/></option>
<worldbody><body name="cart"><joint name="rail" type="slide" axis="1 0 0"/>
<inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>
<body name="pole"><joint name="hinge" type="hinge" axis="0 -1 0"/>
<inertial mass="0.1" pos="0 0 0.5" diaginertia="1 0.00833333333333333 1"/>
</body></body></worldbody>
<actuator><motor joint="rail"/></actuator></mujoco>
"""
"""The pole stands where its coordinate is zero."""


def cart_pole() -> da.Model:
    system = da.System("cart-pole", gravity=(0, -9.81))
    tilt = system.parameter("tilt", np.pi / 2 + 0.1, "rad")
    cart = system.add(planar.Body("cart", mass=1.0, inertia=1.0))
    system.add(planar.Prismatic("rail", system.ground.center, cart.center))
    pole = system.add(planar.Bar("pole", length=1.0, mass=0.1, angle=tilt))
    system.add(planar.Revolute("hinge", cart.center, pole.start))
    push = system.input("push", unit="N")
    system.add(planar.Force("drive", cart.center, (push, 0)))
    for name in ("cart.x", "pole.angle", "cart.vx", "pole.angular_velocity"):
        system.output(name.replace(".", "_"), name)
    return system.build()


def fastest(run: Callable[[], object], repeats: int) -> float:
    """Shortest time of several [s]."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        run()
        times.append(time.perf_counter() - begin)
    return min(times)


def loops(repeats: int) -> None:
    """Steps in a Python loop."""
    import mujoco

    stepper = da.Stepper(cart_pole(), step=STEP)
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)

    def ours() -> np.ndarray:
        y, step = stepper.reset(), stepper.step
        for _ in range(LOOP):
            y = step(0.5)
        return y

    def theirs() -> np.ndarray:
        mujoco.mj_resetData(model, data)
        data.qpos[1] = 0.1
        control, step = data.ctrl, mujoco.mj_step
        for _ in range(LOOP):
            control[0] = 0.5
            step(model, data)
        return np.append(data.qpos, data.qvel)

    stepper.reset(initial={"rail.displacement": 0.0})
    mujoco.mj_resetData(model, data)
    data.qpos[1], data.ctrl[0] = 0.1, 0.5
    for _ in range(100):
        y = stepper.step(0.5)
        mujoco.mj_step(model, data)
    difference = np.abs(y - np.append(data.qpos, data.qvel) - [0, np.pi / 2, 0, 0]).max()
    print(f"difference after 100 steps: {difference:.1e}")
    one, other = (1e6 * fastest(run, repeats) / LOOP for run in (ours, theirs))
    print(f"{'one step in a loop [us]':<58}{one:>8.2f}{other:>8.2f}{other / one:>7.1f}")


def lanes(repeats: int, workers: int) -> None:
    """Steps of many lanes, millions per second."""
    import mujoco
    from mujoco import rollout

    rng = np.random.default_rng(0)
    forces = rng.uniform(-5, 5, (HORIZON, LANES, 1))
    many = da.Stepper(cart_pole(), step=STEP).lanes(LANES, workers=workers)
    long = da.Stepper(cart_pole(), step=10 * STEP, substeps=10).lanes(LANES, workers=workers)
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = [mujoco.MjData(model) for _ in range(workers)]
    start = np.zeros((LANES, mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)))
    start[:, 2] = 0.1  # after the time
    control = np.ascontiguousarray(forces.transpose(1, 0, 2))
    steps = LANES * HORIZON / 1e6
    with rollout.Rollout(nthread=workers) as pool:
        theirs = steps / fastest(lambda: pool.rollout(model, data, start, control), repeats)
    rows = {
        "rollout of 100 steps [1e6/s]": lambda: many.rollout(forces),
        "step by step [1e6/s]": lambda: [many.step(force) for force in forces],
        "10 substeps per step [1e6/s]": lambda: [long.step(force) for force in forces[:10]],
    }
    for name, run in rows.items():
        ours = steps / fastest(run, repeats)
        text = f"{LANES} lanes, {workers} threads, {name}"
        print(f"{text:<58}{ours:>8.1f}{theirs:>8.2f}{ours / theirs:>7.0f}")


def main(repeats: int) -> None:
    print(f"{'':<58}{'ours':>8}{'MuJoCo':>8}{'ratio':>7}")
    loops(repeats)
    for workers in sorted({1, os.cpu_count() or 1}):
        lanes(repeats, workers)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=9)
    main(parser.parse_args().repeats)
