"""Screw joint."""

from __future__ import annotations

import math
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Look, Scalar, quantity
from dalembert.elements.look import Nut
from dalembert.elements.pair import initial_value
from dalembert.elements.spatial.cylindrical import Cylindrical
from dalembert.elements.spatial.turn import Turn

SMALLEST_PITCH = 1e-12
"""Below, it is none [m]."""


@dataclass(eq=False)
class Screw(Cylindrical):
    """Nut on a spindle: a cylindrical joint whose displacement follows its turn.

    ``Φ = […; displacement − pitch · turn / 2π] = 0``, at any number of turns. The last multiplier
    is the axial force [N]. The frames coincide at no displacement if both have an x axis of their
    own; otherwise turn and displacement are counted from the initial poses.

    Parameters
    ----------
    pitch : displacement per full turn, negative of a left-hand thread [m]
    """

    pitch: Scalar = quantity("m", "displacement per full turn", keyword=True)

    def look(self) -> list[Look]:
        return [self.rail, Nut(self.frame_j, self.frame_i)]

    def residual(self) -> ca.SX:
        along = self.travel[2]
        if not self.complete:
            along -= initial_value(along, self.ends()).sx
        lead = self.pitch.sx / (2 * math.pi)
        late = Turn.of(along / lead).after(self.turn)
        return ca.vertcat(super().residual(), lead * late.angle)

    def units(self) -> list[str]:
        return [*super().units(), "m"]

    def conditions(self) -> list[Condition]:
        pitch = ca.fabs(self.pitch.sx) - SMALLEST_PITCH
        return [*super().conditions(), (pitch, "a screw needs a pitch; without one use Revolute")]
