"""Open chain of N pendulums in joint coordinates: dalembert beside Exudyn and Pinocchio.

N uniform rods of length 1/N m and mass 1/N kg, each pinned to the end of the one before, g = 9.81,
released from a bent position. First table: one acceleration, i.e. q̈ for given (q, q̇). Every
parameter of dalembert is a run-time input of its graph on the VM; Pinocchio's articulated-body
algorithm (``pinocchio.aba``, C++, the same chain as 3-D revolute joints about z) is called in a
Python loop, its call included. Second table: one step of a whole run. dalembert: RK4, no
stabilisation (four accelerations), on the VM and compiled to C. Exudyn: kinematic tree with its
explicit RK44 (four accelerations of a 3-D tree), and redundant coordinates with its implicit
generalized-α step (sparse solver, modified Newton). All in one process, in turns, best of several;
all reach the same tip position, which is printed.

    pip install "dalembert[bench]" && python benchmarks/open_chain.py
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable

import casadi as ca
import numpy as np

import dalembert as da
from dalembert import planar

GRAVITY = 9.81
STEP = 1e-4
COORDINATES = {
    "joint, relative": da.JointCoordinates(),
    "joint, absolute": da.JointCoordinates(angles="absolute"),
    "absolute": da.AbsoluteCoordinates(),
}


def bend(count: int) -> np.ndarray:
    """Initial relative angles."""
    return np.concatenate([[-0.5], np.full(count - 1, -1.5 / count)])


def build(count: int) -> da.Model:
    """The chain of dalembert, every length and mass a parameter."""
    system = da.System(f"chain of {count}", gravity=(0.0, -GRAVITY))
    last, corner = system.ground.center, np.zeros(2)
    for k, angle in enumerate(np.cumsum(bend(count))):
        along = np.array([math.cos(angle), math.sin(angle)]) / count
        rod = system.add(
            planar.Bar(
                f"b{k}",
                length=system.parameter(f"l{k}", 1 / count),
                mass=system.parameter(f"m{k}", 1 / count),
                position=tuple(corner + along / 2),
                angle=float(angle),
                angular_velocity=0.0,
            )
        )
        system.add(planar.Revolute(f"R{k}", last, rod.start))
        last, corner = rod.end, corner + along
    return system.build()


def timed(call: Callable[[], object], calls: int) -> float:
    """Seconds per call."""
    begin = time.perf_counter()
    for _ in range(calls):
        call()
    return (time.perf_counter() - begin) / calls


def our_acceleration(model: da.Model, coordinates) -> tuple[Callable[[int], float], np.ndarray]:
    """Seconds per acceleration, many in one mapped call, and the accelerations at the start."""
    view = coordinates.view(model)
    e, p = view.equations, ca.DM(model.nominal)
    function = da.RangeSpace().acceleration(e, e.constraint_acceleration, [e.a]).function
    q, u = view.reduce.function(0.0, model.start.y, model.start.v, p)
    x = ca.vertcat(q, u, 0, 0)

    def run(calls: int) -> float:
        many = function.map(calls)
        inputs = [ca.DM(0), ca.repmat(x, 1, calls), ca.repmat(p, 1, calls)]
        return timed(lambda: many(*inputs), 1) / calls

    return run, function(0.0, x, p).full().ravel()


def pinocchio_acceleration(count: int) -> tuple[Callable[[int], float], np.ndarray]:
    """Seconds per ``aba`` called from Python, and the accelerations at the start."""
    import pinocchio as pin

    model = pin.Model()
    model.gravity.linear = np.array([0.0, -GRAVITY, 0.0])
    length = mass = 1 / count
    spin = np.diag([0.0, mass * length**2 / 12, mass * length**2 / 12])
    joint = 0
    for k in range(count):
        place = pin.SE3(np.eye(3), np.array([length if k else 0.0, 0.0, 0.0]))
        joint = model.addJoint(joint, pin.JointModelRZ(), place, f"R{k}")
        body = pin.Inertia(mass, np.array([length / 2, 0.0, 0.0]), spin)
        model.appendBodyToJoint(joint, body, pin.SE3.Identity())
    data, q, zero = model.createData(), bend(count), np.zeros(count)
    result = np.array(pin.aba(model, data, q, zero, zero))
    return lambda calls: timed(lambda: pin.aba(model, data, q, zero, zero), calls), result


def our_step(
    model: da.Model, coordinates, steps: int, backend: str = "vm"
) -> tuple[float, np.ndarray]:
    """Seconds per RK4 step, and the tip at the end."""
    motion = da.solve_dynamics(
        model,
        steps * STEP,
        step=STEP,
        outputs=[steps * STEP],
        coordinates=coordinates,
        stabilization=da.Stabilization(),
        backend=backend,
    )
    tip = motion.values(f"b{len(model.bodies) - 1}.end.position").ravel()
    return motion.statistics["integration time [s]"] / steps, tip


def exudyn_settings(exu, steps: int):
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = steps * STEP
    settings.solution.file.write = False
    settings.timeIntegration.verboseMode = 0
    return settings


def exudyn_tree(count: int, steps: int) -> tuple[float, np.ndarray]:
    """Kinematic tree of 3-D revolute joints, explicit RK44."""
    import exudyn as exu
    from exudyn.itemInterface import NodeGenericODE2, ObjectKinematicTree

    container = exu.SystemContainer()
    system = container.AddSystem()
    length = mass = 1 / count
    node = system.AddNode(
        NodeGenericODE2(
            referenceCoordinates=[0.0] * count,
            initialCoordinates=list(bend(count)),
            initialCoordinates_t=[0.0] * count,
            numberOfODE2Coordinates=count,
        )
    )
    rod = np.diag([0.0, mass * length**2 / 12, mass * length**2 / 12])
    system.AddObject(
        ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=[exu.JointType.RevoluteZ] * count,
            linkParents=list(range(-1, count - 1)),
            jointTransformations=exu.Matrix3DList([np.eye(3)] * count),
            jointOffsets=exu.Vector3DList([[length if k else 0.0, 0, 0] for k in range(count)]),
            linkInertiasCOM=exu.Matrix3DList([rod] * count),
            linkCOMs=exu.Vector3DList([[length / 2, 0, 0]] * count),
            linkMasses=[mass] * count,
            baseOffset=[0.0, 0.0, 0.0],
            gravity=[0.0, -GRAVITY, 0.0],
        )
    )
    system.Assemble()
    settings = exudyn_settings(exu, steps)
    begin = time.perf_counter()
    system.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
    elapsed = time.perf_counter() - begin
    angles = np.cumsum(system.GetNodeOutput(node, exu.OutputVariableType.Coordinates))
    tip = length * np.array([np.cos(angles).sum(), np.sin(angles).sum()])
    return elapsed / steps, tip


def exudyn_redundant(count: int, steps: int) -> tuple[float, np.ndarray]:
    """Planar bodies and joints, implicit generalized-α."""
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
    length = mass = 1 / count
    last, corner = system.AddObject(ObjectGround()), np.zeros(2)
    hold = [0.0, 0.0, 0.0]
    for angle in np.cumsum(bend(count)):
        along = np.array([math.cos(angle), math.sin(angle)]) * length
        node = system.AddNode(
            NodeRigidBody2D(
                referenceCoordinates=[*(corner + along / 2), angle], initialVelocities=[0, 0, 0]
            )
        )
        rod = system.AddObject(
            ObjectRigidBody2D(nodeNumber=node, mass=mass, inertia=mass * length**2 / 12)
        )
        system.AddLoad(
            LoadMassProportional(
                markerNumber=system.AddMarker(MarkerBodyMass(bodyNumber=rod)),
                loadVector=[0, -GRAVITY, 0],
            )
        )
        markers = [
            system.AddMarker(MarkerBodyPosition(bodyNumber=body, localPosition=place))
            for body, place in ((last, hold), (rod, [-length / 2, 0.0, 0.0]))
        ]
        system.AddObject(ObjectJointRevolute2D(markerNumbers=markers))
        last, corner, hold = rod, corner + along, [length / 2, 0.0, 0.0]
    system.Assemble()
    settings = exudyn_settings(exu, steps)
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    begin = time.perf_counter()
    system.SolveDynamic(settings)
    elapsed = time.perf_counter() - begin
    tip = system.GetObjectOutputBody(last, exu.OutputVariableType.Position, localPosition=hold)
    return elapsed / steps, np.array(tip[:2])


def exponent(counts: list[int], times: list[float]) -> float:
    return math.log(times[-1] / times[0]) / math.log(counts[-1] / counts[0])


def table(title: str, counts: list[int], columns: dict[str, list[float]]) -> None:
    print(f"\n{title}")
    print(f"{'':26}" + "".join(f"{f'N = {n}':>10}" for n in counts) + f"{'exponent':>10}")
    for name, times in columns.items():
        growth = f"{exponent(counts, times):10.2f}" if len(counts) > 1 else ""
        print(f"{name:26}" + "".join(f"{t * 1e6:10.2f}" for t in times) + growth)


def main(counts: list[int], repeats: int) -> None:
    single: dict[str, list[float]] = {}
    step: dict[str, list[float]] = {}
    for count in counts:
        model, steps = build(count), max(400, 8000 // count)
        ours = {name: our_acceleration(model, c) for name, c in COORDINATES.items()}
        aba, expected = pinocchio_acceleration(count)
        miss = np.abs(ours["joint, relative"][1] - expected).max() / np.abs(expected).max()
        kinds = {name: run for name, (run, _) in ours.items()}
        kinds["Pinocchio aba, from Python"] = aba
        runs = {
            f"{name}{label}": lambda c=c, m=model, n=steps, b=backend: our_step(m, c, n, b)
            for backend, label in {"vm": "", "jit": ", LLVM"}.items()
            for name, c in COORDINATES.items()
        }
        runs["Exudyn tree, RK44"] = lambda n=count, s=steps: exudyn_tree(n, s)
        runs["Exudyn redundant, implicit"] = lambda n=count, s=steps: exudyn_redundant(n, s)
        best = dict.fromkeys(kinds, math.inf)
        fastest = dict.fromkeys(runs, math.inf)
        tips = {}
        for _ in range(repeats):
            for name, run in kinds.items():
                best[name] = min(best[name], run(2000))
            for name, whole in runs.items():
                seconds, tips[name] = whole()
                fastest[name] = min(fastest[name], seconds)
        for name, value in best.items():
            single.setdefault(name, []).append(value)
        for name, value in fastest.items():
            step.setdefault(name, []).append(value)
        apart = {n: np.abs(tip - tips["joint, relative"]).max() for n, tip in tips.items()}
        print(f"N = {count}: q̈ from Pinocchio's {miss:.1e} (relative); tips apart [m]: ", end="")
        print(", ".join(f"{n} {value:.1e}" for n, value in apart.items() if n in list(apart)[1:]))
    table("one acceleration [µs]", counts, single)
    table("one step [µs]", counts, step)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("-n", type=int, nargs="+", default=[10, 20, 40])
    parser.add_argument("--repeats", type=int, default=3)
    options = parser.parse_args()
    main(options.n, options.repeats)
