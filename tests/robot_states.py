"""States of mechanisms, mapped to the coordinates of exported files, with the terms of ours."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

import dalembert as da
from dalembert.symbolic.rotation import matrix


@dataclass
class Terms:
    """Our equations at a state: ``M v̇ + d = f``, ``C v̇ = ξ``."""

    y: np.ndarray
    v: np.ndarray
    a: np.ndarray
    mass: np.ndarray
    force: np.ndarray
    """``f − d``"""


class OurEquations:
    """Terms of the equations of a model without time dependence."""

    def __init__(self, model: da.Model):
        e = self.e = model.equations
        inputs = [e.t, e.y, e.v, e.p]
        terms = [e.mass, e.force - e.bias, e.jacobian, e.constraint_acceleration]
        self.terms = ca.Function("terms", inputs, [ca.densify(x) for x in terms])
        self.model, self.p = model, model.nominal

    def at(self, y: np.ndarray, rng: np.random.Generator) -> Terms:
        """Terms for random speeds that satisfy the constraints, and the accelerations."""
        values = self.terms(0.0, y, np.zeros(self.e.speed_count), self.p)
        jacobian = values[2].full()
        free = null_space(jacobian)
        v = free @ rng.normal(size=free.shape[1])
        mass, force, _, xi = (part.full() for part in self.terms(0.0, y, v, self.p))
        m = len(jacobian)
        system = np.block([[mass, jacobian.T], [jacobian, np.zeros((m, m))]])
        right = np.concatenate([force.ravel(), xi.ravel()])
        a = np.linalg.lstsq(system, right, rcond=None)[0][: len(v)]
        return Terms(y, v, a, mass, force.ravel())


def null_space(matrix_: np.ndarray) -> np.ndarray:
    """Orthonormal columns that a matrix annihilates."""
    if not matrix_.size:
        return np.eye(matrix_.shape[1])
    _, sizes, right = np.linalg.svd(matrix_)
    rank = int((sizes > 1e-9 * sizes.max(initial=0.0)).sum())
    return right[rank:].T


def split(model: da.Model, y: np.ndarray, v: np.ndarray, a: np.ndarray):
    """Name of a body → its coordinates, speeds, accelerations."""
    parts, row, column = {}, 0, 0
    for group in model.coordinates:
        n, k = group.pose.numel(), group.twist.numel()
        parts[group.name] = (y[row : row + n], v[column : column + k], a[column : column + k])
        row, column = row + n, column + k
    return parts


def axes_of(body, y: np.ndarray) -> np.ndarray:
    """(3, 3) axes of a body at coordinates."""
    if not body.rotates:
        return np.eye(3)
    if body.dimension == 2:
        c, s = np.cos(y[2]), np.sin(y[2])
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    return ca.evalf(matrix(ca.SX(ca.DM(y[3:7])))).full()


def positions(model: da.Model, count: int) -> list[np.ndarray]:
    """Coordinates along a short motion from the start."""
    try:
        motion = da.solve_dynamics(model, 0.1, step=0.1 / (2 * count), outputs=count)
        states = motion.trajectory.y.T
        if motion.status.success and np.all(np.isfinite(states)):
            return list(states)
    except da.DalembertError:
        pass
    return [model.start.y] * count
