"""Nodes of finite elements, as elements see them, and the directions of their displacements."""

from __future__ import annotations

from typing import Any

import casadi as ca

from dalembert.errors import ModelError

TRANSLATIONS = ("ux", "uy", "uz")
ROTATIONS = {1: (), 2: ("rz",), 3: ("rx", "ry", "rz")}


def effort(direction: str) -> str:
    """Name of the force or moment along a displacement or rotation: ``fx`` of ``ux``."""
    return direction.replace("u", "f").replace("r", "m")


def missing_rotation(condition: str, entity: str) -> ModelError:
    """Error about a condition on the rotation of a node without one.

    Parameters
    ----------
    condition : name as in the call, such as ``mz``
    entity : of the condition
    """
    return ModelError(
        f"{condition}: no element turns this node; connect an element with rotations to it, such "
        "as a Frame or SpaceFrame",
        entity,
    )


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
