"""A twin of random trees and loops in space: NumPy for the equations, SciPy for the motion.

Bodies keep all six freedoms. Each joint states scalar products of points and axes that stay zero;
accelerations are Gauss's least constraint, so that redundant joints need no choice.
"""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from spatial_trees import PITCH, SpatialTree
from spatial_twins import rotation, skew

AXES = ((0, 1), (1, 2), (2, 0))
TILT = ((0, 2), (1, 2))
ROWS = {
    "Revolute": ("xyz", TILT),
    "Spherical": ("xyz", ()),
    "Prismatic": ("01", AXES),
    "Cylindrical": ("01", TILT),
    "Screw": ("01", TILT),
    "Universal": ("xyz", ((2, 2),)),
    "Planar": ("2", TILT),
    "Weld": ("xyz", AXES),
}
"""Of each joint: components of the distance (``x``, ``y``, ``z`` at rest, digits along the first
frame's axes), and which axes of the two frames stay perpendicular."""


class SpatialTreeTwin:
    """Equations of motion of a ``SpatialTree``.

    A state holds position of the mass centre, Euler parameters, velocity and angular velocity
    (inertial axes) of each body.
    """

    def __init__(self, tree: SpatialTree):
        self.tree, self.count = tree, len(tree.solids)

    def motion(self, position, euler, velocity, spin, duration: float) -> np.ndarray:
        """(13, count) state after a duration, from (count, 3 or 4) arrays as a result has them."""
        start = self.state(position, euler, velocity, spin)
        done = solve_ivp(self.rate, (0, duration), start.ravel(), "DOP853", rtol=1e-10, atol=1e-11)
        assert done.success, done.message
        x = done.y[:, -1].reshape(self.count, 13)
        arms = self.arms(x[:, 3:7])
        velocity = x[:, 7:10] - np.cross(x[:, 10:], arms)
        return np.hstack([x[:, :3] - arms, x[:, 3:7], velocity, x[:, 10:]])

    def arms(self, euler) -> np.ndarray:
        """From the origins of the bodies to their mass centres."""
        centres = [centre for _, centre, _ in self.tree.solids]
        return np.array([rotation(e) @ c for e, c in zip(euler, centres, strict=True)])

    def state(self, position, euler, velocity, spin) -> np.ndarray:
        arms = self.arms(euler)
        return np.hstack([position + arms, euler, velocity + np.cross(spin, arms), spin])

    def constraints_at(self, position, euler, velocity, spin) -> tuple[np.ndarray, ...]:
        """``constraints`` at positions and velocities of the origins."""
        self._see(self.state(position, euler, velocity, spin))
        return self.constraints()

    def _see(self, x: np.ndarray) -> None:
        turned = (rotation(e / np.linalg.norm(e)) for e in x[:, 3:7])
        self.x, self.R = x, [np.eye(3), *turned]

    def rate(self, t: float, x: np.ndarray) -> np.ndarray:
        x = x.reshape(self.count, 13)
        turned = [quaternion_rate(e, w) for e, w in zip(x[:, 3:7], x[:, 10:], strict=True)]
        acceleration = self.acceleration(x).reshape(self.count, 6)
        return np.hstack([x[:, 7:10], turned, acceleration]).ravel()

    def acceleration(self, x: np.ndarray) -> np.ndarray:
        """``M a + Cᵀ λ = f, C a = ξ``."""
        self._see(x)
        inverse, free = np.zeros((6 * self.count,) * 2), np.zeros(6 * self.count)
        force = self.forces()
        for k, (mass, _, inertia) in enumerate(self.tree.solids):
            w, J = x[k, 10:], self.R[k + 1] @ inertia @ self.R[k + 1].T
            at = slice(6 * k, 6 * k + 3), slice(6 * k + 3, 6 * k + 6)
            inverse[at[0], at[0]] = np.eye(3) / mass
            inverse[at[1], at[1]] = np.linalg.inv(J)
            force[at[0]] += mass * self.tree.gravity
            force[at[1]] -= np.cross(w, J @ w)
        free = inverse @ force
        C, xi, _, _ = self.constraints()
        if not len(xi):
            return free
        multiplier = np.linalg.lstsq(C @ inverse @ C.T, C @ free - xi, rcond=1e-11)[0]
        return free - inverse @ C.T @ multiplier

    def constraints(self) -> tuple[np.ndarray, ...]:
        """``C``, ``ξ``, what is left of velocities ``C v``, and of positions."""
        rows = [row for joint in self.tree.joined for row in self.joint(*joint)]
        C = np.array([row for row, *_ in rows]).reshape(-1, 6 * self.count)
        return C, *(np.array([row[k] for row in rows]) for k in (1, 2, 3))

    def joint(self, kind, i, j, local_i, axes_i, local_j, axes_j):
        """Rows of ``C``, ``ξ``, ``C v`` and ``Φ``."""
        p, q = self.point(i, local_i), self.point(j, local_j)
        d = [b - a for a, b in zip(p, q, strict=True)]
        a, b = self.axes(i, axes_i), self.axes(j, axes_j)
        along, crossed = ROWS[kind]
        for k, one in enumerate(along):
            if one in "xyz":
                yield d[3][k], -d[2][k], d[1][k], d[0][k]
            else:
                yield product(a[int(one)], d)
        for k, m in crossed:
            yield product(a[k], b[m])
        if kind == "Screw":
            yield self.thread(i, j, product(a[2], d), a[2])

    def thread(self, i, j, travel, axis):
        """The displacement follows the turn; what full turns it is off is free."""
        lead, zero = PITCH / (2 * np.pi), np.zeros((3, 6 * self.count))
        spin = self.spin(j) - self.spin(i)
        turn = zero.copy()
        for n, sign in ((j, 1), (i, -1)):
            if n:
                turn[:, 6 * n - 3 : 6 * n] += sign * np.eye(3)
        row = travel[0] - lead * axis[0] @ turn
        xi = travel[1] + lead * axis[1] @ spin
        return row, xi, travel[2] - lead * axis[0] @ spin, 0.0

    def spin(self, n: int) -> np.ndarray:
        return self.x[n - 1, 10:] if n else np.zeros(3)

    def point(self, n: int, local):
        """Place, velocity, acceleration at zero v̇, and how it follows the speeds."""
        moves, local = np.zeros((3, 6 * self.count)), np.asarray(local, dtype=float)
        if n == 0:
            return local, np.zeros(3), np.zeros(3), moves
        arm, w = self.R[n] @ (local - self.tree.solids[n - 1][1]), self.spin(n)
        moves[:, 6 * n - 6 : 6 * n] = np.hstack([np.eye(3), -skew(arm)])
        x = self.x[n - 1]
        return x[:3] + arm, x[7:10] + np.cross(w, arm), np.cross(w, np.cross(w, arm)), moves

    def axes(self, n: int, local):
        """The same of the three axes of a frame."""
        return [self.axis(n, self.R[n] @ local[:, k]) for k in range(3)]

    def axis(self, n: int, a):
        moves, w = np.zeros((3, 6 * self.count)), self.spin(n)
        if n:
            moves[:, 6 * n - 3 : 6 * n] = -skew(a)
        return a, np.cross(w, a), np.cross(w, np.cross(w, a)), moves

    def forces(self) -> np.ndarray:
        """Of springs with dampers."""
        total = np.zeros(6 * self.count)
        for i, j, at_i, at_j, stiffness, damping, free in self.tree.sprung:
            p, q = self.point(i, at_i), self.point(j, at_j)
            d = q[0] - p[0]
            length = np.linalg.norm(d)
            tension = stiffness * (length - free) + damping * (d @ (q[1] - p[1])) / length
            total -= (q[3] - p[3]).T @ (tension * d / length)
        return total


def product(a, b):
    """A scalar product: its row of ``C``, ``ξ``, its rate and itself."""
    row = b[0] @ a[3] + a[0] @ b[3]
    drift = a[2] @ b[0] + 2 * a[1] @ b[1] + a[0] @ b[2]
    return row, -drift, a[1] @ b[0] + a[0] @ b[1], a[0] @ b[0]


def quaternion_rate(e, w):
    """``ė = ½ (0, ω) e``."""
    return 0.5 * np.concatenate([[-w @ e[1:]], e[0] * w + np.cross(w, e[1:])])
