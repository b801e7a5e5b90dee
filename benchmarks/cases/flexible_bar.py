"""A bar of solid elements as a flexible body, beside the one of Exudyn with the same shapes.

1 m × 50 mm × 50 mm, hexahedra of 20 nodes, E = 5e8 Pa, ν = 0.3, ρ = 1000 kg/m³: one end on a hinge,
released level, the middle of the other end after 0.5 s. Mass and stiffness matrices of the mesh and
the shapes (rigid motions of the ends, and six modes with both ends held, in mean axes) are those of
dalembert for both; Exudyn makes an ``ObjectFFRFreducedOrder`` of them, in mean axes because others
cost it energy. The reference is Exudyn's, by many short steps. dalembert takes explicit steps of
fourth order, Exudyn its generalized-α method.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from functools import cache

import numpy as np

import dalembert as da
from benchmarks.cases.base import Case, Effort
from benchmarks.picture import draw
from benchmarks.precision import compare
from benchmarks.sample import Row
from benchmarks.solvers import ours
from benchmarks.solvers.base import Contestant, installed
from benchmarks.solvers.exudyn import settings_for
from dalembert import spatial, structures
from dalembert.model.assembled.reduction.rigid import node_positions

LENGTH, SIDE, MODULUS, POISSON, DENSITY = 1.0, 0.05, 5e8, 0.3, 1000.0
GRAVITY, DURATION, MODES, ERROR, MANY = 9.81, 0.5, 6, 1e-5, 16_000


@cache
def body() -> spatial.FlexibleBody:
    """The bar, its frame in mean axes."""
    drawn = structures.Structure("bar")
    mesh = structures.box_mesh((LENGTH, SIDE, SIDE), (10, 1, 1), "hexahedron20")
    made = drawn.add_mesh("bar", mesh, modulus=MODULUS, poisson=POISSON, density=DENSITY)
    ends = {name: made.nodes().where(x=x) for name, x in (("root", 0.0), ("tip", LENGTH))}
    middle = (LENGTH / 2, SIDE / 2, SIDE / 2)
    return spatial.FlexibleBody("bar", drawn.build(), interface=ends, modes=MODES, position=middle)


@cache
def model() -> da.Model:
    """The bar on its hinge."""
    system = da.System("bar", gravity=(0, 0, -GRAVITY))
    bar = system.add(body())
    hinge = system.ground.frame((0.0, SIDE / 2, SIDE / 2), axis=(0, 1, 0))
    system.add(spatial.Revolute("O", hinge, bar.frame("root", axis=(0, 1, 0))))
    return system.build()


def run(steps: int, backend: str) -> tuple[float, np.ndarray]:
    """A run of dalembert."""
    motion = da.solve_dynamics(
        model(),
        DURATION,
        step=DURATION / steps,
        integrator=da.RK4(),
        outputs=[DURATION],
        backend=backend,
    )
    place = np.array([motion[f"bar.tip.{q}"].values[-1] for q in "xyz"])
    return motion.statistics["integration time [s]"], place


@cache
def reduced():
    """The same mesh and shapes in Exudyn, shapes of the tip's middle, nodes of the root."""
    from exudyn.FEM import FEMinterface, ObjectFFRFreducedOrderInterface

    shapes = body().shapes
    made, p = shapes.structure, shapes.p
    order = made.degrees.table[:, :3].ravel()
    places = node_positions(made.blocks, made.degrees, p) - shapes.origin
    whole = made.assembly
    fem = FEMinterface()
    fem.nodes = {"Position": places}
    for name, matrix in (
        ("massMatrix", whole.mass(p)),
        ("stiffnessMatrix", whole.stiffness(np.zeros(len(made.degrees)), p)),
    ):
        setattr(fem, name, matrix.tocsr()[order][:, order].tocsr())
    fem.modeBasis = {"matrix": shapes.displacements[order], "type": "given"}
    root = np.flatnonzero(np.abs(places[:, 0] + LENGTH / 2) < 1e-9)
    return ObjectFFRFreducedOrderInterface(fem), shapes.sections["tip"], [int(k) for k in root]


def exudyn(steps: int) -> tuple[float, np.ndarray]:
    """A run of Exudyn."""
    import exudyn as exu
    from exudyn import itemInterface as item

    interface, tip, root = reduced()
    container = exu.SystemContainer()
    mbs = container.AddSystem()
    made = interface.AddObjectFFRFreducedOrder(
        mbs, positionRef=[LENGTH / 2, SIDE / 2, SIDE / 2], gravity=[0, 0, -GRAVITY]
    )
    ground = mbs.AddObject(item.ObjectGround(referencePosition=[0.0, SIDE / 2, SIDE / 2]))
    ends = [
        mbs.AddMarker(item.MarkerBodyRigid(bodyNumber=ground)),
        mbs.AddMarker(
            item.MarkerSuperElementRigid(
                bodyNumber=made["oFFRFreducedOrder"],
                meshNodeNumbers=root,
                weightingFactors=[1 / len(root)] * len(root),
            )
        ),
    ]
    mbs.AddObject(item.GenericJoint(markerNumbers=ends, constrainedAxes=[1, 1, 1, 1, 0, 1]))
    mbs.Assemble()
    settings = settings_for(DURATION, steps, 1)
    begin = time.perf_counter()
    mbs.SolveDynamic(settings)
    seconds = time.perf_counter() - begin
    rigid, kinds = made["nRigidBody"], exu.OutputVariableType
    axes = np.array(mbs.GetNodeOutput(rigid, kinds.RotationMatrix)).reshape(3, 3)
    q = np.array(mbs.GetNodeOutput(made["nGenericODE2"], kinds.Coordinates))
    place = np.array(mbs.GetNodeOutput(rigid, kinds.Position)) + axes @ (tip.place + tip.shift @ q)
    return seconds, place


def reference(effort: Effort) -> np.ndarray:
    """The place by short steps of Exudyn."""
    return exudyn(MANY // 8 if effort.quick else MANY)[1]


def measure(effort: Effort) -> Iterator[Row]:
    """Everyone to the same error."""
    if not installed("exudyn"):
        return
    error = 1e-3 if effort.quick else ERROR
    runs = {ours.NAMES[b]: (lambda steps, b=b: run(steps, b)) for b in effort.backends}
    contestants = [Contestant(name, of, 1200) for name, of in runs.items()]
    contestants.append(Contestant("Exudyn", exudyn, 125))
    curves = compare(contestants, reference(effort), error, effort.rounds, effort.limit)
    if effort.pictures is not None:
        draw("flexible bar", curves, effort.pictures)
    samples = {curve.contestant.name: curve.time for curve in curves}
    yield Row("flexible bar, 12 shapes", f"time to an error of {error:.0e} m", samples)


CASE = Case("flexible-bar", "a bar of solid elements by few shapes, 0.5 s", measure)
