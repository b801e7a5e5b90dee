"""What joints between frames share: the frames they hold on and the primitive constraints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.base import Constraint, Coordinates
from dalembert.elements.body import BodyElement
from dalembert.elements.frame import Frame
from dalembert.elements.pair import Pair, refuse_same_body
from dalembert.errors import ModelError


def need_frame(value: Any, owner: str, field: str) -> Frame:
    """Check that a joint was given a frame of a body."""
    if isinstance(value, BodyElement):
        return Frame(value)
    if not isinstance(value, Frame):
        raise ModelError(
            f"{field} must be a frame of a body, e.g. crank.frame((0, 0, 0.1), axis=(0, 0, 1)); "
            f"got {value!r}",
            owner,
        )
    return value


@dataclass(eq=False)
class FrameJoint(Pair, Constraint):
    """Constraint between a frame of one body and a frame of another.

    Parameters
    ----------
    frame_i, frame_j : frames of the first and the second body
    """

    frame_i: Frame
    frame_j: Frame

    def __post_init__(self) -> None:
        self.frame_i = need_frame(self.frame_i, self.name, "frame_i")
        self.frame_j = need_frame(self.frame_j, self.name, "frame_j")
        refuse_same_body(self.frame_i.body, self.frame_j.body, self.name)
        super().__post_init__()

    def ends(self) -> tuple[BodyElement, BodyElement]:
        return self.frame_i.body, self.frame_j.body

    def parts(self) -> list[Coordinates]:
        return list(self.ends())

    def place(self) -> ca.SX:
        return self.frame_j.position.sx

    @property
    def between(self) -> ca.SX:
        """Vector from the first to the second origin, inertial axes."""
        return self.frame_j.position.sx - self.frame_i.position.sx

    @property
    def tilt(self) -> ca.SX:
        """(2,) components of the second z axis along the first x and y axes; zero if parallel."""
        axes = self.frame_i.axes
        return ca.mtimes(axes[:, :2].T, self.frame_j.axis)
