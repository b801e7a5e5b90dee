"""Coordinates of first order: states with rates of their own and without speeds."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import casadi as ca

from dalembert.elements.coordinates import Coordinates
from dalembert.symbolic.formulas.expression import stack


class States(Coordinates):
    """States ``x`` with ``ẋ = f(t, y, v, x)``: bristles of friction, currents, controllers.

    They change with time only; position analysis leaves them unchanged.

    Parameters
    ----------
    name : of the group
    names, units : of the states
    rates : returns ``f`` (n,) SX
    start : initial values, None for steady states, which begin at ``f = 0``; zero by default
    """

    def __init__(
        self,
        name: str,
        names: Sequence[str],
        units: Sequence[str],
        rates: Callable[[], ca.SX],
        start: Sequence[ca.SX | None] | None = None,
    ):
        self.name, self._rates = name, rates
        self.coordinate_names, self.coordinate_units = tuple(names), tuple(units)
        self.speed_names = self.speed_units = ()
        self.rest = (0.0,) * len(names)
        self.pose = stack(ca.SX.sym(f"{name}.{n}") for n in names)
        self.twist = self.acceleration_symbols = ca.SX(0, 1)
        self._start = [ca.SX(0)] * len(names) if start is None else list(start)

    @property
    def pose_rate(self) -> ca.SX:  # type: ignore[override]
        return ca.densify(self._rates())

    @property
    def flat(self) -> bool:
        return False

    def retract(self, pose: ca.SX, displacement: ca.SX) -> ca.SX:
        return pose

    def displacement(self, pose: ca.SX, other: ca.SX) -> ca.SX:
        return ca.SX(0, 1)

    def guesses(self) -> tuple[list, list]:
        return list(self._start), []

    def specified(self) -> list[bool]:
        return []


def foreign_states(
    expression: ca.SX, owners: Sequence[Coordinates], everything: Sequence[Coordinates]
) -> list[Coordinates]:
    """Groups of states, other than the owners, that an expression of positions contains.

    Lengths and places may contain states of other elements, whose rates belong to their rates.
    """
    own = {id(group.owner) for group in owners}
    groups = [g for g in everything if not g.twist.numel() and id(g.owner) not in own]
    if not groups or not ca.depends_on(expression, stack(g.pose for g in groups)):
        return []
    return [group for group in groups if ca.depends_on(expression, group.pose)]
