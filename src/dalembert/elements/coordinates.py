"""Groups of coordinates: what a body, or the parameter of a curve, brings along.

They are points of a manifold, whose displacements are counted like speeds.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import casadi as ca

from dalembert.symbolic.formulas.expression import stack


class Coordinates:
    """A group of coordinates with their speeds: a body, or the parameter of a curve.

    They are a manifold: ``pose`` has as many entries as are needed to say where something is,
    ``twist`` as many as it has ways to move, ``ẏ_i = A_i(y_i) v_i``. A displacement δ is a short
    motion and counted like a speed; positions are never added, they are reached by ``retract``.

    Attributes
    ----------
    pose : SX symbol column ``y_i``
    twist, acceleration_symbols : SX symbol columns ``v_i``, ``v̇_i``
    pose_rate : SX, ``A_i v_i``
    followers : of a pose that is enriched, the symbols added and their values
    rest : the pose in the origin
    coordinate_names, coordinate_units : of the entries of the pose
    speed_names, speed_units : of the entries of the twist; units are those of displacements
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
    def owner(self) -> Coordinates:
        """The group whose coordinates it has: its own, but for parts of a flexible body."""
        return self

    def make_symbols(self, names: tuple[str, ...], units: tuple[str, ...]) -> None:
        """Coordinates whose rates are the speeds."""
        self.coordinate_names, self.coordinate_units = names, units
        self.speed_names, self.speed_units = names, units
        self.rest = (0.0,) * len(names)
        self.pose = stack(ca.SX.sym(f"{self.name}.{n}") for n in names)
        self._make_speeds()
        self.pose_rate = self.twist

    def _make_speeds(self) -> None:
        self.twist = stack(ca.SX.sym(f"{self.name}.d{n}") for n in self.speed_names)
        self.acceleration_symbols = stack(ca.SX.sym(f"{self.name}.dd{n}") for n in self.speed_names)

    @property
    def flat(self) -> bool:
        """Speeds are the rates of the coordinates, and displacements are added to them."""
        return True

    def retract(self, pose: ca.SX, displacement: ca.SX) -> ca.SX:
        """The pose that a displacement leads to: ``y + A(y) δ`` in first order, on the manifold."""
        return pose + displacement

    def displacement(self, pose: ca.SX, other: ca.SX) -> ca.SX:
        """The displacement from one pose to another, the inverse of ``retract``."""
        return other - pose

    def bounds(self, pose: ca.SX) -> ca.SX:
        """What is zero on the manifold only, such as a length less one; nothing by default."""
        return ca.SX(0, 1)

    @contextmanager
    def enriched(self) -> Iterator[tuple[ca.SX, ca.SX]]:
        """While open, quantities that follow from the pose are symbols among its entries.

        They have rates of their own, which makes derivatives shorter. What is stated meanwhile
        holds them; they are given with their values.
        """
        yield ca.SX(0, 1), ca.SX(0, 1)

    def inertia_by_speeds(self) -> tuple[ca.SX, ca.SX]:
        """``M_i`` and ``d_i`` by speeds, ``M v̇ + d``; zero where the coordinates carry no mass."""
        n = self.twist.numel()
        return ca.SX(n, n), ca.SX(n, 1)

    def guesses(self) -> tuple[list, list]:
        """Initial values of pose and twist, None where nothing was given."""
        return [None] * self.pose.numel(), [None] * self.twist.numel()

    def guessed(self) -> list[bool]:
        """By entry of the twist, whether the place along it was given."""
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
