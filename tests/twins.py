"""Textbook mechanics in plain NumPy, written independently of the package.

Everything here accepts complex numbers, so that derivatives can be taken by the complex step.
"""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
from scipy.interpolate import CubicSpline
from spatial_twins import Solid

CENTER = np.array([0.05, -0.03, 0.08])
"""Direction of the mass centre of registered bodies in space."""


def turn(angle, vector) -> np.ndarray:
    """Vector turned by an angle."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]])


def left(vector) -> np.ndarray:
    """Vector turned by +90°."""
    return np.array([-vector[1], vector[0]])


def cross(a, b):
    return a[0] * b[1] - a[1] * b[0]


def length(vector):
    return np.sqrt(vector[0] ** 2 + vector[1] ** 2)


def direction(vector):
    """Angle of a vector in (−π, π); analytic, unlike ``arctan2``."""
    x, y = vector
    return 2 * np.arctan(y / (length(vector) + x))


class Frame:
    """A moving body: mass centre ``r``, angle ``phi``, velocity ``v``, angular velocity ``w``."""

    def __init__(self, pose, speed=None):
        zero = np.zeros(3)
        pose = np.concatenate([pose, zero[len(pose) :]])
        speed = zero if speed is None else np.concatenate([speed, zero[len(speed) :]])
        self.r, self.phi = pose[:2], pose[2]
        self.v, self.w = speed[:2], speed[2]

    def at(self, local) -> np.ndarray:
        """Position of a point given in body coordinates."""
        return self.r + turn(self.phi, local)

    def vector(self, local) -> np.ndarray:
        """Inertial components of a vector given in body coordinates."""
        return turn(self.phi, local)

    def velocity_at(self, place) -> np.ndarray:
        """Velocity of the body at an inertial place."""
        return self.v + self.w * left(place - self.r)


def cubic(x, knots, values, end: str, derivative: bool = False):
    """SciPy's cubic spline at one abscissa, which may be complex."""
    spline = CubicSpline(knots, values, bc_type=end)
    span = knots[-1] - knots[0]
    x = x - span * np.floor((np.real(x) - knots[0]) / span) if end == "periodic" else x
    k = np.clip(np.searchsorted(knots, np.real(x), side="right") - 1, 0, len(knots) - 2)
    polynomial = spline.c[:, k]
    return np.polyval(np.polyder(polynomial) if derivative else polynomial, x - knots[k])


def not_a_knot_cubic(x, knots, values):
    """Cubic spline by its second derivatives at the knots; all may be complex."""
    knots, values = np.asarray(knots), np.asarray(values)
    h, last = np.diff(knots), len(knots) - 1
    slopes = np.diff(values) / h
    matrix, rhs = np.eye(last + 1, dtype=complex), np.zeros(last + 1, dtype=complex)
    for k in range(1, last):
        matrix[k, k - 1 : k + 2] = h[k - 1], 2 * (h[k - 1] + h[k]), h[k]
        rhs[k] = 6 * (slopes[k] - slopes[k - 1])
    matrix[0, :3] = h[1], -h[0] - h[1], h[0]  # one third derivative in the first two pieces
    matrix[last, -3:] = h[-1], -h[-1] - h[-2], h[-2]
    curved = np.linalg.solve(matrix, rhs)
    k = int(np.clip(np.searchsorted(np.real(knots), np.real(x), side="right") - 1, 0, last - 1))
    a, b = (knots[k + 1] - x) / h[k], (x - knots[k]) / h[k]
    bent = (a**3 - a) * curved[k] + (b**3 - b) * curved[k + 1]
    computed = a * values[k] + b * values[k + 1] + bent * h[k] ** 2 / 6
    return computed if np.imag(computed) else np.real(computed)


def complex_step(function: Callable, x: np.ndarray, step: float = 1e-30) -> np.ndarray:
    """Jacobian of a function of a vector, exact to round-off."""
    columns = []
    for k in range(x.size):
        moved = x.astype(complex)
        moved[k] += 1j * step
        columns.append(np.imag(np.atleast_1d(function(moved))) / step)
    return np.stack(columns, axis=-1)


def rate(function: Callable, step: float = 1e-30):
    """Derivative at zero of a function of a scalar."""
    return np.imag(np.atleast_1d(function(1j * step))) / step


def second_rate(function: Callable, h: float = 2e-3):
    """Second derivative at zero: complex step inside, Richardson differences outside."""

    def slope(at: float):
        return np.imag(np.atleast_1d(function(at + 1e-30j))) / 1e-30

    def central(d: float):
        return (slope(d) - slope(-d)) / (2 * d)

    coarse, middle, fine = central(h), central(h / 2), central(h / 4)
    first, second = (4 * middle - coarse) / 3, (4 * fine - middle) / 3
    return (16 * second - first) / 15


def bodies_of(model, y, v=None) -> dict:
    """The bodies of a model as frames, and the ground."""
    spatial = any(body.dimension == 3 for body in model.bodies)
    results, i, j = {"ground": Solid(np.zeros(3)) if spatial else Frame(np.zeros(3))}, 0, 0
    for group in model.coordinates:
        n, m = group.pose.numel(), group.twist.numel()
        kind = Solid if getattr(group, "dimension", 2) == 3 else Frame
        results[group.name] = kind(y[i : i + n], None if v is None else v[j : j + m])
        i, j = i + n, j + m
    return results


def context(model, t, y, p, v=None) -> SimpleNamespace:
    """What a twin sees: time, named parameters, named bodies, and the contact of a curve."""
    numbers = SimpleNamespace(**dict(zip(model.parameters, p, strict=True)))
    seen = SimpleNamespace(t=t, p=numbers, body=bodies_of(model, y, v))
    own = [g for g in model.coordinates if "." in g.name]
    if own:
        seen.u = y[-1]
    seen.states = y[len(y) - len(model.equations.states) :]
    for name, frame in seen.body.items():
        if hasattr(numbers, f"{name}_c"):
            frame.center = getattr(numbers, f"{name}_c") * CENTER
        if name.isidentifier():
            setattr(seen, name, frame)
    return seen
