"""Positions and forces of contacts at an instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class ContactForces:
    """Contacts at an instant.

    Two bodies have the same order in all their contacts: the ground first, then the order of the
    shapes in their element.

    Attributes
    ----------
    names : (n,) elements of the contacts
    bodies : (n, 2) first and second body of the contacts
    keys : (n,) integers that identify the features in contact
    places : (n, d) positions [m]
    forces : (n, d) forces on the second body, means over a step [N]
    """

    names: np.ndarray
    bodies: np.ndarray
    keys: np.ndarray
    places: np.ndarray
    forces: np.ndarray

    def some(self, rows: np.ndarray) -> ContactForces:
        """The contacts of some rows."""
        parts = self.names, self.bodies, self.keys, self.places, self.forces
        return ContactForces(*(part[rows] for part in parts))

    def between(self, first: str, second: str) -> np.ndarray:
        """(d,) sum of the forces of the first body on the second one [N]; 0 without contact."""
        signs = (self.bodies == (first, second)).all(axis=1).astype(float)
        signs -= (self.bodies == (second, first)).all(axis=1)
        force: np.ndarray = signs @ self.forces
        return force
