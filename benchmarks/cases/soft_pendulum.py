"""A soft pendulum of rubber: geometrically exact beams of dalembert beside those of Exudyn.

Length 0.5 m, 2 mm × 10 mm, E = 1e8 Pa, ρ = 1000 kg/m³, ν = 0.3, released level, g = 9.81: the tip
after 1 s, against nine digits found independently by spectral elements. dalembert takes elements of
third order and the HHT method; Exudyn beams of first order (``Beam2D``) and cables of third order
(``Cable2D``), and its generalized-α method, all with an implicit step of second order.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from functools import cache
from itertools import pairwise

import numpy as np

import dalembert as da
from benchmarks.cases.base import Case, Effort
from benchmarks.picture import draw
from benchmarks.precision import compare
from benchmarks.sample import Row
from benchmarks.solvers import ours
from benchmarks.solvers.base import Contestant, installed
from benchmarks.solvers.exudyn import settings_for
from dalembert import planar

LENGTH, HEIGHT, WIDTH, MODULUS, DENSITY, POISSON = 0.5, 0.002, 0.01, 1e8, 1000.0, 0.3
AREA, SECOND = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12
SHEAR = 10 * (1 + POISSON) / (12 + 11 * POISSON) * MODULUS / (2 * (1 + POISSON)) * AREA
TIP = np.array([-0.028524, -0.466594])
GRAVITY, DURATION = 9.81, 1.0
ERROR = 1e-5


@cache
def model(elements: int) -> da.Model:
    """The pendulum of dalembert."""
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
    return system.build()


def beam(elements: int, steps: int, backend: str) -> tuple[float, np.ndarray]:
    """A run of dalembert."""
    motion = da.solve_dynamics(
        model(elements),
        DURATION,
        step=DURATION / steps,
        integrator=da.HHT(),
        outputs=[DURATION],
        backend=backend,
    )
    tip = np.array([motion[f"arm.end.{q}"].values[-1] for q in "xy"])
    return motion.statistics["integration time [s]"], tip


def exudyn(elements: int, steps: int, kind: str) -> tuple[float, np.ndarray]:
    """A run of Exudyn."""
    import exudyn as exu
    from exudyn import itemInterface as item

    container = exu.SystemContainer()
    mbs = container.AddSystem()
    size, nodes = LENGTH / elements, []
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
    thick = {"shearStiffness": SHEAR, "crossSectionInertia": DENSITY * SECOND}
    for pair in pairwise(nodes):
        if kind == "Cable2D":
            made = item.Cable2D(**common, nodeNumbers=list(pair))
        else:
            made = item.Beam2D(**common, **thick, nodeNumbers=list(pair))
        mass = mbs.AddMarker(item.MarkerBodyMass(bodyNumber=mbs.AddObject(made)))
        mbs.AddLoad(item.Gravity(markerNumber=mass, loadVector=[0, -GRAVITY, 0]))
    ground = mbs.AddNode(item.NodePointGround())
    for axis in (0, 1):
        still = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=ground, coordinate=axis))
        held = mbs.AddMarker(item.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=axis))
        mbs.AddObject(item.CoordinateConstraint(markerNumbers=[still, held]))
    mbs.Assemble()
    settings = settings_for(DURATION, steps, elements)
    begin = time.perf_counter()
    mbs.SolveDynamic(settings)
    seconds = time.perf_counter() - begin
    at = mbs.GetNodeOutput(nodes[-1], exu.OutputVariableType.Position)
    return seconds, np.array(at[:2])


def measure(effort: Effort) -> Iterator[Row]:
    """Everyone with meshes that suit them; errors are those of mesh and steps together.

    Four elements end 2e-5 from the reference and six 3e-5, whatever the steps; eight 7e-6.
    """
    ours_runs = {
        ours.NAMES[b]: (lambda steps, b=b: beam(4 if steps < 2000 else 8, steps, b))
        for b in effort.backends
    }
    contestants = [Contestant(name, run, 250) for name, run in ours_runs.items()]
    if installed("exudyn"):
        for kind, elements in (("Cable2D", 16), ("Beam2D", 64)):
            contestants.append(
                Contestant(
                    f"Exudyn, {kind}",
                    lambda steps, k=kind, n=elements: exudyn(n, steps, k),
                    250,
                )
            )
    curves = compare(contestants, TIP, 1e-3 if effort.quick else ERROR, effort.rounds, effort.limit)
    if effort.pictures is not None:
        draw("soft pendulum", curves, effort.pictures)
    samples = {curve.contestant.name: curve.time for curve in curves}
    error = 1e-3 if effort.quick else ERROR
    yield Row("soft pendulum", f"time to an error of {error:.0e} m", samples)


CASE = Case("soft-pendulum", "a pendulum of rubber, 1 s", measure)
