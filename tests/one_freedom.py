"""Mechanisms of one freedom by their one equation, J(q) q'' + J'(q) q'^2 / 2 + V'(q) = Q."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

G = 9.81


def slope(function, q):
    """Derivative by the complex step."""
    return np.imag(function(q + 1e-30j)) / 1e-30


def reduced_motion(inertia, potential, q: float, speed: float, time: float) -> float:
    def rate(_, s):
        force = -slope(potential, s[0]) - slope(inertia, s[0]) * s[1] ** 2 / 2
        return s[1], force / np.real(inertia(s[0]))

    return solve_ivp(rate, (0, time), (q, speed), method="DOP853", rtol=1e-12, atol=1e-12).y[0, -1]


class FourBar:
    """Uniform bars; the coupler's end lies to the left of the line from crank pin to pivot O2."""

    def __init__(self, lengths, masses, pivot, side: int):
        self.l, self.m, self.pivot, self.side = lengths, masses, pivot, side

    def place(self, q):
        (a, b, c), (ox, oy) = self.l, self.pivot
        ax, ay = a * np.cos(q), a * np.sin(q)
        dx, dy = ox - ax, oy - ay
        square = dx * dx + dy * dy
        along = (square + b * b - c * c) / (2 * square)
        across = self.side * np.sqrt(b * b / square - along**2)
        return ax, ay, along * dx - across * dy, along * dy + across * dx

    def inertia(self, q):
        ax, ay, dx, dy = self.place(q)
        rx, ry = ax + dx - self.pivot[0], ay + dy - self.pivot[1]
        vx, vy = -ay, ax
        turn = dx * ry - dy * rx
        w2, w3 = -(vx * rx + vy * ry) / turn, -(vx * dx + vy * dy) / turn
        (a, b, c), (m1, m2, m3) = self.l, self.m
        coupler = (vx - w2 * dy / 2) ** 2 + (vy + w2 * dx / 2) ** 2 + (b * w2) ** 2 / 12
        return m1 * a * a / 3 + m2 * coupler + m3 * (c * w3) ** 2 / 3

    def potential(self, q):
        _, ay, _, dy = self.place(q)
        m1, m2, m3 = self.m
        return G * (m1 * ay / 2 + m2 * (ay + dy / 2) + m3 * (self.pivot[1] + ay + dy) / 2)


def slider_crank(q, r: float, l: float):
    """Distance of the slider from the crank shaft and its derivative by the crank angle."""
    root = np.sqrt(l * l - (r * np.sin(q)) ** 2)
    return r * np.cos(q) + root, -r * np.sin(q) * (1 + r * np.cos(q) / root)


def slider_crank_inertia(q, r, l, crank, rod, slider):
    x, dx = slider_crank(q, r, l)
    w = -r * np.cos(q) / (x - r * np.cos(q))
    middle = ((dx - r * np.sin(q)) / 2) ** 2 + (r * np.cos(q) / 2) ** 2
    return crank * r * r / 3 + rod * (middle + (l * w) ** 2 / 12) + slider * dx**2
