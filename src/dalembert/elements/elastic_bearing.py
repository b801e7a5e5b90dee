"""Elastic bearings: springs and dampers along several coordinates."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.base import ForceElement, Powers, Rate, Scalar, Vector


class ElasticBearing(ForceElement):
    """``Q = −(k s + c ṡ)`` along every entry of a deformation ``s``: displacements, then rotations.

    A new bearing implements ``deformation``.
    """

    stiffness: Vector
    damping: Vector
    rotational_stiffness: Scalar
    rotational_damping: Scalar

    def deformation(self) -> ca.SX:
        """Displacements [m], one per entry of ``stiffness``, and rotations [rad]."""
        raise NotImplementedError

    def _stiffness(self) -> ca.SX:
        return ca.vertcat(self.stiffness.sx, self.rotational_stiffness.sx)

    def _damping(self) -> ca.SX:
        return ca.vertcat(self.damping.sx, self.rotational_damping.sx)

    def _efforts(self, rate: Rate) -> ca.SX:
        s = self.deformation()
        return self._stiffness() * s + self._damping() * rate(s)

    def powers(self, rate: Rate) -> Powers:
        return [(rate(self.deformation()), -self._efforts(rate))]

    def potential(self) -> ca.SX:
        return ca.dot(self._stiffness(), self.deformation() ** 2) / 2

    def dissipation(self, rate: Rate) -> Powers:
        speed = rate(self.deformation())
        return [(speed, -self._damping() * speed)]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        n = self.stiffness.sx.numel()
        s, efforts = self.deformation(), self._efforts(rate)
        return {
            "deflection": (s[:n], "m"),
            "turn": (s[n:], "rad"),
            "force": (efforts[:n], "N"),
            "moment": (efforts[n:], "N m"),
        }
