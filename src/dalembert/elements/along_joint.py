"""Forces along a motion that a joint leaves free: friction, actuators."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import casadi as ca

from dalembert.elements.base import Constraint, ForceElement, Powers, Rate
from dalembert.elements.coordinates import Coordinates
from dalembert.errors import ModelError


def free_motion(
    joint: Any, free: Mapping[str, Any], motion: str | None, owner: str, what: str = "motion"
) -> str:
    """The motion meant, the first where none is named, of those that a joint leaves free.

    Raises
    ------
    ModelError
        It leaves none free, or not this one.
    """
    if not free:
        given = f"{type(joint).__name__} {joint.name}" if isinstance(joint, Constraint) else joint
        raise ModelError(f"joint must leave a {what} free; got {given!s}", owner)
    if motion is not None and motion not in free:
        raise ModelError(f"{joint.name} has no {what} {motion!r}; it has {', '.join(free)}", owner)
    return motion or next(iter(free))


class AlongJoint(ForceElement):
    """A force or moment along one of the free motions of a joint."""

    name: str
    joint: Constraint
    motion: str | None

    def __post_init__(self) -> None:
        super().__post_init__()
        free = self.joint.freedoms() if isinstance(self.joint, Constraint) else {}
        self.motion = free_motion(self.joint, free, self.motion, self.name)
        self.sliding, self.sliding_unit = free[self.motion]

    def effort(self, speed: ca.SX) -> ca.SX:
        """Force or moment along the motion, at its speed."""
        raise NotImplementedError

    def powers(self, rate: Rate) -> Powers:
        speed = rate(self.sliding)
        return [(speed, self.effort(speed))]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        speed, turns = rate(self.sliding), self.sliding_unit == "rad"
        return {
            "moment" if turns else "force": (self.effort(speed), "N m" if turns else "N"),
            "rate": (speed, f"{self.sliding_unit}/s"),
        }

    def parts(self) -> list[Coordinates]:
        return self.joint.parts()
