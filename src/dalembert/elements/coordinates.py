"""Groups of coordinates with their speeds, of bodies, curve parameters and joints.

The coordinates are a point of a manifold; displacements have as many entries as speeds.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import casadi as ca

from dalembert.symbolic.formulas.expression import stack

RATES = {
    **{axis: (f"v{axis}", f"a{axis}") for axis in "xyz"},
    "angle": ("angular_velocity", "angular_acceleration"),
}
"""Coordinate → names of its speed and its acceleration."""
OTHER_RATES = ("rate", "acceleration")
"""Endings of the names of the speeds and accelerations of all other coordinates."""


class Coordinates:
    """A group of coordinates with their speeds: a body, or the parameter of a curve.

    They are a manifold: ``pose`` has one entry per coordinate, ``twist`` one per degree of freedom,
    ``ẏ_i = A_i(y_i) v_i``. A displacement δ has as many entries as the twist; positions are never
    added, ``retract`` applies a displacement.

    Attributes
    ----------
    pose : SX symbol column ``y_i``
    twist, acceleration_symbols : SX symbol columns ``v_i``, ``v̇_i``
    pose_rate : SX, ``A_i v_i``
    followers : the symbols added to an enriched pose, and their values
    rest : the pose at the origin
    coordinate_names, coordinate_units : names and units of the entries of the pose
    speed_names, speed_units : names of the entries of the twist and units of displacements
    attitude : first entries of Euler parameters in the pose and of ``ω'`` in the twist, if any
    """

    name: str
    pose: ca.SX
    followers: tuple[ca.SX, ca.SX] = (ca.SX(0, 1), ca.SX(0, 1))
    twist: ca.SX
    acceleration_symbols: ca.SX
    pose_rate: ca.SX
    rest: tuple[float, ...]
    interval: tuple[float, float] = (-math.inf, math.inf)
    coordinate_names: tuple[str, ...]
    coordinate_units: tuple[str, ...]
    speed_names: tuple[str, ...]
    speed_units: tuple[str, ...]

    @property
    def attitude(self) -> tuple[int, int] | None:
        return None

    @property
    def owner(self) -> Coordinates:
        """The group that holds the coordinates: itself, except for parts of a flexible body."""
        return self

    def make_symbols(self, names: tuple[str, ...], units: tuple[str, ...]) -> None:
        """Create coordinates whose rates are the speeds."""
        self.coordinate_names, self.coordinate_units = names, units
        self.speed_names, self.speed_units = names, units
        self.rest = (0.0,) * len(names)
        self.pose = stack(ca.SX.sym(f"{self.name}.{n}") for n in names)
        self._make_speeds()
        self.pose_rate = self.twist

    def _make_speeds(self) -> None:
        self.twist, self.acceleration_symbols = _speeds_and_accelerations(
            [f"{self.name}.{n}" for n in self.speed_names]
        )

    @property
    def flat(self) -> bool:
        """Whether speeds are the rates of the coordinates and displacements can be added."""
        return True

    def retract(self, pose: ca.SX, displacement: ca.SX) -> ca.SX:
        """The pose after a displacement: ``y + A(y) δ`` to first order, on the manifold."""
        return pose + displacement

    def displacement(self, pose: ca.SX, other: ca.SX) -> ca.SX:
        """The displacement from one pose to another, the inverse of ``retract``."""
        return other - pose

    def bounds(self, pose: ca.SX) -> ca.SX:
        """Expressions that vanish only on the manifold, e.g. a norm minus one; none by default."""
        return ca.SX(0, 1)

    @contextmanager
    def enriched(self) -> Iterator[tuple[ca.SX, ca.SX]]:
        """Context in which quantities that depend on the pose are symbols among its entries.

        The symbols have rates of their own, which makes derivatives shorter. Equations stated in
        the context contain them. Yields the symbols and their values.
        """
        yield ca.SX(0, 1), ca.SX(0, 1)

    def inertia_by_speeds(self) -> tuple[ca.SX, ca.SX]:
        """``M_i`` and ``d_i`` by speeds, ``M v̇ + d``; zero for coordinates without mass."""
        n = self.twist.numel()
        return ca.SX(n, n), ca.SX(n, 1)

    def guesses(self) -> tuple[list, list]:
        """Initial values of pose and twist, None for unspecified entries."""
        return [None] * self.pose.numel(), [None] * self.twist.numel()

    def specified(self) -> list[bool]:
        """For each entry of the twist, whether the position along it was specified."""
        return [value is not None for value in self.guesses()[0]]


def rate_of(expression: ca.SX, owners: list[Coordinates], time: ca.SX) -> ca.SX:
    """Total time derivative of a position-level expression."""
    owners = list(dict.fromkeys(o.owner for o in owners))
    pose = ca.vertcat(time, *(o.pose for o in owners))
    speed = ca.vertcat(1, *(o.pose_rate for o in owners))
    return ca.jtimes(expression, pose, speed)


def motion_rate_of(expression: ca.SX, owners: list[Coordinates], time: ca.SX) -> ca.SX:
    """Total time derivative of an expression of positions and speeds."""
    owners = list(dict.fromkeys(o.owner for o in owners))
    state = ca.vertcat(time, *(ca.vertcat(o.pose, o.twist) for o in owners))
    speed = ca.vertcat(1, *(ca.vertcat(o.pose_rate, o.acceleration_symbols) for o in owners))
    return ca.jtimes(expression, state, speed)


def second_rate_of(expression: ca.SX, owners: list[Coordinates], time: ca.SX) -> ca.SX:
    """Second total time derivative of a position-level expression."""
    return motion_rate_of(rate_of(expression, owners, time), owners, time)


class JointSpace(Coordinates):
    """Coordinates of one joint, or of a group without a joint.

    Parameters
    ----------
    names, units : full names and units of the coordinates
    reading : SX of the poses of bodies, the value of the coordinates
    like : group with the same manifold and speeds; flat by default

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
        self.twist, self.acceleration_symbols = _speeds_and_accelerations(self.speed_names)
        self.pose_rate = self.twist
        if like is not None:
            substitution = ca.vertcat(like.pose, like.twist), ca.vertcat(self.pose, self.twist)
            self.pose_rate = ca.substitute(like.pose_rate, *substitution)

    @classmethod
    def of(cls, group: Coordinates, reading: ca.SX | None = None) -> JointSpace:
        """The coordinates of a group in new symbols."""
        names = [f"{group.name}.{n}" for n in group.coordinate_names]
        return cls(names, group.coordinate_units, group.pose if reading is None else reading, group)

    @property
    def attitude(self) -> tuple[int, int] | None:
        return self._like.attitude

    @property
    def flat(self) -> bool:
        return self._like.flat

    def retract(self, pose: ca.SX, displacement: ca.SX) -> ca.SX:
        return self._like.retract(pose, displacement)

    def displacement(self, pose: ca.SX, other: ca.SX) -> ca.SX:
        return self._like.displacement(pose, other)

    def bounds(self, pose: ca.SX) -> ca.SX:
        return self._like.bounds(pose)


def _speeds_and_accelerations(names: Sequence[str]) -> tuple[ca.SX, ca.SX]:
    """Symbols of the rates of displacements, named as the measures of a body if it has them."""
    symbols = []
    for order in range(2):
        columns = []
        for name in names:
            owner, dot, last = name.rpartition(".")
            rate = RATES[last][order] if last in RATES else f"{last}_{OTHER_RATES[order]}"
            columns.append(ca.SX.sym(f"{owner}{dot}{rate}"))
        symbols.append(stack(columns))
    return symbols[0], symbols[1]
