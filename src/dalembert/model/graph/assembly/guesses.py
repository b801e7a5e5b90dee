"""Initial state: guesses of the user, and the assembled result."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.model.graph.description import Description
from dalembert.symbolic.formulas.expression import stack


@dataclass
class Guesses:
    """Initial values as formulas, None if missing, with names and units.

    Attributes
    ----------
    pose, names, units, pose_owners : by coordinate
    rest : pose at the origin
    twist : by speed; may be formulas of the pose
    speed_names, speed_units, owners : by speed and displacement; units of displacements
    given : by displacement, whether there is a guess
    angles : by displacement, whether it is an angle with a period of 2π
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
        guesses = cls()
        for group in d.coordinates:
            pose, twist = group.guesses()
            guesses.pose += pose
            guesses.twist += twist
            guesses.given += group.specified()
            guesses.angles += [group.flat and unit == "rad" for unit in group.speed_units]
            guesses.names += [f"{group.name}.{n}" for n in group.coordinate_names]
            guesses.units += list(group.coordinate_units)
            guesses.pose_owners += [group.name] * len(pose)
            guesses.speed_names += [f"{group.name}.{n}" for n in group.speed_names]
            guesses.speed_units += list(group.speed_units)
            guesses.owners += [group.name] * len(twist)
            guesses.rest += list(group.rest)
        parameters = d.space.symbols
        twists = stack(ca.SX(0) if v is None else v for v in guesses.twist)
        y = stack(group.pose for group in d.coordinates)
        guesses._places = ca.Function("places", [parameters], [guesses.place])
        guesses._speeds = ca.Function("speeds", [y, parameters], [twists])
        return guesses

    @cached_property
    def place(self) -> ca.SX:
        """(n_y,) poses as formulas of parameters; at the origin if missing."""
        pairs = zip(self.pose, self.rest, strict=True)
        return stack(ca.SX(rest) if value is None else value for value, rest in pairs)

    def values(self, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Guesses of pose and twist for parameter values; at rest at the origin if missing."""
        pose = self._places(p).full().ravel()
        return pose, self.speeds(pose, p)

    def speeds(self, y: np.ndarray, p: np.ndarray) -> np.ndarray:
        """Guess of the twist for bodies at ``y``."""
        return self._speeds(y, p).full().ravel()

    def priority(self, given: list[bool]) -> list[int]:
        """Indices of displacements in the order of fixing: given ones first, rotations first."""
        order = {owner: k for k, owner in enumerate(dict.fromkeys(self.owners))}

        def key(k: int):
            return (not given[k], order[self.owners[k]], self.speed_units[k] != "rad", k)

        return sorted(range(len(given)), key=key)

    @property
    def missing(self) -> np.ndarray:
        """(n,) displacements without a guess."""
        return ~np.array(self.given, dtype=bool)

    @cached_property
    def metres(self) -> np.ndarray:
        """(n,) displacements that are lengths."""
        return np.array([unit == "m" for unit in self.speed_units], dtype=bool)


@dataclass
class AssembledState:
    """Consistent initial state.

    Attributes
    ----------
    y, v : (n,) arrays
    residual : largest remaining violation
    corrections : coordinate name → change of its guess by assembly
    velocity_corrections : speed name → change of its guess, if guesses were inconsistent
    projected_speeds : whether inconsistent guesses of speeds were projected
    """

    y: np.ndarray
    v: np.ndarray
    residual: float
    corrections: dict[str, float] = field(default_factory=dict)
    velocity_corrections: dict[str, float] = field(default_factory=dict)
    projected_speeds: bool = False
