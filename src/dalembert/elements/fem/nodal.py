"""Nodes of structures."""

from __future__ import annotations

import casadi as ca

TRANSLATIONS = ("ux", "uy", "uz")
ROTATIONS = {1: (), 2: ("rz",), 3: ("rx", "ry", "rz")}
DIMENSIONS = (1, 2, 3)


class Nodal:
    """A node of finite elements: a point of a structure or a body of a mechanism.

    Attributes
    ----------
    dimension : number of its coordinates
    natural : SX (d,), stress-free position
    """

    name: str
    dimension: int
    natural: ca.SX
