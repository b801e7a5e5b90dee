"""Chain of N bodies in space on hinges: dalembert, on the VM and in C, beside Exudyn and Pinocchio.

Bodies of 1 kg and 1 m hang on hinges whose axes are y and z in turn, released stretched along x,
g = 9.81 along −z. First table, one step of a whole run in absolute coordinates: dalembert RK4 (four
accelerations, fourth order) with range-space elimination, without and with projection; Exudyn its
implicit generalized-α step (second order, sparse solver, modified Newton). The last columns are the
whole adjoint gradient by all parameters over the run, and the largest difference of the tips of the
two codes. Second table, one acceleration in joint coordinates, beside Pinocchio's articulated-body
algorithm in C++ called in a Python loop. All in one process, in turns, best of several.

    pip install "dalembert[bench]" && python benchmarks/spatial_chain.py
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

import dalembert as da
from dalembert import spatial
from dalembert.symbolic.backends import BACKENDS

GRAVITY = 9.81
INERTIA = (0.01, 0.02, 0.015)
STEP, DURATION = 1e-3, 0.2
AXES = ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def build(count: int) -> da.Model:
    """The chain of dalembert; every length and mass is a parameter."""
    system = da.System(f"chain of {count}", gravity=(0.0, 0.0, -GRAVITY))
    last = system.ground.frame((0.0, 0.0, 0.0), axis=AXES[0])
    for k in range(count):
        half = system.parameter(f"l{k}", 1.0) / 2
        body = system.add(
            spatial.Body(
                f"b{k}",
                mass=system.parameter(f"m{k}", 1.0),
                inertia=INERTIA,
                position=(k + 0.5, 0.0, 0.0),
            )
        )
        here = body.frame((-half, 0.0, 0.0), axis=AXES[k % 2])
        system.add(spatial.Revolute(f"J{k}", last, here))
        last = body.frame((half, 0.0, 0.0), axis=AXES[(k + 1) % 2])
    return system.build()


def run(model: da.Model, stabilization, backend: str, step: float = STEP) -> da.Motion:
    return da.solve_dynamics(
        model,
        DURATION,
        step=step,
        outputs=[DURATION],
        stabilization=stabilization,
        backend=backend,
    )


def tip(count: int) -> str:
    return f"b{count - 1}.position"


def seconds_of_gradient(motion: da.Motion, count: int) -> float:
    begin = time.perf_counter()
    da.sensitivity(motion, da.final(f"b{count - 1}.z"), method="adjoint")
    return time.perf_counter() - begin


def run_exudyn(count: int, steps: int) -> tuple[float, np.ndarray]:
    """Seconds for the solver alone, and the mass centre of the last body."""
    import exudyn as exu
    from exudyn.itemInterface import (
        LoadMassProportional,
        MarkerBodyMass,
        MarkerBodyRigid,
        NodeRigidBodyEP,
        ObjectGround,
        ObjectJointGeneric,
        ObjectRigidBody,
    )

    container = exu.SystemContainer()
    system = container.AddSystem()
    last, at = system.AddObject(ObjectGround()), [0.0, 0.0, 0.0]
    for k in range(count):
        node = system.AddNode(
            NodeRigidBodyEP(
                referenceCoordinates=[k + 0.5, 0, 0, 1, 0, 0, 0],
                initialVelocities=[0.0] * 7,
            )
        )
        body = system.AddObject(
            ObjectRigidBody(mass=1.0, inertia=[*INERTIA, 0.0, 0.0, 0.0], nodeNumber=node)
        )
        weight = system.AddMarker(MarkerBodyMass(bodyNumber=body))
        system.AddLoad(LoadMassProportional(markerNumber=weight, loadVector=[0, 0, -GRAVITY]))
        markers = [
            system.AddMarker(MarkerBodyRigid(bodyNumber=b, localPosition=place))
            for b, place in ((last, at), (body, [-0.5, 0.0, 0.0]))
        ]
        free = [0, 1] if k % 2 else [1, 0]  # turns about y or z
        system.AddObject(
            ObjectJointGeneric(
                markerNumbers=markers, constrainedAxes=[1, 1, 1, 1, 1 - free[0], 1 - free[1]]
            )
        )
        last, at = body, [0.5, 0.0, 0.0]
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = DURATION
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.solution.file.write = False
    settings.timeIntegration.verboseMode = 0
    settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    begin = time.perf_counter()
    system.SolveDynamic(settings)
    elapsed = time.perf_counter() - begin
    end = system.GetObjectOutputBody(last, exu.OutputVariableType.Position, [0.0, 0.0, 0.0])
    return elapsed, np.array(end)


def best(measure: Callable[[], float], times: int = 5) -> float:
    return min(measure() for _ in range(times))


def integration(motion: da.Motion) -> float:
    return motion.statistics["integration time [s]"]


def steps_table(count: int) -> None:
    model, steps = build(count), round(DURATION / STEP)
    plain, projected = da.Stabilization(), da.Projection()
    motions = {
        (backend, stabilization): run(model, stabilization, backend)
        for backend in ("vm", "jit")
        for stabilization in (plain, projected)
    }
    per_step = {
        key: best(lambda key=key: integration(run(model, key[1], key[0]))) / steps
        for key in motions
    }
    peer = best(lambda: run_exudyn(count, steps)[0], 3) / steps
    off = np.abs(motions["vm", plain][tip(count)].values[-1] - run_exudyn(count, 8 * steps)[1])
    motion = motions["vm", plain]
    seconds_of_gradient(motion, count)
    gradient = best(lambda: seconds_of_gradient(motion, count), 3)
    ratio = gradient / (steps * per_step["vm", plain])
    row = [1e6 * per_step[key] for key in motions]
    print(
        f"{count:4d} {row[0]:9.1f} {row[1]:9.1f} {row[2]:9.1f} {row[3]:9.1f} {1e6 * peer:9.1f} "
        f"{1e6 * peer / row[0]:8.2f} {1e6 * peer / row[2]:8.2f} {ratio:9.2f} {off.max():9.1e}"
    )


def acceleration(model: da.Model, backend: str) -> Callable[[], None]:
    """One ``q̈`` of many, as a function without arguments."""
    view = da.JointCoordinates().view(model)
    e, many = view.equations, 200
    function = da.RangeSpace().acceleration(e, e.constraint_acceleration, [e.a]).function
    columns = BACKENDS[backend]().columns(function)
    q, u = (
        part.full() for part in view.reduce.function(0, model.start.y, model.start.v, model.nominal)
    )
    x = np.tile(np.vstack([q, u, np.zeros((2, 1))]), many)
    p = np.tile(model.nominal[:, None], many)
    return lambda: columns(many, np.zeros(many), x, p)


def accelerations_table(count: int) -> None:
    try:
        import pinocchio as pin
    except ImportError:
        pin = None
    model, many = build(count), 200
    found = []
    for backend in ("vm", "jit"):
        call = acceleration(model, backend)
        call()
        found.append(1e6 / many * best(lambda call=call: timed(call)))
    peer = np.nan
    if pin is not None:
        tree = pin.Model()
        tree.gravity.linear = np.array([0, 0, -GRAVITY])
        parent = 0
        for k in range(count):
            joint = pin.JointModelRY() if k % 2 == 0 else pin.JointModelRZ()
            place = pin.SE3(np.eye(3), np.array([float(k > 0), 0, 0]))
            parent = tree.addJoint(parent, joint, place, f"J{k}")
            body = pin.Inertia(1.0, np.array([0.5, 0, 0]), np.diag(INERTIA))
            tree.appendBodyToJoint(parent, body, pin.SE3.Identity())
        data, zero = tree.createData(), np.zeros(count)

        def loop() -> None:
            for _ in range(many):
                pin.aba(tree, data, zero, zero, zero)

        peer = 1e6 / many * best(lambda: timed(loop))
    print(f"{count:4d} {found[0]:9.2f} {found[1]:9.2f} {peer:9.2f}")


def timed(call: Callable[[], object]) -> float:
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--bodies", type=int, nargs="+", default=[3, 10, 20, 40])
    parser.add_argument("--arms", type=int, nargs="*", default=[7, 20, 40])
    chosen = parser.parse_args()
    print("one step [us]")
    print("   N   VM plain   VM proj.   C plain   C proj.   Exudyn   E/VM     E/C   gradient   off")
    for count in chosen.bodies:
        steps_table(count)
    print("one acceleration in joint coordinates [us]\n   N        VM         C  Pinocchio")
    for count in chosen.arms:
        accelerations_table(count)


if __name__ == "__main__":
    main()
