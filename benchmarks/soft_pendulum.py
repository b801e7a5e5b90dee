"""A soft pendulum of rubber: geometrically exact beams of dalembert beside those of Exudyn.

Length 0.5 m, 2 mm × 10 mm, E = 1e8 Pa, ρ = 1000 kg/m³, ν = 0.3, released level, g = 9.81: the tip
after 1 s, against nine digits found independently by spectral elements. dalembert takes elements of
third order and the HHT method, on the virtual machine and compiled; Exudyn beams of first order
(``Beam2D``) and cables of third order (``Cable2D``), and its generalized-α method, both with an
implicit step of second order. Times are those of the run, without building the model; all in one
process, in turns, best of several.

    pip install "dalembert[bench]" && python benchmarks/soft_pendulum.py
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from itertools import pairwise

import numpy as np

import dalembert as da
from dalembert import planar

LENGTH, HEIGHT, WIDTH, MODULUS, DENSITY, POISSON = 0.5, 0.002, 0.01, 1e8, 1000.0, 0.3
AREA, SECOND = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12
SHEAR = 10 * (1 + POISSON) / (12 + 11 * POISSON) * MODULUS / (2 * (1 + POISSON)) * AREA
TIP = np.array([-0.028524, -0.466594])
GRAVITY, DURATION = 9.81, 1.0
Run = Callable[[], np.ndarray]


def ours(elements: int, step: float, backend: str) -> Run:
    """A run of dalembert, compiled already."""
    system = da.System("pendulum", gravity=(0, -GRAVITY))
    arm = system.add(
        planar.Beam(
            "arm",
            length=LENGTH,
            axial_rigidity=MODULUS * AREA,
            shear_rigidity=SHEAR,
            bending_rigidity=MODULUS * SECOND,
            mass_per_length=DENSITY * AREA,
            elements=elements,
            position=(0, 0),
            angle=0.0,
        )
    )
    system.add(planar.Revolute("O", system.ground.center, arm.start.center))
    analysis = da.Dynamics(
        duration=DURATION, step=step, integrator=da.HHT(), outputs=[DURATION], backend=backend
    )
    model = system.build()

    def run() -> np.ndarray:
        motion = analysis.run(model)
        seconds = motion.statistics["integration time [s]"]
        return np.array([*(motion[f"arm.end.{q}"].values[-1] for q in "xy"), seconds])

    return run


def exudyn(elements: int, step: float, kind: str) -> Run:
    """A run of Exudyn."""
    import exudyn as exu
    from exudyn import itemInterface as item

    def run() -> np.ndarray:
        container = exu.SystemContainer()
        mbs = container.AddSystem()
        size, nodes, parts = LENGTH / elements, [], []
        for k in range(elements + 1):
            if kind == "Cable2D":
                node = item.NodePoint2DSlope1(referenceCoordinates=[k * size, 0, 1, 0])
            else:
                node = item.NodeRigidBody2D(referenceCoordinates=[k * size, 0, 0])
            nodes.append(mbs.AddNode(node))
        common = {
            "length": size,
            "massPerLength": DENSITY * AREA,
            "bendingStiffness": MODULUS * SECOND,
            "axialStiffness": MODULUS * AREA,
        }
        for pair in pairwise(nodes):
            if kind == "Cable2D":
                made = item.Cable2D(**common, nodeNumbers=list(pair))
            else:
                made = item.Beam2D(
                    **common,
                    nodeNumbers=list(pair),
                    shearStiffness=SHEAR,
                    crossSectionInertia=DENSITY * SECOND,
                )
            parts.append(mbs.AddObject(made))
            mass = mbs.AddMarker(item.MarkerBodyMass(bodyNumber=parts[-1]))
            mbs.AddLoad(item.Gravity(markerNumber=mass, loadVector=[0, -GRAVITY, 0]))
        ground = mbs.AddNode(item.NodePointGround())
        for axis in (0, 1):
            still = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=ground, coordinate=axis))
            held = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=axis))
            mbs.AddObject(item.CoordinateConstraint(markerNumbers=[still, held]))
        mbs.Assemble()
        settings = exu.SimulationSettings()
        settings.timeIntegration.numberOfSteps = round(DURATION / step)
        settings.timeIntegration.endTime = DURATION
        settings.timeIntegration.newton.useModifiedNewton = True
        settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
        settings.timeIntegration.verboseMode = 0
        settings.solutionSettings.writeSolutionToFile = False
        settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
        begin = time.perf_counter()
        mbs.SolveDynamic(settings)
        seconds = time.perf_counter() - begin
        at = mbs.GetNodeOutput(nodes[-1], exu.OutputVariableType.Position)
        return np.array([*at[:2], seconds])

    return run


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=3)
    repeats = parser.parse_args().repeats
    runs: dict[str, Run] = {}
    for elements, step in ((4, 2e-3), (4, 1e-3), (6, 1e-3), (8, 5e-4)):
        for backend in ("vm", "jit"):
            name = f"dalembert, {elements} of order 3, {backend}"
            runs[f"{name:34s}{step:8.0e}"] = ours(elements, step, backend)
    for kind, meshes in (("Cable2D", (8, 16, 32)), ("Beam2D", (16, 32, 64))):
        for elements, step in zip(meshes, (1e-3, 1e-3, 5e-4), strict=True):
            name = f"Exudyn, {elements} {kind}"
            runs[f"{name:34s}{step:8.0e}"] = exudyn(elements, step, kind)
    best = dict.fromkeys(runs, np.inf)
    tips: dict[str, np.ndarray] = {}
    for _ in range(repeats):
        for name, run in runs.items():
            found = run()
            tips[name], best[name] = found[:2], min(best[name], found[2])
    print(f"{'':34s}{'step':>8s}{'error of the tip':>18s}{'time [s]':>10s}")
    for name, seconds in best.items():
        print(f"{name}{np.abs(tips[name] - TIP).max():18.1e}{seconds:10.3f}")


if __name__ == "__main__":
    main()
