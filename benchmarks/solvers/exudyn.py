"""Exudyn: redundant coordinates and its implicit generalized-α step."""

from __future__ import annotations

import time

import numpy as np

from benchmarks.mechanism import GROUND, Mechanism
from benchmarks.solvers.base import Contestant

SPARSE = 10
"""Bodies from which on the sparse solver is the faster one."""
FREE = {
    "revolute": [1, 1, 1, 1, 1, 0],
    "spherical": [1, 1, 1, 0, 0, 0],
    "universal": [1, 1, 1, 0, 0, 1],
    "prismatic": [1, 1, 0, 1, 1, 1],
}
"""Constrained translations and rotations along and about the joint's axes."""


def contestants(mechanism: Mechanism, duration: float, first: int) -> list[Contestant]:
    return [Contestant("Exudyn", lambda steps: run(mechanism, duration, steps), first)]


def run(mechanism: Mechanism, duration: float, steps: int) -> tuple[float, np.ndarray]:
    """Seconds for the solver alone, and the observed point."""
    import exudyn as exu

    container = exu.SystemContainer()  # the system lives no longer than it
    system = container.AddSystem()
    bodies = (_planar if mechanism.planar else _spatial)(mechanism, system)
    system.Assemble()
    settings = settings_for(duration, steps, len(bodies))
    settings.linearSolver.ignoreSingularJacobian = mechanism.redundant
    if mechanism.redundant:
        settings.linearSolver.solverType = exu.LinearSolverType.EigenDense
    begin = time.perf_counter()
    try:
        system.SolveDynamic(settings)
    except exu.SolverError:  # steps too long for its Newton iteration: nowhere near the place
        return time.perf_counter() - begin, np.full(3, np.nan)
    elapsed = time.perf_counter() - begin
    number, place = mechanism.observed
    found = system.GetObjectOutputBody(
        bodies[number],
        exu.OutputVariableType.Position,
        localPosition=list(mechanism.bodies[number].local(place)),
    )
    return elapsed, np.array(found)


def settings_for(duration: float, steps: int, bodies: int):
    import exudyn as exu

    settings = exu.SimulationSettings()
    settings.timeIntegration.numberOfSteps = steps
    settings.timeIntegration.endTime = duration
    settings.timeIntegration.newton.useModifiedNewton = True
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    if bodies >= SPARSE:
        settings.linearSolver.solverType = exu.LinearSolverType.EigenSparse
    return settings


def _planar(mechanism: Mechanism, system) -> list:
    from exudyn import itemInterface as item

    ground, bodies = system.AddObject(item.ObjectGround()), []
    for body in mechanism.bodies:
        angle = np.arctan2(body.rotation[1, 0], body.rotation[0, 0])
        node = system.AddNode(
            item.NodeRigidBody2D(
                referenceCoordinates=[*body.position[:2], angle],
                initialVelocities=[*body.velocity[:2], body.spin[2]],
            )
        )
        bodies.append(
            system.AddObject(
                item.ObjectRigidBody2D(mass=body.mass, inertia=body.inertia[2], nodeNumber=node)
            )
        )
        _weight(system, bodies[-1], mechanism.gravity)
    for joint in mechanism.joints:
        markers = [
            system.AddMarker(
                item.MarkerBodyPosition(
                    bodyNumber=ground if n == GROUND else bodies[n],
                    localPosition=list(mechanism.body(n).local(joint.place)),
                )
            )
            for n in (joint.first, joint.second)
        ]
        system.AddObject(item.ObjectJointRevolute2D(markerNumbers=markers))
    return bodies


def _spatial(mechanism: Mechanism, system) -> list:
    from exudyn import itemInterface as item
    from exudyn.rigidBodyUtilities import (
        AngularVelocity2EulerParameters_t,
        RotationMatrix2EulerParameters,
    )

    ground, bodies = system.AddObject(item.ObjectGround()), []
    for body in mechanism.bodies:
        turn = np.array(RotationMatrix2EulerParameters(body.rotation), float)
        rate = AngularVelocity2EulerParameters_t(np.array(body.spin, float), turn)
        node = system.AddNode(
            item.NodeRigidBodyEP(
                referenceCoordinates=[*map(float, body.position), *turn],
                initialVelocities=[*map(float, body.velocity), *np.array(rate, float)],
            )
        )
        inertia = [*map(float, body.inertia), 0.0, 0.0, 0.0]
        bodies.append(
            system.AddObject(item.ObjectRigidBody(mass=body.mass, inertia=inertia, nodeNumber=node))
        )
        _weight(system, bodies[-1], mechanism.gravity)
    for joint in mechanism.joints:
        sides = [(ground if n == GROUND else bodies[n], mechanism.body(n)) for n in _ends(joint)]
        markers = [
            system.AddMarker(
                item.MarkerBodyRigid(bodyNumber=b, localPosition=list(body.local(joint.place)))
            )
            for b, body in sides
        ]
        system.AddObject(
            item.ObjectJointGeneric(
                markerNumbers=markers,
                constrainedAxes=FREE[joint.kind],
                rotationMarker0=sides[0][1].rotation.T @ joint.axes,
                rotationMarker1=sides[1][1].rotation.T @ joint.axes,
            )
        )
    return bodies


def _ends(joint) -> tuple[int, int]:
    return joint.first, joint.second


def _weight(system, body, gravity) -> None:
    from exudyn import itemInterface as item

    marker = system.AddMarker(item.MarkerBodyMass(bodyNumber=body))
    load = item.LoadMassProportional(markerNumber=marker, loadVector=list(map(float, gravity)))
    system.AddLoad(load)
