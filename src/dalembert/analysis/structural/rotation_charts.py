"""Rotation vectors of a motion kept short.

A rotation has many vectors, ``r`` and ``r − 2π r/|r|`` among them, and where ``|r| = 2π`` their
rates no longer tell every spin. So what is longer than π at the end of a step is replaced before
the next one by the shorter vector, rates and accelerations along with it.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.structural.transient_equation import EquationOfMotion
from dalembert.integrators.newmark.rule import Moving


class RotationCharts:
    """Nodes of space that turn freely, held by nothing that counts their turns.

    Parameters
    ----------
    equation : EquationOfMotion
    """

    def __init__(self, equation: EquationOfMotion):
        e, degrees = equation, equation.model.degrees
        watched = np.ones(e.assembly.size, dtype=bool)
        watched[e.held] = watched[e.load_case.nodal.filled] = False
        for block in e.assembly.blocks:
            if block.kind.cls.counts_turns:
                watched[block.degrees] = False
        table = degrees.table[:, degrees.dimension :]
        if e.linear or degrees.dimension < 3:
            table = table[:0]
        self.table = table[(table >= 0).all(axis=1) & watched[table].all(axis=1)]
        """(nodes, 3) numbers of their rotations."""

    def long(self, u: np.ndarray) -> np.ndarray:
        """(k, 3) numbers of rotations by more than π."""
        return self.table[np.linalg.norm(u[self.table], axis=1) > np.pi]

    def shortened(self, x: Moving, where: np.ndarray) -> Moving:
        """The same motion with other vectors of rotations (k, 3); twice, it is what it was."""
        return _placed(x, where, VALUE(_columns(x, where)))

    def push(self, x: Moving, where: np.ndarray, change: Moving) -> Moving:
        """Change of ``shortened`` with changes (n, columns)."""
        return self._linear(PUSH, x, where, change)

    def pull(self, x: Moving, where: np.ndarray, weights: Moving) -> Moving:
        """Weights of the motion from those (n, columns) of ``shortened``."""
        return self._linear(PULL, x, where, weights)

    def _linear(self, function: ca.Function, x: Moving, where: np.ndarray, given: Moving) -> Moving:
        columns = _columns(given, where)
        at = np.repeat(_columns(x, where), given.u.shape[1], axis=1)
        return _placed(given, where, function(at, columns))


def _columns(x: Moving, where: np.ndarray) -> np.ndarray:
    """(12, k · columns) rotations of some nodes with rates, accelerations and memory."""
    return np.concatenate([part[where.T].reshape(3, -1) for part in x])


def _placed(x: Moving, where: np.ndarray, columns: ca.DM) -> Moving:
    found = Moving(*(part.copy() for part in x))
    for part, rows in zip(found, np.split(np.array(columns), 4), strict=True):
        part[where.T] = rows.reshape(part[where.T].shape)
    return found


def _functions() -> tuple[ca.Function, ca.Function, ca.Function]:
    """Rotation vector, rate, acceleration and memory of the shorter vector; both tangents."""
    x, w = ca.SX.sym("x", 12), ca.SX.sym("w", 12)
    r, v, a, s = ca.vertsplit(x, 3)
    shorter = r * (1 - 2 * ca.pi / ca.norm_2(r))
    rate = ca.jtimes(shorter, r, v)
    acceleration = ca.jtimes(rate, r, v) + ca.jtimes(shorter, r, a)
    memory = ca.jtimes(shorter, r, s)
    value = ca.vertcat(shorter, rate, acceleration, memory)
    return (
        ca.Function("shorter", [x], [value]),
        ca.Function("push", [x, w], [ca.jtimes(value, x, w)]),
        ca.Function("pull", [x, w], [ca.jtimes(value, x, w, True)]),
    )


VALUE, PUSH, PULL = _functions()
