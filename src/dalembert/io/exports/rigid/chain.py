"""A body of the tree as a chain of single joints, as URDF has them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from dalembert.io.exports.rigid.tree import TreeBody


@dataclass(frozen=True)
class Frame:
    """A rigid displacement.

    Attributes
    ----------
    place : (3,) origin
    axes : (3, 3)
    """

    place: np.ndarray
    axes: np.ndarray

    def then(self, other: Frame) -> Frame:
        """The other displacement, stated in the axes of this one."""
        return Frame(self.place + self.axes @ other.place, self.axes @ other.axes)

    @classmethod
    def shift(cls, vector: np.ndarray) -> Frame:
        """A translation."""
        return cls(vector, np.eye(3))


@dataclass(frozen=True)
class ChainJoint:
    """A joint with the frame of its child at its place.

    Attributes
    ----------
    kind : ``"hinge"``, ``"slide"``, ``"free"`` or ``"fixed"``
    origin : frame of the child in that of its parent, at coordinate zero
    axis : (3,) in the frame of the child
    value : coordinate at the start
    """

    name: str
    kind: str
    origin: Frame
    axis: np.ndarray
    value: float


@dataclass(frozen=True)
class Chain:
    """Joints from the link of a carrier to that of a body.

    Attributes
    ----------
    offset : (3,) origin of the body in the frame of its link, which has the axes of the body
    """

    joints: list[ChainJoint]
    offset: np.ndarray


def chain_of(body: TreeBody, carrier_offset: np.ndarray) -> Chain:
    """The chain of a body.

    The pose of the body is a product of displacements, ``X = X₀ M₁(q₁ − v₁) M₂(q₂ − v₂) …`` with
    ``M(q − v) = M(−v) M(q)`` and rotations about a point ``a``, ``T(a) R(q) T(−a)``.
    """
    start = Frame.shift(carrier_offset).then(Frame(body.position, body.axes))
    joints: list[ChainJoint] = []
    anchor = np.zeros(3)
    for name, kind, axis, place, value in _single(body):
        before = start.then(Frame.shift(-anchor)) if not joints else Frame.shift(-anchor)
        if kind == "hinge":
            turn = Rotation.from_rotvec(-value * axis).as_matrix()
            before = before.then(Frame.shift(place)).then(Frame(np.zeros(3), turn))
            anchor = place
        else:
            before, anchor = before.then(Frame.shift(-value * axis)), np.zeros(3)
        joints.append(ChainJoint(name, kind, before, axis, value))
    if not joints:
        joints.append(ChainJoint(body.joint or body.name, "fixed", start, np.eye(3)[0], 0.0))
    return Chain(joints, -anchor)


def _single(body: TreeBody) -> Iterator[tuple[str, str, np.ndarray, np.ndarray, float]]:
    """Name, kind, axis, anchor and value of single motions; a ball is three hinges."""
    for motion in body.motions:
        if motion.kind == "ball":
            for letter, axis in zip("xyz", np.eye(3), strict=True):
                yield f"{motion.name}.{letter}", "hinge", axis, motion.anchor, 0.0
        else:
            yield motion.name, motion.kind, motion.axis, motion.anchor, motion.value
