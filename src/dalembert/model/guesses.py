"""What was given of the initial state, coordinate by coordinate."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.model.description import Description
from dalembert.symbolic.expression import stack


@dataclass
class Guesses:
    """Initial values by coordinate: formulas where given, None where missing."""

    pose: list
    twist: list
    names: list[str]
    units: list[str]
    owners: list[str]
    _values: ca.Function = None  # type: ignore[assignment]

    @classmethod
    def collect(cls, d: Description) -> Guesses:
        made = cls([], [], [], [], [])
        for group in d.coordinates:
            pose, twist = group.guesses()
            made.pose += pose
            made.twist += twist
            made.names += [f"{group.name}.{n}" for n in group.coordinate_names]
            made.units += list(group.coordinate_units)
            made.owners += [group.name] * len(pose)
        parameters = stack(p.sx for p in d.parameters.values())
        given = [_filled(made.pose), _filled(made.twist)]
        made._values = ca.Function("guess", [parameters], given)
        return made

    def values(self, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pose and twist as given for parameter values, zero where missing."""
        pose, twist = self._values(p)
        return pose.full().ravel(), twist.full().ravel()

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
    return ca.densify(ca.vertcat(ca.SX(0, 1), *(0 if v is None else v for v in values)))
