"""What was given of the initial state, coordinate by coordinate."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.base import Coordinates
from dalembert.symbolic.expression import stack


@dataclass
class Guesses:
    """Initial values by coordinate: formulas where given, None where missing."""

    pose: list
    twist: list
    names: list[str]
    units: list[str]
    owners: list[str]

    @classmethod
    def collect(cls, groups: list[Coordinates]) -> Guesses:
        made = cls([], [], [], [], [])
        for group in groups:
            pose, twist = group.guesses()
            made.pose += pose
            made.twist += twist
            made.names += [f"{group.name}.{n}" for n in group.coordinate_names]
            made.units += list(group.coordinate_units)
            made.owners += [group.name] * len(pose)
        return made

    def function(self, parameters: ca.SX) -> ca.Function:
        """``p → (y, v)`` as given, zero where missing."""
        return ca.Function("guess", [parameters], [_filled(self.pose), _filled(self.twist)])

    def priority(self, given: list) -> list[int]:
        """Indices in the order in which they are held: given first, angles first."""
        order = {owner: k for k, owner in enumerate(dict.fromkeys(self.owners))}

        def key(k: int):
            return (given[k] is None, order[self.owners[k]], self.units[k] != "rad", k)

        return sorted(range(len(given)), key=key)

    @property
    def missing(self) -> np.ndarray:
        """(n,) which coordinates have no guess."""
        return np.array([g is None for g in self.pose], dtype=bool)


def _filled(values: list) -> ca.SX:
    return stack(ca.SX(0) if v is None else v for v in values)
