"""Positions and forces of contacts at an instant."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class ContactForces:
    """Contacts at an instant.

    Attributes
    ----------
    names : (n,) elements of the contacts
    keys : (n,) integers that identify the features in contact
    places : (n, d) positions [m]
    forces : (n, d) forces on the second body, means over a step [N]
    """

    names: np.ndarray
    keys: np.ndarray
    places: np.ndarray
    forces: np.ndarray
