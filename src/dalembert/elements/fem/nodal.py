"""Nodes of finite elements, as elements see them, and the directions of their displacements."""

from __future__ import annotations

from typing import Any

import casadi as ca

TRANSLATIONS = ("ux", "uy", "uz")
ROTATIONS = {1: (), 2: ("rz",), 3: ("rx", "ry", "rz")}


class NodeLike:
    """A node, or a set of nodes.

    Attributes
    ----------
    dimension : number of its coordinates
    body : the node, or the only node of the set, as a body of a mechanism
    """

    name: str
    dimension: int
    body: Any


class Nodal(NodeLike):
    """A node of finite elements: a point with a stress-free position.

    Attributes
    ----------
    natural : SX (d,), stress-free position
    """

    natural: ca.SX
