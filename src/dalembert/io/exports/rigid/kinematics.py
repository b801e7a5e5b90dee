"""Positions of a tree of rigid bodies by its coordinates, and affine formulas of these."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.io.exports.rigid.tree import Motion, RigidTree, TreeBody
from dalembert.symbolic import rotation
from dalembert.symbolic.formulas.expression import stack, t

SAMPLES = (0.0, 0.37, -0.22)
"""Displacements from the start at which derivatives must agree."""
ROUNDING = 1e-9
"""Threshold for equal derivatives."""


@dataclass(frozen=True, eq=False)
class Pose:
    """Pose of a body as formulas of the coordinates.

    Attributes
    ----------
    place, euler, angle : SX position, Euler parameters, and the angle of planar motions
    """

    place: ca.SX
    euler: ca.SX
    angle: ca.SX

    @property
    def axes(self) -> ca.SX:
        """(3, 3)"""
        return rotation.matrix(self.euler)


@dataclass(frozen=True)
class Affine:
    """Affine formulas ``coefficients q + constant`` of hinges and slides.

    Attributes
    ----------
    coefficients : (rows, motions), zero for balls and free bodies
    constant : (rows,)
    """

    coefficients: np.ndarray
    constant: np.ndarray


class TreeKinematics:
    """Poses of all bodies of a tree as formulas of its coordinates.

    Parameters
    ----------
    tree : RigidTree

    Attributes
    ----------
    q : SX symbols of each motion: one, four Euler parameters, or these after a position
    """

    def __init__(self, tree: RigidTree):
        self.tree = tree
        sizes = {"ball": 4, "free": 7}
        self.q = [ca.SX.sym(m.name, sizes.get(m.kind, 1)) for m in tree.motions]
        ground = Pose(ca.SX.zeros(3), ca.SX(list(rotation.IDENTITY)), ca.SX(0))
        self.poses = {"ground": ground}
        symbols = iter(self.q)
        for body in tree.bodies:
            self.poses[body.name] = self._pose(body, [next(symbols) for _ in body.motions])

    def _pose(self, body: TreeBody, q: list[ca.SX]) -> Pose:
        base = self.poses[body.parent]
        turn = rotation.from_matrix(ca.SX(ca.DM(body.axes)))
        relative_angle = float(np.arctan2(body.axes[1, 0], body.axes[0, 0]))
        pose = Pose(
            base.place + ca.mtimes(base.axes, ca.DM(body.position)),
            rotation.product(base.euler, turn),
            base.angle + relative_angle,
        )
        for motion, symbol in zip(body.motions, q, strict=True):
            pose = _moved(pose, motion, symbol)
        return pose

    @cached_property
    def _motion_symbols(self) -> ca.SX:
        """Symbols of the coordinates; those of balls and free bodies are replaced by the first."""
        return stack(self.q)

    @property
    def at_start(self) -> np.ndarray:
        """Values of all coordinates at the start."""
        parts = []
        for body in self.tree.bodies:
            for motion in body.motions:
                if motion.kind == "ball":
                    parts.append(np.array(rotation.IDENTITY))
                elif motion.kind == "free":
                    euler = rotation.from_matrix(ca.SX(ca.DM(body.axes)))
                    quaternion = np.array(ca.evalf(euler)).ravel()
                    parts.append(np.concatenate([body.position, quaternion]))
                else:
                    parts.append(np.array([motion.value]))
        return np.concatenate([np.zeros(0), *parts])

    def by_coordinates(self, formula: ca.SX) -> ca.SX:
        """A formula of poses as one of the coordinates, with numbers for the parameters."""
        model = self.tree.start.model
        symbols, values = [], []
        for body in model.bodies:
            pose, place = self.poses[body.name], self.poses[body.name].place
            if body.dimension == 2:
                column = ca.vertcat(place[:2], pose.angle)[: 3 if body.rotates else 2]
            else:
                center = ca.DM(self.tree.start.bodies[body.name].center)
                place = place + ca.mtimes(pose.axes, center)
                column = ca.vertcat(place, pose.euler) if body.rotates else place
            symbols.append(body.pose)
            values.append(column)
        formula = self.tree.start.by_parameters(formula)
        return ca.substitute(formula, stack(symbols), stack(values))

    def affine(self, formula: ca.SX, others: ca.SX | None = None) -> Affine | None:
        """A formula of positions as an affine one; None if it is not.

        Parameters
        ----------
        others : additional coordinates in it, which are eliminated
        """
        column = self.by_coordinates(formula)
        extra = ca.SX(0, 1) if others is None else others
        q = self._motion_symbols
        variables = ca.vertcat(q, extra)
        if not column.numel() or ca.depends_on(column, t.sx):
            return None
        jacobian = ca.densify(ca.jacobian(column, variables))
        unknown = [s for s in ca.symvar(column) if not ca.depends_on(variables, s)]
        if unknown:
            return None
        function = ca.Function("affine", [variables], [jacobian, column])
        start = np.concatenate([self.at_start, np.zeros(extra.numel())])
        shifts = [s * np.cos(np.arange(start.size) + 1.0) for s in SAMPLES]
        results = [[part.full() for part in function(start + shift)] for shift in shifts]
        tables = np.array([table for table, _ in results])
        scale = np.abs(tables[0]).max(initial=0.0)
        if not np.all(np.isfinite(tables)) or np.ptp(tables, axis=0).max() > ROUNDING * scale:
            return None
        own, rest = tables[0][:, : q.numel()], tables[0][:, q.numel() :]
        constant = results[0][1].ravel() - tables[0] @ start
        if rest.size:
            free = _left_null_space(rest)
            own, constant = free @ own, free @ constant
        places = np.cumsum([0, *(s.numel() for s in self.q)])[:-1]
        single = [k for k, s in enumerate(self.q) if s.numel() == 1]
        kept = own[:, places[single]]
        if np.abs(own).sum() > np.abs(kept).sum() + ROUNDING * scale:
            return None
        table = np.zeros((len(kept), len(self.q)))
        table[:, single] = kept
        return Affine(np.where(np.abs(table) > ROUNDING * scale, table, 0.0), constant)


def _left_null_space(matrix: np.ndarray) -> np.ndarray:
    """Rows that annihilate the columns of a matrix."""
    left, sizes, _ = np.linalg.svd(matrix)
    rank = int((sizes > 1e-12 * sizes.max(initial=1.0)).sum())
    return left[:, rank:].T


def _moved(pose: Pose, motion: Motion, q: ca.SX) -> Pose:
    """The pose after a motion."""
    if motion.kind == "free":
        return Pose(q[:3], q[3:], ca.SX(0))
    if motion.kind == "slide":
        along = ca.mtimes(pose.axes, ca.DM(motion.axis))
        return Pose(pose.place + along * (q - motion.value), pose.euler, pose.angle)
    turn, angle = q, pose.angle
    if motion.kind == "hinge":
        half = (q - motion.value) / 2
        turn = ca.vertcat(ca.cos(half), ca.DM(motion.axis) * ca.sin(half))
        angle = pose.angle + (q - motion.value) * float(motion.axis[2])
    anchor = pose.place + ca.mtimes(pose.axes, ca.DM(motion.anchor))
    euler = rotation.product(pose.euler, turn)
    place = anchor - ca.mtimes(rotation.matrix(euler), ca.DM(motion.anchor))
    return Pose(place, euler, angle)
