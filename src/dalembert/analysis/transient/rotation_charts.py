"""Change of rotation vectors longer than π during a motion.

A rotation has many vectors, ``r`` and ``r − 2π r/|r|`` among them, and the map from their rates to
the spin is singular where ``|r| = 2π``. Vectors longer than π at the end of a step are replaced by
the shorter ones before the next step, with their rates and accelerations.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.transient.equation import EquationOfMotion
from dalembert.integrators.newmark.rule import Moving


class RotationCharts:
    """Spatial nodes with free rotations, on which no element counts whole turns.

    Parameters
    ----------
    equation : EquationOfMotion
    """

    def __init__(self, equation: EquationOfMotion):
        e, degrees = equation, equation.model.degrees
        eligible = np.ones(e.assembly.size, dtype=bool)
        eligible[e.held] = eligible[e.load_case.nodal.filled] = False
        for block in e.assembly.blocks:
            if block.kind.cls.counts_turns:
                eligible[block.degrees] = False
        table = degrees.table[:, degrees.dimension :]
        if e.linear or degrees.dimension < 3:
            table = table[:0]
        self.table = table[(table >= 0).all(axis=1) & eligible[table].all(axis=1)]
        """(nodes, 3) numbers of the rotations."""

    def long(self, u: np.ndarray) -> np.ndarray:
        """(k, 3) numbers of the rotations by more than π."""
        return self.table[np.linalg.norm(u[self.table], axis=1) > np.pi]

    def shorten(self, x: Moving, rotations: np.ndarray) -> Moving:
        """The same motion with the other vectors of rotations (k, 3); an involution."""
        return _with_columns(x, rotations, VALUE(_columns(x, rotations)))

    def push(self, x: Moving, rotations: np.ndarray, change: Moving) -> Moving:
        """Change of ``shorten`` with changes (n, columns)."""
        return self._linear(PUSH, x, rotations, change)

    def pull(self, x: Moving, rotations: np.ndarray, weights: Moving) -> Moving:
        """Weights of the motion from those (n, columns) of ``shorten``."""
        return self._linear(PULL, x, rotations, weights)

    def _linear(
        self, function: ca.Function, x: Moving, rotations: np.ndarray, tangent: Moving
    ) -> Moving:
        columns = _columns(tangent, rotations)
        at = np.repeat(_columns(x, rotations), tangent.u.shape[1], axis=1)
        return _with_columns(tangent, rotations, function(at, columns))


def _columns(x: Moving, rotations: np.ndarray) -> np.ndarray:
    """(12, k · columns) rotations with their rates, accelerations and memory."""
    return np.concatenate([part[rotations.T].reshape(3, -1) for part in x])


def _with_columns(x: Moving, rotations: np.ndarray, columns: ca.DM) -> Moving:
    copy = Moving(*(part.copy() for part in x))
    for part, rows in zip(copy, np.split(np.array(columns), 4), strict=True):
        part[rotations.T] = rows.reshape(part[rotations.T].shape)
    return copy


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
