"""Solvers of trees in joint coordinates: MuJoCo, Pinocchio and Exudyn's kinematic tree.

Bodies of these trees start with axes along the inertial ones.
"""

from __future__ import annotations

import time

import numpy as np

from benchmarks.mechanism import GROUND, Mechanism
from benchmarks.solvers.base import Contestant, installed


def contestants(mechanism: Mechanism, duration: float, first: int) -> list[Contestant]:
    """Those that are installed, all with the classical method of order 4."""
    if not (mechanism.tree and all(np.allclose(b.rotation, np.eye(3)) for b in mechanism.bodies)):
        return []
    found = []
    if installed("mujoco"):
        found.append(Contestant("MuJoCo", lambda n: _mujoco(mechanism, duration, n), first))
    if installed("pinocchio"):
        found.append(Contestant("Pinocchio", lambda n: _pinocchio(mechanism, duration, n), first))
    if installed("exudyn"):
        found.append(Contestant("Exudyn, tree", lambda n: _exudyn(mechanism, duration, n), first))
    return found


def _offset(mechanism: Mechanism, number: int) -> np.ndarray:
    """From the parent's hinge to that of a body."""
    joint = mechanism.joints[number]
    parent = (0, 0, 0) if joint.first == GROUND else mechanism.joints[joint.first].place
    return np.asarray(joint.place, float) - np.asarray(parent, float)


def _lever(mechanism: Mechanism, number: int, place) -> np.ndarray:
    """A place on a body, from its hinge."""
    return np.asarray(place, float) - np.asarray(mechanism.joints[number].place, float)


def _text(values) -> str:
    return " ".join(f"{v:.17g}" for v in values)


def _mujoco(mechanism: Mechanism, duration: float, steps: int) -> tuple[float, np.ndarray]:
    import mujoco

    seen, place = mechanism.observed

    def body(number: int) -> str:
        b, joint = mechanism.bodies[number], mechanism.joints[number]
        inside = [body(k) for k, j in enumerate(mechanism.joints) if j.first == number]
        site = f'<site name="seen" pos="{_text(_lever(mechanism, number, place))}"/>'
        return (
            f'<body pos="{_text(_offset(mechanism, number))}"><inertial mass="{b.mass}" '
            f'pos="{_text(_lever(mechanism, number, b.position))}" '
            f'diaginertia="{_text(b.inertia)}"/><joint axis="{_text(joint.axes[:, 2])}"/>'
            f"{site if number == seen else ''}{''.join(inside)}</body>"
        )

    roots = "".join(body(k) for k, j in enumerate(mechanism.joints) if j.first == GROUND)
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option integrator="RK4" timestep="{duration / steps:.17g}" '
        f'gravity="{_text(mechanism.gravity)}"/><compiler balanceinertia="false" '
        f'boundmass="0" boundinertia="0"/><worldbody>{roots}</worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    begin = time.perf_counter()
    mujoco.mj_step(model, data, nstep=steps)
    elapsed = time.perf_counter() - begin
    mujoco.mj_forward(model, data)
    return elapsed, np.array(data.site("seen").xpos)


def _pinocchio(mechanism: Mechanism, duration: float, steps: int) -> tuple[float, np.ndarray]:
    """Articulated bodies in C++, called from a loop in Python."""
    import pinocchio as pin

    model = pin.Model()
    model.gravity.linear = np.array(mechanism.gravity, float)
    for k, (body, joint) in enumerate(zip(mechanism.bodies, mechanism.joints, strict=True)):
        made = model.addJoint(
            joint.first + 1,
            pin.JointModelRevoluteUnaligned(np.array(joint.axes[:, 2])),
            pin.SE3(np.eye(3), _offset(mechanism, k)),
            f"j{k}",
        )
        lever = _lever(mechanism, k, body.position)
        inertia = pin.Inertia(body.mass, lever, np.diag(body.inertia))
        model.appendBodyToJoint(made, inertia, pin.SE3.Identity())
    data, h = model.createData(), duration / steps
    q, v = np.zeros(model.nq), np.zeros(model.nv)
    none = np.zeros(model.nv)
    begin = time.perf_counter()
    for _ in range(steps):
        a1 = pin.aba(model, data, q, v, none).copy()
        v2 = v + h / 2 * a1
        a2 = pin.aba(model, data, q + h / 2 * v, v2, none).copy()
        v3 = v + h / 2 * a2
        a3 = pin.aba(model, data, q + h / 2 * v2, v3, none).copy()
        v4 = v + h * a3
        a4 = pin.aba(model, data, q + h * v3, v4, none).copy()
        q = q + h / 6 * (v + 2 * v2 + 2 * v3 + v4)
        v = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    elapsed = time.perf_counter() - begin
    pin.forwardKinematics(model, data, q)
    number, place = mechanism.observed
    return elapsed, data.oMi[number + 1].act(_lever(mechanism, number, place))


def _exudyn(mechanism: Mechanism, duration: float, steps: int) -> tuple[float, np.ndarray]:
    """A kinematic tree whose hinges are about z of the links' frames."""
    import exudyn as exu
    from exudyn.itemInterface import MarkerKinematicTreeRigid, NodeGenericODE2, ObjectKinematicTree

    from benchmarks.solvers.exudyn import settings_for

    container, count = exu.SystemContainer(), len(mechanism.bodies)
    system = container.AddSystem()
    node = system.AddNode(
        NodeGenericODE2(
            referenceCoordinates=[0.0] * count,
            initialCoordinates=[0.0] * count,
            initialCoordinates_t=[0.0] * count,
            numberOfODE2Coordinates=count,
        )
    )
    axes = [j.axes for j in mechanism.joints]
    before = [np.eye(3) if j.first == GROUND else axes[j.first] for j in mechanism.joints]
    levers = [_lever(mechanism, k, b.position) for k, b in enumerate(mechanism.bodies)]
    tree = system.AddObject(
        ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=[exu.JointType.RevoluteZ] * count,
            linkParents=[j.first for j in mechanism.joints],
            jointTransformations=exu.Matrix3DList(
                [b.T @ a for b, a in zip(before, axes, strict=True)]
            ),
            jointOffsets=exu.Vector3DList(
                [b.T @ _offset(mechanism, k) for k, b in enumerate(before)]
            ),
            linkInertiasCOM=exu.Matrix3DList(
                [a.T @ np.diag(b.inertia) @ a for a, b in zip(axes, mechanism.bodies, strict=True)]
            ),
            linkCOMs=exu.Vector3DList([a.T @ c for a, c in zip(axes, levers, strict=True)]),
            linkMasses=[b.mass for b in mechanism.bodies],
            baseOffset=[0.0, 0.0, 0.0],
            gravity=list(map(float, mechanism.gravity)),
        )
    )
    number, place = mechanism.observed
    local = axes[number].T @ _lever(mechanism, number, place)
    seen = system.AddMarker(
        MarkerKinematicTreeRigid(objectNumber=tree, linkNumber=number, localPosition=list(local))
    )
    system.Assemble()
    settings = settings_for(duration, steps, 0)
    begin = time.perf_counter()
    system.SolveDynamic(settings, solverType=exu.DynamicSolverType.RK44)
    elapsed = time.perf_counter() - begin
    return elapsed, np.array(system.GetMarkerOutput(seen, exu.OutputVariableType.Position))
