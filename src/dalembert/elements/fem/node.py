"""Nodes of structures."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Element, Vector
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression

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


@dataclass(eq=False)
class Node(Nodal, Element):
    """A node of a structure.

    Parameters
    ----------
    position : (d,) coordinates [m], numbers or formulas; their number is the structure's dimension

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> frame = da.Structure("portal")
    >>> height = frame.parameter("height", 3.0, unit="m")
    >>> corner = frame.node("corner", 0, height)  # a structures.Node
    >>> isinstance(corner, structures.Node), corner.name
    (True, 'corner')
    """

    position: Vector

    def __post_init__(self) -> None:
        super().__post_init__()
        coordinates = (
            self.position if isinstance(self.position, (tuple, list)) else (self.position,)
        )
        size = len(coordinates)
        if size not in DIMENSIONS:
            raise ModelError(f"needs 1, 2 or 3 coordinates, got {size}", self.name)
        value = coordinates if size > 1 else coordinates[0]
        self.position = as_expression(value, f"{self.name}.position", "m", size)

    @property
    def natural(self) -> ca.SX:  # type: ignore[override]
        return self.position.sx

    @property
    def dimension(self) -> int:  # type: ignore[override]
        """Number of coordinates."""
        return len(self.position)
