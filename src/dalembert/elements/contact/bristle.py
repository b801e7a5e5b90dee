"""Bristle deflections, the states of friction."""

from __future__ import annotations

import casadi as ca

from dalembert.elements.coordinates import Coordinates


class Bristles(Coordinates):
    """Bristle deflections: coordinates without speeds and with the rate ``ż = f(y, v, z)``.

    They change with time only; position analysis leaves them unchanged.
    """

    def __init__(self, name: str, count: int):
        self.name = name
        self.make_symbols((), ())
        self.coordinate_names = ("z",) if count == 1 else tuple(f"z{k + 1}" for k in range(count))
        self.coordinate_units = ("",) * count
        self.rest = (0.0,) * count
        self.pose = ca.vertcat(*(ca.SX.sym(f"{name}.{n}") for n in self.coordinate_names))
        self.pose_rate = ca.SX.zeros(count)

    @property
    def flat(self) -> bool:
        return False

    def retract(self, pose: ca.SX, displacement: ca.SX) -> ca.SX:
        return pose

    def displacement(self, pose: ca.SX, other: ca.SX) -> ca.SX:
        return ca.SX(0, 1)

    def guesses(self) -> tuple[list, list]:
        return [ca.SX(0)] * self.pose.numel(), []

    def guessed(self) -> list[bool]:
        return []
