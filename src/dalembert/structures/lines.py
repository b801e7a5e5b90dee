"""What elements between two nodes share."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.errors import ModelError
from dalembert.structures.base import StructuralElement
from dalembert.structures.node import Node


@dataclass(eq=False)
class Line(StructuralElement):
    """An element between two nodes.

    Parameters
    ----------
    node_i, node_j : its ends
    """

    node_i: Node
    node_j: Node

    def __post_init__(self) -> None:
        super().__post_init__()
        for field in ("node_i", "node_j"):
            if not isinstance(getattr(self, field), Node):
                raise ModelError(f"{field} must be a node; got {getattr(self, field)!r}", self.name)
        if self.node_i is self.node_j:
            raise ModelError(f"ties {self.node_i.name} to itself; take two nodes", self.name)

    def nodes(self) -> tuple[Node, ...]:
        return self.node_i, self.node_j

    @staticmethod
    def length(x: list[ca.SX]) -> ca.SX:
        """Distance of two places."""
        return ca.norm_2(x[1] - x[0])

    @classmethod
    def elongation(cls, u: list[ca.SX], x: list[ca.SX]) -> ca.SX:
        """Change of the distance of the nodes."""
        if x[0].numel() == 1:
            return u[1][0] - u[0][0]
        d = x[0].numel()
        return cls.length([x[0] + u[0][:d], x[1] + u[1][:d]]) - cls.length(x)
