"""Time per step on a closed chain of N four-bars: dalembert, interpreted and compiled, and Exudyn.

Both solve the same mechanism (N + 1 vertical cranks, N couplers, uniform rods 1 m, 1 kg, g = 9.81)
in absolute coordinates, in one process, in turns. dalembert: RK4 (four accelerations a step) with
range-space elimination. Exudyn: its implicit generalized-α step, sparse solver from N = 10 on.
dalembert compiles into an empty cache; ``prepared`` is the first run's preparation with projection,
compiling included, and no part of the times per step; ``warm`` is the same with a full cache. The
second table asks for time to the same error of the position of the first crank's top after one
second, against the exact one-equation reduction.

    pip install "dalembert[bench]" && python benchmarks/n_four_bar.py
"""

from __future__ import annotations

import argparse
import math
import os
import tempfile
import time
from functools import partial

import numpy as np
from scipy.integrate import solve_ivp

import dalembert as da
from dalembert import planar

GRAVITY = 9.81
DURATION = 1.0
ERROR = 1e-6


def build(count: int) -> da.Model:
    """N four-bars of dalembert, every length and mass a parameter."""
    system = da.System(f"{count} four-bars", gravity=(0.0, -GRAVITY))

    def rod(name: str, **where) -> planar.Bar:
        length = system.parameter(f"l_{name}", 1.0)
        mass = system.parameter(f"m_{name}", 1.0)
        return system.add(planar.Bar(name, length=length, mass=mass, **where))

    last = None
    for i in range(count + 1):
        crank = rod(f"c{i}", angle=math.pi / 2, position=(i, 0.5), angular_velocity=-1.0)
        system.add(planar.Revolute(f"O{i}", system.ground.point(i, 0.0), crank.start))
        if last is not None:
            coupler = rod(f"b{i}", angle=0.0, position=(i - 0.5, 1.0))
            system.add(planar.Revolute(f"A{i}", last.end, coupler.start))
            system.add(planar.Revolute(f"B{i}", coupler.end, crank.end))
        last = crank
    return system.build()


def exact(count: int, end: float) -> np.ndarray:
    """Top of the first crank by ``[(N+1)/3 + N] φ̈ = −[(N+1)/2 + N] g cos φ``."""
    ratio = ((count + 1) / 2 + count) / ((count + 1) / 3 + count)
    done = solve_ivp(
        lambda t, s: [s[1], -ratio * GRAVITY * math.cos(s[0])],
        (0, end),
        [math.pi / 2, -1.0],
        method="DOP853",
        rtol=1e-13,
        atol=1e-14,
    )
    return np.array([math.cos(done.y[0, -1]), math.sin(done.y[0, -1])])


def run_ours(
    model: da.Model, steps: int, stabilization, backend: str = "vm"
) -> tuple[float, np.ndarray]:
    """Seconds for the integration alone, and the top of the first crank."""
    motion = motion_of(model, steps, stabilization, backend)
    return motion.statistics["integration time [s]"], motion.values("c0.end.position").ravel()


def motion_of(model: da.Model, steps: int, stabilization, backend: str) -> da.Motion:
    return da.solve_dynamics(
        model,
        DURATION,
        step=DURATION / steps,
        outputs=[DURATION],
        stabilization=stabilization,
        backend=backend,
    )


def run_exudyn(count: int, steps: int) -> tuple[float, np.ndarray]:
    """The same mechanism in Exudyn; seconds for the solver alone."""
    import exudyn as exu
    from exudyn.itemInterface import (
        LoadMassProportional,
        MarkerBodyMass,
        MarkerBodyPosition,
        NodeRigidBody2D,
        ObjectGround,
        ObjectJointRevolute2D,
        ObjectRigidBody2D,
    )

    container = exu.SystemContainer()
    system = container.AddSystem()
    ground = system.AddObject(ObjectGround())

    def rod(x: float, y: float, angle: float, speeds) -> int:
        node = system.AddNode(
            NodeRigidBody2D(referenceCoordinates=[x, y, angle], initialVelocities=speeds)
        )
        body = system.AddObject(ObjectRigidBody2D(mass=1.0, inertia=1 / 12, nodeNumber=node))
        weight = system.AddMarker(MarkerBodyMass(bodyNumber=body))
        system.AddLoad(LoadMassProportional(markerNumber=weight, loadVector=[0, -GRAVITY, 0]))
        return body

    def pin(body_i: int, at_i, body_j: int, at_j) -> None:
        markers = [
            system.AddMarker(MarkerBodyPosition(bodyNumber=b, localPosition=[*a, 0.0]))
            for b, a in ((body_i, at_i), (body_j, at_j))
        ]
        system.AddObject(ObjectJointRevolute2D(markerNumbers=markers))

    last = None
    first = None
    for i in range(count + 1):
        crank = rod(i, 0.5, math.pi / 2, [0.5, 0.0, -1.0])
        pin(ground, (i, 0.0), crank, (-0.5, 0.0))
        first = crank if first is None else first
        if last is not None:
            coupler = rod(i - 0.5, 1.0, 0.0, [1.0, 0.0, 0.0])
            pin(last, (0.5, 0.0), coupler, (-0.5, 0.0))
            pin(coupler, (0.5, 0.0), crank, (0.5, 0.0))
        last = crank
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = DURATION
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.solution.file.write = False
    settings.timeIntegration.verboseMode = 0
    if count >= 10:
        settings.linearSolverType = exu.LinearSolverType.EigenSparse
    begin = time.perf_counter()
    system.SolveDynamic(settings)
    elapsed = time.perf_counter() - begin
    top = system.GetObjectOutputBody(
        first, exu.OutputVariableType.Position, localPosition=[0.5, 0.0, 0.0]
    )
    return elapsed, np.array(top[:2])


def time_per_step(counts: list[int], repeats: int, backends: list[str]) -> None:
    print("time per step, best of several in turns")
    print(
        f"{'N':>4} {'bodies':>7} {'backend':>8} {'prepared [s]':>13} {'warm [s]':>9} "
        f"{'RK4 [µs]':>10} {'+ projection':>13} {'Exudyn [µs]':>12} {'ratio':>7} {'with proj.':>11}"
    )
    for count in counts:
        model = build(count)
        steps = max(200, 4000 // count)
        none, projection, theirs = da.Stabilization(), da.Projection(), math.inf
        cold = {
            b: motion_of(model, steps, projection, b).statistics["preparation time [s]"]
            for b in backends
        }
        again = build(count)
        warm = {
            b: motion_of(again, steps, projection, b).statistics["preparation time [s]"]
            for b in backends
        }
        plain, projected = dict.fromkeys(backends, math.inf), dict.fromkeys(backends, math.inf)
        for _ in range(repeats):
            for b in backends:
                plain[b] = min(plain[b], run_ours(model, steps, none, b)[0] / steps)
                projected[b] = min(projected[b], run_ours(model, steps, projection, b)[0] / steps)
            theirs = min(theirs, run_exudyn(count, steps)[0] / steps)
        for b in backends:
            print(
                f"{count:>4} {2 * count + 1:>7} {b:>8} {cold[b]:>13.2f} {warm[b]:>9.2f} "
                f"{plain[b] * 1e6:>10.2f} "
                f"{projected[b] * 1e6:>13.2f} {theirs * 1e6:>12.2f} {theirs / plain[b]:>7.2f} "
                f"{theirs / projected[b]:>11.2f}",
                flush=True,
            )


def steps_needed(run, reference: np.ndarray, steps: int) -> tuple[float, int]:
    """Double the steps until the error is small enough; the time and the steps of that run."""
    while True:
        elapsed, top = run(steps)
        if np.abs(top - reference).max() <= ERROR or steps > 200_000:
            return min(elapsed, run(steps)[0]), steps
        steps *= 2


def time_to_error(counts: list[int], backend: str) -> None:
    print(
        f"\ntime to an error of at most {ERROR:g} m in the first crank's top after 1 s "
        f"(ours: {backend})"
    )
    print(f"{'N':>4} {'ours [ms]':>10} {'steps':>7} {'Exudyn [ms]':>12} {'steps':>7} {'ratio':>7}")
    for count in counts:
        model, reference = build(count), exact(count, DURATION)
        ours, n_ours = steps_needed(
            partial(run_ours, model, stabilization=da.Projection(), backend=backend),
            reference,
            10,
        )
        theirs, n_theirs = steps_needed(partial(run_exudyn, count), reference, 500)
        print(
            f"{count:>4} {ours * 1e3:>10.3f} {n_ours:>7} {theirs * 1e3:>12.2f} {n_theirs:>7} "
            f"{theirs / ours:>7.1f}"
        )


def gradient_cost(counts: list[int], repeats: int, backend: str) -> None:
    print(
        f"\nwhole adjoint gradient (run included) over the run, RK4 + range space + projection "
        f"({backend})"
    )
    print(f"{'N':>4} {'parameters':>11} {'run [ms]':>9} {'run + gradient [ms]':>20} {'ratio':>6}")
    for count in counts:
        model, steps = build(count), max(200, 4000 // count)
        analysis = da.Dynamics(duration=DURATION, step=DURATION / steps, backend=backend)
        angle = da.final("c0.angle")
        da.sensitivity(analysis.run(model), angle, method="adjoint")  # compiles
        run = both = math.inf
        for _ in range(repeats):
            begin = time.perf_counter()
            motion = analysis.run(model)
            middle = time.perf_counter()
            da.sensitivity(motion, angle, method="adjoint")
            end = time.perf_counter()
            run, both = min(run, middle - begin), min(both, end - begin)
        print(
            f"{count:>4} {model.nominal.size:>11} {run * 1e3:>9.2f} {both * 1e3:>20.2f} "
            f"{both / run:>6.2f}"
        )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, nargs="+", default=[1, 3, 10, 40])
    parser.add_argument("--repeats", type=int, default=7)
    parser.add_argument(
        "--backend", nargs="+", default=["vm", "jit", "c"], choices=["vm", "jit", "c"]
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as empty:
        os.environ["DALEMBERT_CACHE"] = empty
        time_per_step(options.n, options.repeats, options.backend)
        for backend in options.backend:
            time_to_error(options.n, backend)
            gradient_cost(options.n, options.repeats, backend)
