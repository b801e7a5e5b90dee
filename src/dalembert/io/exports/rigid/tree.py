"""Tree of rigid bodies with elementary joints, and the joints that close its loops."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.elements.flexible.floating import FloatingFrame
from dalembert.elements.joint_forces import AlongJoint
from dalembert.errors import UnsupportedError
from dalembert.io.exports.rigid.joints import CLOSED_BY_POINTS, Sequence, sequence_of
from dalembert.io.exports.rigid.start import RigidBody, Start
from dalembert.model.graph.model import Model
from dalembert.model.graph.tree.kinematic_tree import carrying_joints
from dalembert.model.graph.tree.spanning_tree import Edge, spanning_tree

SLIDING = 10
"""Weight of joints that cannot close loops by points, relative to an equation."""


@dataclass(frozen=True)
class Motion:
    """An elementary motion of a body relative to its carrier.

    Attributes
    ----------
    name : of the coordinate
    kind : ``"hinge"``, ``"slide"``, ``"ball"`` or ``"free"``
    axis, anchor : (3,) in the frame of the moving body at the start
    value : coordinate at the start [rad], [m]
    speed : (1,), (3,) of a ball in body axes, or (6,) velocity and angular velocity in body axes
    """

    name: str
    kind: str
    axis: np.ndarray
    anchor: np.ndarray
    value: float
    speed: np.ndarray


@dataclass(frozen=True)
class TreeBody:
    """A body of the tree; its motions follow each other from the carrier outwards.

    Attributes
    ----------
    parent : name of the carrier, ``"ground"`` for a body that none carries
    joint : name of the joint to it; empty without one
    position, axes : at the start, in the frame of the carrier
    """

    name: str
    parent: str
    joint: str
    position: np.ndarray
    axes: np.ndarray
    motions: list[Motion]
    body: RigidBody


@dataclass(frozen=True)
class RigidTree:
    """A mechanism of rigid bodies as a tree.

    Attributes
    ----------
    start : Start, numbers at the start
    bodies : carriers before the bodies that they carry
    loops : constraints outside of the tree, drivers among them
    spins : name of a body → (3,) angular velocity as one of the tree
    """

    start: Start
    bodies: list[TreeBody]
    loops: list[Any]
    spins: dict[str, np.ndarray]

    @property
    def motions(self) -> list[Motion]:
        """Motions of all bodies in their order."""
        return [motion for body in self.bodies for motion in body.motions]


def rigid_tree(
    model: Model, file_format: str, parameters: Mapping[str, float] | None = None
) -> RigidTree:
    """The tree of a mechanism.

    Raises
    ------
    UnsupportedError
        A flexible body, a node, or mass between bodies; names the element.
    """
    for body in model.bodies:
        if isinstance(body, FloatingFrame) or body.node or body.owner is not body:
            raise UnsupportedError(
                f"{file_format} has rigid bodies only, and {body.name!r} is "
                f"{'flexible' if isinstance(body, FloatingFrame) else 'a node'}"
            )
    for element in model.parts.elements.values():
        if element.own_mass and not isinstance(element, AlongJoint):  # rotors are of the formats
            raise UnsupportedError(
                f"{file_format} has rigid bodies only, and {element.name!r} has mass of its own"
            )
    start = Start(model, parameters)
    joints = _tree_joints(model)
    edges = [Edge(j.name, j.ends()[0].name, j.ends()[1].name, _weight(j)) for j in joints.values()]
    names = ["ground", *(body.name for body in model.bodies)]
    bodies, spins = [], {"ground": np.zeros(3)}
    for visit in spanning_tree(names, edges).visits:
        if visit.node == "ground":
            continue
        joint = None if visit.edge is None else joints[visit.edge]
        body, spins[visit.node] = carried(start, visit.node, visit.parent, joint, spins)
        bodies.append(body)
    used = {body.joint for body in bodies}
    loops = [c for c in model.constraints if c.name not in used]
    return RigidTree(start, bodies, loops, spins)


def _tree_joints(model: Model) -> dict[str, Any]:
    joints = carrying_joints(model.parts).items()
    return {name: joint for name, joint in joints if sequence_of(joint) is not None}


def _weight(joint: Any) -> int:
    sliding = 0 if isinstance(joint, CLOSED_BY_POINTS) else SLIDING
    return -int(joint.equations.numel()) - sliding


def carried(
    start: Start, name: str, carrier: str | None, joint: Any, spins: Mapping[str, np.ndarray]
) -> tuple[TreeBody, np.ndarray]:
    """A body with its motions, and its angular velocity as one of the tree.

    Particles do not rotate; in the tree they rotate with their carrier.
    """
    body, base = start.bodies[name], start.bodies[carrier or "ground"]
    if joint is None:
        motions = _free_motions(name, body)
        spin = body.spin
    else:
        sequence = sequence_of(joint)
        assert sequence is not None
        motions = _joint_motions(start, body, joint, sequence, joint.ends()[1].name == name)
        motions, spin = _with_speeds(motions, body, base, spins[carrier or "ground"])
    position = base.axes.T @ (body.position - base.position)
    axes = base.axes.T @ body.axes
    edge = "" if joint is None else joint.name
    return TreeBody(name, carrier or "ground", edge, position, axes, motions, body), spin


def _free_motions(name: str, body: RigidBody) -> list[Motion]:
    """Motions of a body without a carrier."""
    origin = np.zeros(3)
    if body.rotates and not body.planar:
        speed = np.concatenate([body.velocity, body.axes.T @ body.spin])
        return [Motion(name, "free", origin, origin, 0.0, speed)]
    motions = [
        Motion(
            f"{name}.{axis}",
            "slide",
            body.axes.T[:, k],
            origin,
            float(body.position[k]),
            body.velocity[k : k + 1],
        )
        for k, axis in enumerate("xy" if body.planar else "xyz")
    ]
    if body.rotates:
        angle = float(np.arctan2(body.axes[1, 0], body.axes[0, 0]))
        up = np.array([0.0, 0.0, 1.0])
        motions.append(Motion(f"{name}.angle", "hinge", up, origin, angle, body.spin[2:]))
    return motions


def _joint_motions(
    start: Start, body: RigidBody, joint: Any, sequence: Sequence, forward: bool
) -> list[Motion]:
    """Motions of a body at either end of a joint, without speeds."""
    free, chosen = joint.freedoms(), list(sequence.motions)
    if not body.rotates:
        chosen = [motion for motion in chosen if motion.kind == "slide"]
    place = sequence.anchor.position.sx
    formulas = [place]
    for motion in chosen:
        coordinate = free.get(motion.name.rpartition(".")[2])
        formulas += [motion.axis if motion.axis is not None else place]
        formulas += [coordinate[0] if coordinate is not None else place[0] * 0]
    anchor, *numbers = start.values(*formulas)
    anchor = body.local(np.pad(anchor, (0, 3 - anchor.size)))
    motions = []
    for motion, axis, value in zip(chosen, numbers[::2], numbers[1::2], strict=True):
        direction = body.axes.T @ axis * (1 if forward else -1) if motion.kind != "ball" else axis
        size = 3 if motion.kind == "ball" else 1
        motions.append(
            Motion(motion.name, motion.kind, direction, anchor, float(value[0]), np.zeros(size))
        )
    return motions if forward else motions[::-1]


def _with_speeds(
    motions: list[Motion], body: RigidBody, base: RigidBody, base_spin: np.ndarray
) -> tuple[list[Motion], np.ndarray]:
    """Motions with the speeds of the relative motion at the start."""
    lever = body.position - base.position
    velocity = body.velocity - base.velocity - np.cross(base_spin, lever)
    columns = [_columns(motion, body) for motion in motions]
    table = np.hstack([np.zeros((6, 0)), *columns])
    rows = slice(0, 6 if body.rotates else 3)
    relative = np.concatenate([velocity, body.spin - base_spin])[rows]
    speeds = np.linalg.lstsq(table[rows], relative, rcond=None)[0]
    parts = np.split(speeds, np.cumsum([c.shape[1] for c in columns])[:-1]) if columns else []
    moving = [
        Motion(m.name, m.kind, m.axis, m.anchor, m.value, part)
        for m, part in zip(motions, parts, strict=True)
    ]
    return moving, base_spin + table[3:] @ speeds


def _columns(motion: Motion, body: RigidBody) -> np.ndarray:
    """(6, k) velocity of the origin and angular velocity by unit speeds, inertial axes."""
    axis = body.axes if motion.kind == "ball" else (body.axes @ motion.axis)[:, None]
    if motion.kind == "slide":
        return np.vstack([axis, np.zeros((3, 1))])
    arm = -body.axes @ motion.anchor
    return np.vstack([np.cross(axis.T, arm).T, axis])
