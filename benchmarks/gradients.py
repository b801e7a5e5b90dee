"""Gradients of a closed chain of N four-bars: cost in plain runs, memory, and Exudyn's differences.

The chain of ``n_four_bar.py`` (uniform rods 1 m, 1 kg) with a torsional spring and damper at every
foot; each length, mass, moment of inertia, stiffness, damping, foot and the initial speed is a
parameter. The response is the last angle of the first crank, half a second from the start, before
all bars align. Times are processor times, medians of repetitions in turns, given in plain runs of
the same analysis: ``adjoint`` is run and gradient together, ``direct`` the gradient alone, for one
parameter and for each further one. ``once`` is what the first gradient takes longer to make its
functions, the C compiler included; C goes into an empty cache.

Growth: the same numbers depend on ten parameters, or on five hundred. Exudyn has no gradients:
central differences cost it two runs per parameter, timed for a few parameters and extrapolated
to all of them; both gradients converge to the same digits.

    pip install "dalembert[bench]"
    python benchmarks/gradients.py                    a few minutes, virtual machine
    python benchmarks/gradients.py --backend vm jit   and as machine code
    python benchmarks/gradients.py -n 3 --repeats 9   one size, quieter medians
    python benchmarks/gradients.py --memory           only the memory of a march of a million steps
                                                      through one four-bar, in its own process
"""

from __future__ import annotations

import argparse
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from statistics import median

import numpy as np

import dalembert as da
from dalembert import planar

GRAVITY, DURATION = 9.81, 0.5
STIFFNESS, DAMPING = 5.0, 0.1
ANGLE = da.final("c0.angle")
INTEGRATORS = (da.Trapezoidal(), da.GeneralizedAlpha(rho_inf=0.9))
DIFFERENCE = 1e-3
"""Relative step of the differences."""
FINE = 20_000
"""Steps of Exudyn where digits are compared."""


class Numbers:
    """The numbers of a model: each a parameter, or all depending on so many parameters."""

    def __init__(self, system: da.System, shared: int | None, total: int):
        self.system, self.total, self.made = system, total, 0
        self.shared = [system.parameter(f"s{k}", 0.0) for k in range(shared or 0)]

    def __call__(self, name: str, value: float):
        if not self.shared:
            return self.system.parameter(name, value)
        k, self.made = self.made, self.made + 1
        mine = self.shared[k :: self.total] or [self.shared[k % len(self.shared)]]
        return value + sum(mine)


def build(count: int, shared: int | None = None) -> da.Model:
    """N four-bars of dalembert."""
    system = da.System(f"{count} four-bars", gravity=(0.0, -GRAVITY))
    number = Numbers(system, shared, 3 * (2 * count + 1) + 3 * (count + 1) + 1)
    speed = number("speed", -1.0)

    def rod(name: str, **where) -> planar.Bar:
        given = {"length": 1.0, "mass": 1.0, "inertia": 1 / 12}
        given = {what: number(f"{what}_{name}", value) for what, value in given.items()}
        return system.add(planar.Bar(name, **given, **where))

    last = None
    for i in range(count + 1):
        turning = {"angular_velocity": speed} if i == 0 else {}
        crank = rod(f"c{i}", angle=math.pi / 2, position=(i, 0.5), **turning)
        foot = system.ground.point(number(f"foot_{i}", float(i)), 0.0)
        system.add(planar.Revolute(f"O{i}", foot, crank.start))
        spring = {
            "stiffness": number(f"stiffness_{i}", STIFFNESS),
            "damping": number(f"damping_{i}", DAMPING),
            "free_angle": math.pi / 2,
        }
        system.add(planar.RotationalSpring(f"S{i}", system.ground, crank, **spring))
        if last is not None:
            coupler = rod(f"b{i}", angle=0.0, position=(i - 0.5, 1.0))
            system.add(planar.Revolute(f"A{i}", last.end, coupler.start))
            system.add(planar.Revolute(f"B{i}", coupler.end, crank.end))
        last = crank
    return system.build()


def steps_for(count: int) -> int:
    return max(200, 2000 // count)


def analysis_of(steps: int, backend: str, **options) -> da.Dynamics:
    return da.Dynamics(
        DURATION, step=DURATION / steps, outputs=[DURATION], backend=backend, **options
    )


def spent(action: Callable[[], object]) -> float:
    """Processor time [s]."""
    begin = time.process_time()
    action()
    return time.process_time() - begin


def spent_by_all(action: Callable[[], object]) -> float:
    """The same with that of compilers [s]."""
    begin = os.times()[:4]
    action()
    return sum(os.times()[:4]) - sum(begin)


class Costs:
    """Costs of one analysis of one model, in its plain runs."""

    def __init__(self, model: da.Model, analysis: da.Dynamics, repeats: int):
        self.repeats, self.names = repeats, list(model.parameters)
        motion = analysis.run(model)
        self.gradient = np.zeros(0)

        def first() -> None:
            self.gradient = da.sensitivity(motion, ANGLE, method="adjoint").values[0]

        self.once = spent_by_all(first)
        actions = {
            "run": lambda: analysis.run(model),
            "adjoint": lambda: da.sensitivity(motion, ANGLE, method="adjoint"),
        }
        few = {1: self.names[:1], 11: self.names[:11]}
        for wanted, names in few.items():
            actions[f"direct {wanted}"] = lambda names=names: da.sensitivity(
                motion, ANGLE, wrt=names, method="direct"
            )
        for action in actions.values():
            action()
        found = [{name: spent(act) for name, act in actions.items()} for _ in range(repeats)]
        self.run = median(times["run"] for times in found)
        self.adjoint = 1 + median(times["adjoint"] / times["run"] for times in found)
        self.first = median(times["direct 1"] / times["run"] for times in found)
        self.further = median(
            (times["direct 11"] - times["direct 1"]) / 10 / times["run"] for times in found
        )
        self.once = max(self.once - self.run * (self.adjoint - 1), 0.0)


def gradient_costs(counts: list[int], repeats: int, backends: list[str]) -> None:
    print("gradients, in plain runs")
    print(
        f"{'N':>4} {'backend':>8} {'integrator':>18} {'parameters':>11} {'run [ms]':>9} "
        f"{'adjoint':>8} {'direct, first':>14} {'each further':>13} {'once [s]':>9}"
    )
    for count in counts:
        model = build(count)
        for backend in backends:
            for integrator in (da.RK4(), *(INTEGRATORS if count <= 10 else ())):
                analysis = analysis_of(steps_for(count), backend, integrator=integrator)
                c = Costs(model, analysis, repeats)
                print(
                    f"{count:>4} {backend:>8} {integrator.name:>18} {len(c.names):>11} "
                    f"{c.run * 1e3:>9.2f} {c.adjoint:>8.2f} {c.first:>14.2f} "
                    f"{c.further:>13.2f} {c.once:>9.2f}",
                    flush=True,
                )


def growth(counts: list[int], repeats: int, backend: str) -> None:
    print(f"\nrun and adjoint gradient when the same numbers depend on more parameters ({backend})")
    print(f"{'N':>4} {'10 [ms]':>9} {'500 [ms]':>9} {'growth':>7}")
    for count in counts:
        analysis = analysis_of(5 * steps_for(count), backend)
        models = [build(count, shared) for shared in (10, 500)]

        def both(model: da.Model, analysis: da.Dynamics = analysis) -> None:
            da.sensitivity(analysis.run(model), ANGLE, method="adjoint")

        for model in models:
            both(model)
        pairs = [[spent(lambda m=m: both(m)) for m in models] for _ in range(repeats)]
        few, many = (median(column) for column in zip(*pairs, strict=True))
        ratio = median(b / a for a, b in pairs)
        print(f"{count:>4} {few * 1e3:>9.2f} {many * 1e3:>9.2f} {ratio - 1:>7.1%}", flush=True)


def run_exudyn(count: int, steps: int, changed: dict[str, float]) -> tuple[float, float]:
    """Processor time of the solver, and the last angle of the first crank."""
    import exudyn as exu
    from exudyn import itemInterface as items

    container = exu.SystemContainer()
    system = container.AddSystem()
    ground = system.AddObject(items.ObjectGround())
    fixed = system.AddMarker(
        items.MarkerNodeCoordinate(nodeNumber=system.AddNode(items.NodePointGround()), coordinate=0)
    )

    def rod(name: str, where, speeds) -> tuple[int, int]:
        node = system.AddNode(
            items.NodeRigidBody2D(referenceCoordinates=where, initialVelocities=speeds)
        )
        given = [changed.get(f"{w}_{name}", v) for w, v in (("mass", 1.0), ("inertia", 1 / 12))]
        body = system.AddObject(
            items.ObjectRigidBody2D(mass=given[0], inertia=given[1], nodeNumber=node)
        )
        weight = system.AddMarker(items.MarkerBodyMass(bodyNumber=body))
        system.AddLoad(items.LoadMassProportional(markerNumber=weight, loadVector=[0, -GRAVITY, 0]))
        return body, node

    def pin(body_i: int, at_i, body_j: int, at_j) -> None:
        markers = [
            system.AddMarker(items.MarkerBodyPosition(bodyNumber=b, localPosition=[*a, 0.0]))
            for b, a in ((body_i, at_i), (body_j, at_j))
        ]
        system.AddObject(items.ObjectJointRevolute2D(markerNumbers=markers))

    last, first = None, None
    for i in range(count + 1):
        crank, node = rod(f"c{i}", [i, 0.5, math.pi / 2], [0.5, 0.0, -1.0])
        pin(ground, (i, 0.0), crank, (-0.5, 0.0))
        angle = system.AddMarker(items.MarkerNodeCoordinate(nodeNumber=node, coordinate=2))
        system.AddObject(
            items.ObjectConnectorCoordinateSpringDamper(
                markerNumbers=[fixed, angle],
                stiffness=changed.get(f"stiffness_{i}", STIFFNESS),
                damping=changed.get(f"damping_{i}", DAMPING),
            )
        )
        first = node if first is None else first
        if last is not None:
            coupler, _ = rod(f"b{i}", [i - 0.5, 1.0, 0.0], [1.0, 0.0, 0.0])
            pin(last, (0.5, 0.0), coupler, (-0.5, 0.0))
            pin(coupler, (0.5, 0.0), crank, (0.5, 0.0))
        last = crank
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = DURATION
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.timeIntegration.newton.relativeTolerance = 1e-10
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.solution.file.write = False
    settings.timeIntegration.verboseMode = 0
    if count >= 10:
        settings.linearSolverType = exu.LinearSolverType.EigenSparse
    elapsed = spent(lambda: system.SolveDynamic(settings))
    turned = system.GetNodeOutput(first, exu.OutputVariableType.Coordinates)[2]
    return elapsed, math.pi / 2 + turned


def differences(count: int, steps: int, model: da.Model, names: list[str]):
    """Exudyn's central differences and the time of the solver for them."""
    total, found = 0.0, []
    for name in names:
        value = model.parameters[name].value
        width = DIFFERENCE * value
        runs = [run_exudyn(count, steps, {name: value + s * width}) for s in (1, -1)]
        total += runs[0][0] + runs[1][0]
        found.append((runs[0][1] - runs[1][1]) / (2 * width))
    return total, np.array(found)


def beside_exudyn(counts: list[int], backends: list[str]) -> None:
    print("\nbeside central differences with Exudyn (implicit steps, as many as ours)")
    print(
        f"{'N':>4} {'backend':>8} {'parameters':>11} {'adjoint, run included [ms]':>27} "
        f"{'Exudyn, extrapolated [s]':>25} {'ratio':>8} {'digits':>7}"
    )
    for count in counts:
        model, steps = build(count), steps_for(count)
        names = ["mass_c0", "inertia_b1", "stiffness_1"]
        theirs, _ = differences(count, steps, model, names)
        theirs *= len(model.parameters) / len(names)
        _, fine = differences(count, FINE if count <= 10 else FINE // 10, model, names)
        for backend in backends:
            c = Costs(model, analysis_of(steps, backend), 3)
            ours = c.run * c.adjoint
            mine = c.gradient[[c.names.index(name) for name in names]]
            digits = -math.log10(np.abs(mine - fine).max() / np.abs(fine).max())
            print(
                f"{count:>4} {backend:>8} {len(c.names):>11} {ours * 1e3:>27.2f} "
                f"{theirs:>25.2f} {theirs / ours:>8.0f} {digits:>7.1f}",
                flush=True,
            )


def long_march(steps: int, memory: float) -> None:
    """One march through a four-bar and its gradient; what this process needed at most."""
    model = build(1)
    analysis = analysis_of(steps, "vm", memory=memory)
    motion = analysis.run(model)
    march = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    da.sensitivity(motion, ANGLE, method="adjoint")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{steps:>9} {memory / 2**20:>13.0f} {march:>14.0f} {peak:>19.0f}", flush=True)


def memory_needed(steps: int) -> None:
    print("resident memory of a march and its adjoint, RK4, one four-bar")
    print(
        f"{'steps':>9} {'budget [MiB]':>13} {'march [MiB]':>14} {'+ gradient [MiB]':>19}",
        flush=True,
    )
    for memory in (2.0**28, 2.0**22):
        subprocess.run([sys.executable, __file__, "--march", str(steps), str(memory)], check=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, nargs="+", default=[3, 10, 40])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--backend", nargs="+", default=["vm"], choices=["vm", "jit", "c"])
    parser.add_argument("--memory", action="store_true", help="of a long march, nothing else")
    parser.add_argument("--steps", type=int, default=1_000_000, help="of the long march")
    parser.add_argument("--march", nargs=2, type=float, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.march:
        long_march(int(options.march[0]), options.march[1])
        sys.exit()
    if options.memory:
        memory_needed(options.steps)
        sys.exit()
    with tempfile.TemporaryDirectory() as empty:
        os.environ["DALEMBERT_CACHE"] = empty
        gradient_costs(options.n, options.repeats, options.backend)
        growth(options.n, options.repeats, options.backend[0])
        beside_exudyn(options.n, options.backend)
