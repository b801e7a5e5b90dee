"""Elements between a frame of one body and a frame or point of another."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca

from dalembert.elements.base import Condition, Element
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.fem.nodal import NodeLike
from dalembert.elements.frame import Frame
from dalembert.elements.pair import (
    initial_value,
    need_point,
    refuse_floating_frame,
    refuse_same_body,
)
from dalembert.elements.point import Point
from dalembert.errors import ModelError


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

    def relative_to(self, other: Turn) -> Turn:
        """This rotation relative to another one."""
        return Turn(
            self.cosine * other.cosine + self.sine * other.sine,
            self.sine * other.cosine - self.cosine * other.sine,
        )


def need_frame(value: Any, owner: str, field: str) -> Frame:
    """Check that an argument is a frame of a body; a body or a node stands for its body frame."""
    value = value.body if isinstance(value, NodeLike) else value
    if isinstance(value, BodyElement):
        refuse_floating_frame(value, owner, field)
        value = Frame(value)
    if not isinstance(value, Frame):
        raise ModelError(
            f"{field} must be a frame of a body, e.g. crank.frame((0, 0, 0.1), axis=(0, 0, 1)); "
            f"got {value!r}",
            owner,
        )
    if not value.body.rotates:
        raise ModelError(
            f"{value.body.name} is a particle and has no axes; use a Body, or a joint on points",
            owner,
        )
    return value


OPPOSITE = 1e-3
"""Weight of the angle between opposite axes in the initial angle."""
ALONG = 1e-6
"""Threshold of the squared component of an x axis normal to the other z axis: no angle below."""


@dataclass(eq=False)
class OnFrame(Element):
    """An element between a frame of one body and a point or frame of another.

    Parameters
    ----------
    frame_i : frame of the first body
    """

    frame_i: Frame

    def __post_init__(self) -> None:
        self.frame_i = need_frame(self.frame_i, self.name, "frame_i")
        self._check_end()
        refuse_same_body(*self.ends(), self.name)
        super().__post_init__()

    def _check_end(self) -> None:
        """Check the point or frame of the second body."""
        raise NotImplementedError

    @property
    def end(self) -> Point:
        """The point or frame of the second body."""
        raise NotImplementedError

    def ends(self) -> tuple[BodyElement, BodyElement]:
        return self.frame_i.body, self.end.body

    def parts(self) -> list[Coordinates]:
        return list(self.ends())

    @property
    def between(self) -> ca.SX:
        """Vector from the first origin to the second body's, inertial axes."""
        return self.end.position.sx - self.frame_i.position.sx

    @property
    def distance(self) -> ca.SX:
        """Distance of the origins."""
        return ca.sqrt(ca.sumsqr(self.between))

    @property
    def travel(self) -> ca.SX:
        """(3,) the vector between the origins in the axes of the first frame."""
        return ca.mtimes(self.frame_i.axes.T, self.between)


@dataclass(eq=False)
class FrameAndPoint(OnFrame):
    """An element between a frame and a point.

    Parameters
    ----------
    frame_i : frame of the first body
    point_j : point of the second body
    """

    point_j: Point

    def _check_end(self) -> None:
        self.point_j = need_point(self.point_j, self.name, "point_j")
        if self.point_j.dimension < 3:
            name = self.point_j.body.name
            raise ModelError(
                f"the point of {name} lies in a plane; give it three coordinates, "
                f"{name}.point(x, y, z)",
                self.name,
            )

    @property
    def end(self) -> Point:
        return self.point_j


@dataclass(eq=False)
class BetweenFrames(OnFrame):
    """An element between two frames.

    Parameters
    ----------
    frame_i, frame_j : frames of the first and the second body
    """

    frame_j: Frame

    def _check_end(self) -> None:
        self.frame_j = need_frame(self.frame_j, self.name, "frame_j")

    def conditions(self) -> list[Condition]:
        return [*super().conditions(), *self.frame_i.conditions(), *self.frame_j.conditions()]

    @property
    def end(self) -> Frame:
        return self.frame_j

    @property
    def tilt(self) -> ca.SX:
        """(2,) components of the second z axis along the first x and y axes; zero if parallel."""
        return ca.mtimes(self.frame_i.axes[:, :2].T, self.frame_j.axis)

    @property
    def parallel(self) -> ca.SX:
        """Cosine of the angle between the z axes."""
        return ca.dot(self.frame_i.axis, self.frame_j.axis)

    @cached_property
    def turn(self) -> Turn:
        """Rotation of the second x axis about the first z axis.

        It is measured from the first x axis if both x axes were specified, otherwise from the
        initial poses.
        """
        return self._turn if self.has_x_axes else self._turn.relative_to(self._initial_turn)

    @property
    def reference_angle(self) -> ca.SX:
        """Angle of the x axes at zero rotation."""
        return ca.SX(0) if self.has_x_axes else self._initial_turn.angle

    @property
    def _turn(self) -> Turn:
        """Rotation between the x axes."""
        return Turn(*ca.vertsplit(ca.mtimes(self.frame_i.axes[:, :2].T, self.frame_j.axes[:, 0])))

    @property
    def _initial_turn(self) -> Turn:
        """Rotation at the initial poses, whose z axes need not be parallel.

        If the second x axis is along the first z axis, the rotation after the shortest one that
        aligns the z axes is used. With ``R = A_iᵀ A_j`` its cosine and sine are proportional to
        ``R₁₁ + R₂₂`` and ``R₂₁ − R₁₂``, for opposite z axes to ``R₁₁ − R₂₂`` and ``R₂₁ + R₁₂``. A
        small weight of the latter covers both cases.
        """
        r = ca.mtimes(self.frame_i.axes.T, self.frame_j.axes)
        near, far = 1 + OPPOSITE, 1 - OPPOSITE
        determined = r[0, 0] ** 2 + r[1, 0] ** 2 > ALONG
        cosine = ca.if_else(determined, r[0, 0], near * r[0, 0] + far * r[1, 1])
        sine = ca.if_else(determined, r[1, 0], near * r[1, 0] - far * r[0, 1])
        return self.at_initial(Turn(cosine, sine))

    @property
    def has_x_axes(self) -> bool:
        """Whether the x axes of both frames were specified."""
        return self.frame_i.has_x_axis and self.frame_j.has_x_axis

    def from_initial(self, turn: Turn) -> Turn:
        """A rotation measured from the initial poses."""
        return turn.relative_to(self.at_initial(turn))

    def at_initial(self, turn: Turn) -> Turn:
        """A rotation at the initial poses."""
        start = initial_value(turn.pair, self.ends()).sx
        return Turn(*ca.vertsplit(start / ca.sqrt(ca.sumsqr(start))))
