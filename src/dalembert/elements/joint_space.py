"""Joint coordinates: the motion that a joint leaves free, as coordinates of their own."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from dalembert.elements.coordinates import Coordinates
from dalembert.symbolic.formulas.expression import stack


class JointSpace(Coordinates):
    """The coordinates of one joint, or those of a group that no joint carries.

    Parameters
    ----------
    names, units : of the coordinates, names in full
    reading : SX of the poses of bodies, the value of the coordinates
    like : whose manifold they are, with names of speeds; that of numbers where not given

    Attributes
    ----------
    reading : SX of the poses of bodies
    """

    def __init__(
        self,
        names: Sequence[str],
        units: Sequence[str],
        reading: ca.SX,
        like: Coordinates | None = None,
    ):
        self.reading, self._like = reading, like or Coordinates()
        self.coordinate_names, self.coordinate_units = tuple(names), tuple(units)
        self.speed_names, self.speed_units = self.coordinate_names, self.coordinate_units
        if like is not None:
            self.speed_names = tuple(f"{like.name}.{n}" for n in like.speed_names)
            self.speed_units = like.speed_units
        self.pose = stack(ca.SX.sym(name) for name in names)
        self.twist = stack(ca.SX.sym(_rate_name(name, "d")) for name in self.speed_names)
        rates = (ca.SX.sym(_rate_name(name, "dd")) for name in self.speed_names)
        self.acceleration_symbols = stack(rates)
        self.pose_rate = self.twist
        if like is not None:
            known = ca.vertcat(like.pose, like.twist), ca.vertcat(self.pose, self.twist)
            self.pose_rate = ca.substitute(like.pose_rate, *known)

    @classmethod
    def of(cls, group: Coordinates, reading: ca.SX | None = None) -> JointSpace:
        """The coordinates of a group themselves, in symbols of their own."""
        names = [f"{group.name}.{n}" for n in group.coordinate_names]
        return cls(names, group.coordinate_units, group.pose if reading is None else reading, group)

    @property
    def flat(self) -> bool:
        return self._like.flat

    def retract(self, pose: ca.SX, displacement: ca.SX) -> ca.SX:
        return self._like.retract(pose, displacement)

    def displacement(self, pose: ca.SX, other: ca.SX) -> ca.SX:
        return self._like.displacement(pose, other)

    def bounds(self, pose: ca.SX) -> ca.SX:
        return self._like.bounds(pose)


def _rate_name(name: str, mark: str) -> str:
    owner, dot, own = name.rpartition(".")
    return f"{owner}{dot}{mark}{own}"
