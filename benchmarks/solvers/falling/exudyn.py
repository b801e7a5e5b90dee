"""Exudyn: spheres with compliant contacts, explicit steps (``GeneralContact``)."""

from __future__ import annotations

import time

import numpy as np

from benchmarks.falling_bodies import FRICTION, GRAVITY, MASS, SIZE, STEP, FallingBodies
from benchmarks.solvers.falling.base import Run

STIFFNESS, DAMPING = MASS * (0.3 / STEP) ** 2, MASS * 0.3 / STEP
"""Of a contact, [N/m] and [N s/m], so that explicit steps are stable."""
EACH = 10
"""Steps between two measurements of the penetration, in a second run."""


def exudyn(bodies: FallingBodies) -> Run:
    """Steps of Exudyn for discs or spheres."""
    import exudyn as exu

    def solve(system, begin: int, steps: int) -> None:
        settings = exu.SimulationSettings()
        settings.timeIntegration.verboseMode = 0
        settings.solution.file.write = False
        settings.timeIntegration.explicit.computeEndOfStepAccelerations = False
        settings.timeIntegration.reuseConstantMassMatrix = True
        settings.timeIntegration.numberOfSteps = steps
        settings.timeIntegration.startTime = begin * STEP
        settings.timeIntegration.endTime = (begin + steps) * STEP
        method = exu.DynamicSolverType.ExplicitEuler
        system.SolveDynamic(settings, method, updateInitialValues=True)

    def run(steps: int) -> tuple[float, float]:
        container = exu.SystemContainer()
        system = container.AddSystem()
        _assembled(bodies, system)
        begin = time.perf_counter()
        solve(system, 0, steps)
        seconds = (time.perf_counter() - begin) / steps
        container, deepest = exu.SystemContainer(), 0.0
        system = container.AddSystem()
        nodes, position = _assembled(bodies, system), exu.OutputVariableType.Position
        for first in range(0, steps, EACH):
            solve(system, first, EACH)
            places = np.array([system.GetNodeOutput(node, position) for node in nodes])
            deepest = max(deepest, bodies.penetration(places[:, : bodies.dimension]))
        return seconds, deepest

    return run


def _assembled(bodies: FallingBodies, system) -> list:
    """Nodes of the bodies of an assembled system."""
    from exudyn import itemInterface as item

    contact, nodes, flat = system.AddGeneralContact(), [], bodies.dimension == 2
    law = {"contactStiffness": STIFFNESS, "contactDamping": DAMPING, "frictionMaterialIndex": 0}
    contact.SetFrictionPairings(FRICTION * np.eye(1))
    contact.SetFrictionProportionalZone(1e-3)
    for place, speed in zip(bodies.positions, bodies.velocities, strict=True):
        if flat:
            node = system.AddNode(
                item.NodeRigidBody2D(
                    referenceCoordinates=[*place, 0], initialVelocities=[*speed, 0]
                )
            )
            system.AddObject(
                item.ObjectRigidBody2D(mass=MASS, inertia=bodies.inertia, nodeNumber=node)
            )
            load = [0, -MASS * GRAVITY, 0]
        else:
            node = system.AddNode(
                item.NodeRigidBodyRotVecLG(
                    referenceCoordinates=[*place, 0, 0, 0], initialVelocities=[*speed, 0, 0, 0]
                )
            )
            inertia = [bodies.inertia] * 3 + [0.0] * 3
            system.AddObject(item.ObjectRigidBody(mass=MASS, inertia=inertia, nodeNumber=node))
            load = [0, 0, -MASS * GRAVITY]
        marker = system.AddMarker(item.MarkerNodeRigid(nodeNumber=node))
        system.AddLoad(item.Force(markerNumber=marker, loadVector=load))
        contact.AddSphereWithMarker(marker, radius=SIZE, **law)
        nodes.append(node)
    ground = system.AddObject(item.ObjectGround())
    fixed = system.AddMarker(item.MarkerBodyRigid(bodyNumber=ground))
    contact.AddTrianglesRigidBodyBased(rigidBodyMarkerIndex=fixed, **law, **_triangles(bodies))
    cells = max(1, round(bodies.width / (4 * SIZE)))
    contact.SetSearchTreeCellSize(numberOfCells=[cells, cells, 1 if flat else cells])
    system.Assemble()
    return nodes


def _triangles(bodies: FallingBodies) -> dict[str, list]:
    """Two triangles for each wall, larger than the box."""
    points, triangles = [], []
    reach = 2 * (bodies.width + float(bodies.positions.max()))
    for point, normal in bodies.walls():
        normal = np.resize(np.r_[normal, 0.0], 3)
        first = np.eye(3)[int(np.argmin(np.abs(normal)))]
        second = np.cross(normal, first)
        corners = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
        base, start = np.resize(np.r_[point, 0.0], 3), len(points)
        points += [base + reach * (a * first + b * second) for a, b in corners]
        triangles += [[start, start + 1, start + 2], [start, start + 2, start + 3]]
    return {"pointList": points, "triangleList": triangles}
