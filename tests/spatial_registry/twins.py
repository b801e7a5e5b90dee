"""What twins see of bodies in space."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation


class Solid:
    """A moving body: mass centre ``r``, matrix ``R``, velocity ``v``, angular velocity ``w``."""

    def __init__(self, pose, twist, center):
        self.r, self.center = pose[:3], center
        turns = pose.size > 3
        self.R = Rotation.from_quat(np.roll(pose[3:], -1)).as_matrix() if turns else np.eye(3)
        self.v, self.w = twist[:3], self.R @ twist[3:] if turns else np.zeros(3)

    def at(self, local):
        return self.r + self.R @ (np.asarray(local) - self.center)

    def velocity_at(self, place):
        return self.v + np.cross(self.w, place - self.r)


class Numbers:
    """Parameter values; vectors by their name."""

    def __init__(self, model, p):
        self._values = dict(zip(model.parameters, np.asarray(p, float), strict=True))

    def __getattr__(self, name):
        values = self.__dict__["_values"]
        if name in values:
            return values[name]
        return np.array([values[f"{name}_{k}"] for k in "xyzuvw" if f"{name}_{k}" in values])


def context(model, time, y, v, p) -> SimpleNamespace:
    c = SimpleNamespace(t=time, p=Numbers(model, p), body={})
    i = j = 0
    for body in model.bodies:
        m, n = body.pose.numel(), body.twist.numel()
        center = c.p.__getattr__(f"{body.name}_c")
        center = center if center.size else np.zeros(3)
        c.body[body.name] = Solid(y[i : i + m], v[j : j + n], center)
        i, j = i + m, j + n
    vars(c).update(c.body)
    c.states = y[i:]
    return c


def P(c):
    return c.a.at(c.p.P)


def Q(c):
    return c.b.at(c.p.Q)


def frame_i(c):
    """Axes of the first frame as columns."""
    z, x = c.p.axis_i / np.linalg.norm(c.p.axis_i), c.p.x_i
    x = x - (x @ z) * z
    x = x / np.linalg.norm(x)
    return c.a.R @ np.column_stack([x, np.cross(z, x), z])


def frame_j(c):
    return c.b.R @ Rotation.from_euler("XYZ", c.p.turn_j).as_matrix()


def opposite(force, place, moment=(0.0, 0.0, 0.0)):
    """The wrench on b, and its reaction on a."""
    moment = np.asarray(moment)
    return [("b", force, place, moment), ("a", -force, place, -moment)]


def approach(c):
    """Direction from P to Q and the rate of their distance."""
    between = Q(c) - P(c)
    along = between / np.linalg.norm(between)
    return along, along @ (c.b.velocity_at(Q(c)) - c.a.velocity_at(P(c)))


def angle_of(c):
    """The angle of x_j about z_i, its rate, and its gradient by the angular velocity of b."""
    (x, y, _), turned = frame_i(c).T, frame_j(c)[:, 0]
    a, b = x @ turned, y @ turned
    slope = np.cross(turned, a * y - b * x) / (a**2 + b**2)
    return np.arctan2(b, a), slope @ (c.b.w - c.a.w), slope
