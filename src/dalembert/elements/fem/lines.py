"""Elements between two nodes: base class and axial spring (8.6)."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.energies import Named
from dalembert.elements.fem.nodal import Nodal
from dalembert.elements.look import Cells, Coils
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
            raise ModelError(f"ties {self.node_i.name} to itself; use two nodes", self.name)

    def nodes(self) -> tuple[Nodal, ...]:
        return self.node_i, self.node_j

    @staticmethod
    def length(x: list[ca.SX]) -> ca.SX:
        """Distance of the two nodes."""
        return ca.norm_2(x[1] - x[0])

    @staticmethod
    def middle(u: list[ca.SX], x: list[ca.SX]) -> ca.SX:
        """Middle between the displaced nodes."""
        d = x[0].numel()
        return (x[0] + u[0][:d] + x[1] + u[1][:d]) / 2

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


@dataclass(eq=False)
class AxialSpring(Line):
    """Linear spring along the line of its nodes, ``s = k (u_j − u_i)`` (8.6).

    ``W = k e²/2`` with the elongation ``e``; in one dimension the node positions are irrelevant.

    Parameters
    ----------
    stiffness : [N/m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> chain = da.Structure("chain")
    >>> a, b, c = (chain.node(name, x) for name, x in (("a", 0), ("b", 1), ("c", 2)))
    >>> soft = chain.add(structures.AxialSpring("soft", a, b, stiffness=100.0))
    >>> hard = chain.add(structures.AxialSpring("hard", b, c, stiffness=400.0))
    >>> chain.support(a)
    >>> chain.load(c, fx=20.0)
    >>> round(da.solve_statics(chain.build())["c.ux"], 9)  # sum of F/k
    0.25
    """

    stiffness: Scalar = quantity("N/m", "stiffness", above=0.0, keyword=True)

    @classmethod
    def look_of(cls, nodes: np.ndarray, elements: np.ndarray) -> list[Cells]:
        return [Coils(nodes, elements)]

    @classmethod
    def energy(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        return q["stiffness"] * cls.elongation(u, x) ** 2 / 2

    @classmethod
    def recovered(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> Named:
        elongation = cls.elongation(u, x)
        return {"elongation": (elongation, "m"), "force": (q["stiffness"] * elongation, "N")}

    @classmethod
    def checks(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> list[tuple[ca.SX, str]]:
        return [] if x[0].numel() == 1 else super().checks(x, q)
