"""Round and flat shapes in space."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, Look, option
from dalembert.elements.body import BodyElement
from dalembert.elements.contact.shapes import Ball, Flat, Hollow, Round
from dalembert.elements.frame import Frame
from dalembert.elements.spatial.contact.solids import Corners
from dalembert.elements.spatial.solids import Orb
from dalembert.errors import ModelError


@dataclass(eq=False)
class Sphere(Round):
    """Ball in space."""

    space = 3
    feels = (Ball, Corners)

    def look(self, near: ca.SX) -> list[Look]:
        return [Orb(self.point, self.radius.sx)]


@dataclass(eq=False)
class Socket(Hollow):
    """Hollow ball, with what touches it inside."""

    space = 3

    def look(self, near: ca.SX) -> list[Look]:
        return [Orb(self.point, self.radius.sx)]


@dataclass(eq=False)
class HalfSpace(Flat):
    """Matter below the x-y plane of a frame.

    Parameters
    ----------
    point : frame of a body; its z axis points out of the matter
    """

    space = 3
    point: Frame = option("frame whose z axis points out of the matter")

    def __post_init__(self) -> None:
        if isinstance(self.point, BodyElement):
            self.point = Frame(self.point)
        if not isinstance(self.point, Frame):
            raise ModelError(
                f"needs a frame of a body, e.g. ground.frame(axis=(0, 0, 1)); got {self.point!r}",
                "HalfSpace",
            )
        super().__post_init__()

    @property
    def outward(self) -> ca.SX:
        return self.point.axis

    @property
    def along(self) -> list[ca.SX]:
        return ca.horzsplit(self.point.local_axes[:, :2])

    def conditions(self) -> list[Condition]:
        return [*super().conditions(), *self.point.conditions()]
