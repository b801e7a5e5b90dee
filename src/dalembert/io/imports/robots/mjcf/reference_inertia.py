"""Inertia that actuators of MJCF feel in the position of the file."""

from __future__ import annotations

import numpy as np

from dalembert.io.imports.robots.inertia import Inertia, combined
from dalembert.io.imports.robots.parts import BALL, FREE, SLIDING, Joint, Link
from dalembert.io.imports.robots.pose import Pose


class ReferenceInertia:
    """Mass matrix of a tree of links by composite bodies (Featherstone 2008, 6.2).

    ``M_ij = S_iᵀ I_j S_j`` for a joint i between the ground and the joint j, with the inertia
    ``I_j`` of all links behind j.

    Parameters
    ----------
    links : parents first
    poses : link → its pose
    """

    def __init__(self, links: list[Link], poses: dict[Link | None, Pose]):
        self.columns: dict[Joint, np.ndarray] = {}
        composite: dict[Link, list[Inertia]] = {link: [] for link in links}
        for link in reversed(links):
            composite[link].append(link.inertia.seen_from(poses[link]))
            if link.parent is not None:
                composite[link.parent].extend(composite[link])
        before: dict[Link | None, tuple[int, ...]] = {None: ()}
        motions: list[np.ndarray] = []
        for link in links:
            before[link] = before[link.parent]
            for joint in link.joints:
                subspace = _subspace(joint, poses[link])
                first = len(motions)
                motions.extend(subspace)
                self.columns[joint] = np.arange(first, len(motions))
                before[link] += tuple(range(first, len(motions)))
        self.matrix = np.zeros((len(motions), len(motions)))
        for link in links:
            spatial = _spatial(combined(composite[link]))
            for joint in link.joints:
                for j in self.columns[joint]:
                    momentum = spatial @ motions[j]
                    for i in before[link]:
                        self.matrix[i, j] = self.matrix[j, i] = motions[i] @ momentum
                    self.matrix[j, j] += joint.inertia

    def along(self, transmission: list[tuple[Joint, float]]) -> float:
        """``1/(a M⁻¹ aᵀ)``, the inertia along ``a v`` where all joints may move.

        Parameters
        ----------
        transmission : joints with their coefficients in a
        """
        row = np.zeros(len(self.matrix))
        for joint, coefficient in transmission:
            row[self.columns[joint]] += coefficient
        mobility = float(row @ np.linalg.lstsq(self.matrix, row, rcond=None)[0])
        return 1 / mobility if mobility > 0 else 0.0


def _subspace(joint: Joint, pose: Pose) -> list[np.ndarray]:
    """Angular velocity and velocity at the world's origin, one vector per free motion."""
    place = pose.at(joint.anchor)
    turns = [np.concatenate([axis, np.cross(place, axis)]) for axis in np.eye(3)]
    shifts = [np.concatenate([np.zeros(3), axis]) for axis in np.eye(3)]
    if joint.kind in (FREE, BALL):
        return shifts + turns if joint.kind == FREE else turns
    axis = pose.turned(joint.axis / np.linalg.norm(joint.axis))
    motions = shifts if joint.kind == SLIDING else turns
    return [sum((a * motion for a, motion in zip(axis, motions, strict=True)), np.zeros(6))]


def _spatial(own: Inertia) -> np.ndarray:
    """6×6 inertia about the world's origin."""
    x, y, z = own.mass * own.center
    first = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    arm = own.center
    tensor = own.tensor + own.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return np.block([[tensor, first], [first.T, own.mass * np.eye(3)]])
