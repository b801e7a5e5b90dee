"""Textbook mechanics of bodies in space, in plain NumPy; everything accepts complex numbers."""

from __future__ import annotations

import numpy as np


def skew(a) -> np.ndarray:
    """``ã`` with ``ã b = a × b``."""
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


def cross(a, b) -> np.ndarray:
    return skew(a) @ b


def norm(a):
    """Length of a vector, analytic."""
    return np.sqrt(np.sum(np.asarray(a) ** 2))


def unit(a) -> np.ndarray:
    return np.asarray(a) / norm(a)


def wrapped(cosine, sine):
    """The angle of a cosine and a sine in (−π, π); analytic, unlike ``arctan2``."""
    return 2 * np.arctan(sine / (np.sqrt(cosine**2 + sine**2) + cosine))


def about(axis, angle) -> np.ndarray:
    """Euler parameters of a turn about an axis."""
    return np.concatenate([[np.cos(angle / 2)], np.sin(angle / 2) * unit(axis)])


def product(a, b) -> np.ndarray:
    """Hamilton's product of quaternions."""
    left = np.block([[a[0], -a[1:][None]], [a[1:][:, None], a[0] * np.eye(3) + skew(a[1:])]])
    return left @ b


def rotation(e) -> np.ndarray:
    """Rotation matrix by Euler and Rodrigues, ``(e0² − e·e) 1 + 2 e eᵀ + 2 e0 ẽ``."""
    w, a = e[0], e[1:]
    return (w * w - a @ a) * np.eye(3) + 2 * np.outer(a, a) + 2 * w * skew(a)


class Solid:
    """A moving body: mass centre ``r``, Euler parameters ``e``, velocity ``v`` and own ``spin``.

    ``center`` is the mass centre in the body frame.
    """

    def __init__(self, pose, speed=None):
        self.r, self.e = pose[:3], pose[3:] if len(pose) > 3 else about((0, 0, 1), 0.0)
        speed = np.zeros(6) if speed is None else speed
        self.v, self.spin = speed[:3], speed[3:] if len(speed) > 3 else np.zeros(3)
        self.center = np.zeros(3)
        self.R = rotation(self.e)

    @property
    def w(self) -> np.ndarray:
        """Angular velocity in inertial axes."""
        return self.R @ self.spin

    def at(self, local) -> np.ndarray:
        """Position of a point given in the body frame."""
        return self.r + self.R @ (np.asarray(local) - self.center)

    def vector(self, local) -> np.ndarray:
        """Inertial components of a vector given in body axes."""
        return self.R @ np.asarray(local)

    def velocity_at(self, place) -> np.ndarray:
        """Velocity of the body at an inertial place."""
        return self.v + cross(self.w, place - self.r)


class Hold:
    """A frame fixed in a body: its origin ``o`` and axes ``x``, ``y``, ``z``, inertial."""

    def __init__(self, body: Solid, place, axis, x=None):
        z = unit(axis)
        if x is None:
            across = chosen(z)
        else:
            across = unit(np.asarray(x) - (np.asarray(x) @ z) * z)
        self.o = body.at(place)
        self.x, self.y, self.z = map(body.vector, (across, cross(z, across), z))


def chosen(z) -> np.ndarray:
    """The x axis of an orthonormal basis about z (Duff et al. 2017)."""
    sign = -1.0 if np.real(z[2]) < 0 else 1.0
    return np.array(
        [1 - sign * z[0] ** 2 / (sign + z[2]), -sign * z[0] * z[1] / (sign + z[2]), -sign * z[0]]
    )


def moved(model, y, step) -> np.ndarray:
    """The position a displacement leads to, by adding it or turning the Euler parameters."""
    solutions, i, j = [], 0, 0
    for group in model.coordinates:
        n, m = group.pose.numel(), group.twist.numel()
        pose, short = y[i : i + n], step[j : j + m]
        if n == m or not m:  # states of first order have no displacement
            solutions.append(pose + short if m else pose)
        else:
            turned = product(pose[3:], np.concatenate([[1.0], short[3:] / 2]))
            solutions += [pose[:3] + short[:3], unit(turned)]
        i, j = i + n, j + m
    return np.concatenate(solutions) if solutions else y
