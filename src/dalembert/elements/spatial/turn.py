"""Rotation about an axis by the cosine and sine of its angle."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca


@dataclass(frozen=True)
class Turn:
    """A rotation over any number of revolutions; only ``angle`` is discontinuous.

    Attributes
    ----------
    cosine, sine : of the angle, times a common positive factor
    """

    cosine: ca.SX
    sine: ca.SX

    @classmethod
    def of(cls, angle: ca.SX) -> Turn:
        """The rotation by an angle."""
        return cls(ca.cos(angle), ca.sin(angle))

    @property
    def pair(self) -> ca.SX:
        """(2,) cosine and sine."""
        return ca.vertcat(self.cosine, self.sine)

    @property
    def angle(self) -> ca.SX:
        """The angle in (−π, π]."""
        return ca.atan2(self.sine, self.cosine)

    def after(self, other: Turn) -> Turn:
        """This rotation relative to another one."""
        return Turn(
            self.cosine * other.cosine + self.sine * other.sine,
            self.sine * other.cosine - self.cosine * other.sine,
        )
