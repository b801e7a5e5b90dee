"""Elements between two nodes: base class and axial spring (8.6)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.nodal import Nodal
from dalembert.errors import ModelError


@dataclass(eq=False)
class Line(StructuralElement):
    """An element between two nodes.

    Parameters
    ----------
    node_i, node_j : its ends
    """

    node_i: Nodal
    node_j: Nodal
    node_count = 2

    def __post_init__(self) -> None:
        super().__post_init__()
        for field in ("node_i", "node_j"):
            if not isinstance(getattr(self, field), Nodal):
                raise ModelError(f"{field} must be a node; got {getattr(self, field)!r}", self.name)
        if self.node_i is self.node_j:
            raise ModelError(f"ties {self.node_i.name} to itself; take two nodes", self.name)

    def nodes(self) -> tuple[Nodal, ...]:
        return self.node_i, self.node_j

    @staticmethod
    def length(x: list[ca.SX]) -> ca.SX:
        """Distance of the two nodes."""
        return ca.norm_2(x[1] - x[0])

    @classmethod
    def elongation(cls, u: list[ca.SX], x: list[ca.SX]) -> ca.SX:
        """Change ``(l² − L²)/(l + L)`` of the distance, without cancellation."""
        d = x[0].numel()
        relative = u[1][:d] - u[0][:d]
        if d == 1:
            return relative
        before = x[1] - x[0]
        return ca.dot(relative, 2 * before + relative) / (
            ca.norm_2(before) + ca.norm_2(before + relative)
        )

    @classmethod
    def checks(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> list[tuple[ca.SX, str]]:
        return [(cls.length(x), "has no length; its nodes must lie apart")]
