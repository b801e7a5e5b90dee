"""Bending of a straight beam in one plane, common to all frame elements.

``φ = 12 E I/(G A_s L²)`` is the shear flexibility, zero for rigid shear. Stiffness and
interpolation are exact for a beam loaded at its ends (Przemieniecki, Theory of Matrix Structural
Analysis; Friedman and Kosmatka, Computers & Structures 47, 1993).
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

STATIONS, WEIGHTS = np.polynomial.legendre.leggauss(4)


@dataclass(frozen=True)
class Bending:
    """A beam in one plane.

    Parameters
    ----------
    length : ``L`` [m]
    rigidity : ``E I`` [N m²]
    softness : ``φ`` [-]
    """

    length: ca.SX
    rigidity: ca.SX
    softness: ca.SX

    def energy(self, first: ca.SX, second: ca.SX) -> ca.SX:
        """Strain energy from the rotations of the ends relative to the chord."""
        moments = self.moments(first, second)
        return (first * moments[0] + second * moments[1]) / 2

    def moments(self, first: ca.SX, second: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Moments at the ends, ``E I/(L (1+φ)) ((4+φ) θ + (2−φ) θ')``."""
        bend = self.rigidity / (self.length * (1 + self.softness))
        direct, mixed = 4 + self.softness, 2 - self.softness
        return bend * (direct * first + mixed * second), bend * (mixed * first + direct * second)

    def mean_deflection(self, first: ca.SX, second: ca.SX) -> ca.SX:
        """Mean distance of the bent axis from the chord, for any shear flexibility."""
        return self.length / 12 * (first - second)

    def bow(self, first: ca.SX, second: ca.SX) -> ca.SX:
        """Length of the bent axis minus that of the chord, ``½ ∫ w'² dx`` to second order."""
        phi = self.softness
        direct = (8 + 10 * phi + 5 * phi**2) / 60
        mixed = -(1 + 5 * phi + 5 * phi**2 / 2) / 30
        square = direct * (first**2 + second**2) + 2 * mixed * first * second
        return self.length / 2 * square / (1 + phi) ** 2

    def kinetic(self, ends, mass: ca.SX, inertia: ca.SX) -> ca.SX:
        """Kinetic energy.

        Parameters
        ----------
        ends : transverse velocity and angular velocity of the first end, then of the second
        mass : mass per length [kg/m]
        inertia : rotary inertia of the cross-section per length [kg m]
        """
        total = ca.SX(0)
        for station, weight in zip((1 + STATIONS) / 2, WEIGHTS / 2, strict=True):
            deflections, rotations = self._shapes(float(station))
            speed = sum(n * v for n, v in zip(deflections, ends, strict=True))
            spin = sum(n * v for n, v in zip(rotations, ends, strict=True))
            total += weight * self.length * (mass * speed**2 + inertia * spin**2) / 2
        return total

    def _shapes(self, s: float) -> tuple[list[ca.SX], list[ca.SX]]:
        """Deflection and rotation at ``s L`` for unit motions of the ends."""
        phi, length = self.softness, self.length
        bow = (2 * s**3 - 3 * s**2 - phi * s) / (1 + phi)
        deflections = [
            1 + bow,
            length / (1 + phi) * (s**3 - (2 + phi / 2) * s**2 + (1 + phi / 2) * s),
            -bow,
            length / (1 + phi) * (s**3 - (1 - phi / 2) * s**2 - phi / 2 * s),
        ]
        tilt = 6 * (s**2 - s) / ((1 + phi) * length)
        rotations = [
            tilt,
            (3 * s**2 - (4 + phi) * s) / (1 + phi) + 1,
            -tilt,
            (3 * s**2 - (2 - phi) * s) / (1 + phi),
        ]
        return deflections, rotations


def linear_kinetic(first: ca.SX, second: ca.SX, mass: ca.SX) -> ca.SX:
    """Kinetic energy of a total ``mass`` with linear velocity between two ends."""
    return mass / 6 * (ca.sumsqr(first) + ca.dot(first, second) + ca.sumsqr(second))
