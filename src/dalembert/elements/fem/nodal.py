"""What finite elements tie together."""

from __future__ import annotations

import casadi as ca

TRANSLATIONS = ("ux", "uy", "uz")
ROTATIONS = {1: (), 2: ("rz",), 3: ("rx", "ry", "rz")}
DIMENSIONS = (1, 2, 3)


class Nodal:
    """A place of a structure, or a body that has gone from there.

    Attributes
    ----------
    dimension : number of its coordinates
    natural : SX (d,), where elements are free of stress
    """

    name: str
    dimension: int
    natural: ca.SX
