"""What was given of the initial state, coordinate by coordinate."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.model.description import Description
from dalembert.symbolic.formulas.expression import stack


@dataclass
class Guesses:
    """Initial values, formulas where given and None where missing, with names and units.

    Attributes
    ----------
    pose, names, units : by coordinate
    rest : pose in the origin
    twist : by speed, formulas of the pose, too
    speed_names, speed_units, owners : by speed, so by displacement; units of displacements
    given : by displacement, whether the place along it was given
    angles : by displacement, whether it is an angle, the same after a whole turn
    pose_owners : by coordinate
    """

    pose: list = field(default_factory=list)
    twist: list = field(default_factory=list)
    given: list[bool] = field(default_factory=list)
    angles: list[bool] = field(default_factory=list)
    names: list[str] = field(default_factory=list)
    units: list[str] = field(default_factory=list)
    pose_owners: list[str] = field(default_factory=list)
    speed_names: list[str] = field(default_factory=list)
    speed_units: list[str] = field(default_factory=list)
    owners: list[str] = field(default_factory=list)
    rest: list[float] = field(default_factory=list)
    _places: ca.Function = None  # type: ignore[assignment]
    _speeds: ca.Function = None  # type: ignore[assignment]

    @classmethod
    def collect(cls, d: Description) -> Guesses:
        made = cls()
        for group in d.coordinates:
            pose, twist = group.guesses()
            made.pose += pose
            made.twist += twist
            made.given += group.specified()
            made.angles += [group.flat and unit == "rad" for unit in group.speed_units]
            made.names += [f"{group.name}.{n}" for n in group.coordinate_names]
            made.units += list(group.coordinate_units)
            made.pose_owners += [group.name] * len(pose)
            made.speed_names += [f"{group.name}.{n}" for n in group.speed_names]
            made.speed_units += list(group.speed_units)
            made.owners += [group.name] * len(twist)
            made.rest += list(group.rest)
        parameters = d.space.symbols
        twists = stack(ca.SX(0) if v is None else v for v in made.twist)
        y = stack(group.pose for group in d.coordinates)
        made._places = ca.Function("places", [parameters], [made.place])
        made._speeds = ca.Function("speeds", [y, parameters], [twists])
        return made

    @cached_property
    def place(self) -> ca.SX:
        """(n_y,) poses as formulas of parameters, in the origin where missing."""
        pairs = zip(self.pose, self.rest, strict=True)
        return stack(ca.SX(rest) if value is None else value for value, rest in pairs)

    def values(self, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pose and twist as given for parameter values; at rest in the origin where missing."""
        pose = self._places(p).full().ravel()
        return pose, self.speeds(pose, p)

    def speeds(self, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Twist as given, for bodies that stand at ``y``."""
        return self._speeds(y, p).full().ravel()

    def priority(self, given: list[bool]) -> list[int]:
        """Indices of displacements in the order in which they are held: given ones first, turns
        first."""
        order = {owner: k for k, owner in enumerate(dict.fromkeys(self.owners))}

        def key(k: int):
            return (not given[k], order[self.owners[k]], self.speed_units[k] != "rad", k)

        return sorted(range(len(given)), key=key)

    @property
    def missing(self) -> np.ndarray:
        """(n,) along which displacements no place is given."""
        return ~np.array(self.given, dtype=bool)

    @cached_property
    def metres(self) -> np.ndarray:
        """(n,) which displacements are lengths."""
        return np.array([unit == "m" for unit in self.speed_units], dtype=bool)
