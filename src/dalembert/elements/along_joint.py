"""Forces along a motion that a joint leaves free: friction, actuators."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.base import Constraint, Coordinates, ForceElement, Powers, Rate
from dalembert.errors import ModelError


class AlongJoint(ForceElement):
    """A force or moment along one of the free motions of a joint."""

    name: str
    joint: Constraint
    motion: str | None

    def __post_init__(self) -> None:
        super().__post_init__()
        free = self.joint.freedoms() if isinstance(self.joint, Constraint) else {}
        if not free:
            raise ModelError(
                f"joint must leave a motion free, as a revolute does; got {self.joint!r}", self.name
            )
        if self.motion is None:
            self.motion = next(iter(free))
        if self.motion not in free:
            raise ModelError(
                f"{self.joint.name} has no motion {self.motion!r}; it has {', '.join(free)}",
                self.name,
            )
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
