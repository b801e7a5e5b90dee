"""Tractions on edges and faces, as elements whose energy is the negative work of a dead load.

``W = −∫ (t − p n)·u dA`` over the facet in its initial configuration, with the traction ``t`` and
the pressure ``p`` against the outward normal ``n``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.nodal import Nodal
from dalembert.elements.fem.reference_cells import REFERENCE_CELLS, ReferenceCell


@dataclass(eq=False)
class Traction(StructuralElement):
    """Force per area on a facet.

    Parameters
    ----------
    connectivity : its nodes; an edge has the material to its left, a face is counted
        counter-clockwise as seen from outside
    tx, ty, tz : traction [Pa]
    pressure : against the facet [Pa]
    thickness : of an edge [m]
    """

    connectivity: tuple[Nodal, ...]
    tx: Scalar = quantity("Pa", "traction along x", default=0.0, keyword=True)
    ty: Scalar = quantity("Pa", "traction along y", default=0.0, keyword=True)
    tz: Scalar = quantity("Pa", "traction along z", default=0.0, keyword=True)
    pressure: Scalar = quantity("Pa", "pressure", default=0.0, keyword=True)
    thickness: Scalar = quantity("m", "thickness", default=1.0, above=0.0, keyword=True)
    cell: ClassVar[ReferenceCell]

    def __init_subclass__(cls, cell: str, **rest) -> None:
        """``cell`` : name of the reference cell of a class."""
        super().__init_subclass__(**rest)
        cls.cell = REFERENCE_CELLS[cell]
        cls.node_count, cls.dimensions = len(cls.cell.nodes), (cls.cell.dimension + 1,)
        cls.samples = cls.cell.kinetic_samples

    def nodes(self) -> tuple[Nodal, ...]:
        return tuple(self.connectivity)

    @classmethod
    def energy(cls, u: list[ca.SX], x: list[ca.SX], q: dict) -> ca.SX:
        natural, weight = q["at"][:-1], q["at"][-1]
        shapes = cls.cell.shape_functions(natural)
        along = ca.mtimes(ca.horzcat(*x), ca.jacobian(shapes, natural))
        if along.shape[0] == 2:
            outward = q["thickness"] * ca.vertcat(along[1], -along[0])
        else:
            outward = ca.cross(along[:, 0], along[:, 1])
        traction = ca.vertcat(*(q[name] for name in ("tx", "ty", "tz")[: along.shape[0]]))
        force = ca.norm_2(outward) * traction - q["pressure"] * outward
        return -weight * ca.dot(force, ca.mtimes(ca.horzcat(*u), shapes))


@dataclass(eq=False)
class EdgeTraction(Traction, cell="line"):
    """On a straight edge of the plane."""


@dataclass(eq=False)
class EdgeTraction3(Traction, cell="line3"):
    """On an edge of three nodes."""


@dataclass(eq=False)
class TriangleTraction(Traction, cell="triangle"):
    """On a flat triangle."""


@dataclass(eq=False)
class TriangleTraction6(Traction, cell="triangle6"):
    """On a triangle of six nodes."""


@dataclass(eq=False)
class QuadTraction(Traction, cell="quad"):
    """On a quadrilateral."""


@dataclass(eq=False)
class QuadTraction8(Traction, cell="quad8"):
    """On a quadrilateral of eight nodes."""


TRACTIONS: dict[str, type[Traction]] = {
    "line": EdgeTraction,
    "line3": EdgeTraction3,
    "triangle": TriangleTraction,
    "triangle6": TriangleTraction6,
    "quad": QuadTraction,
    "quad8": QuadTraction8,
}
"""Class by the shape of the facet."""
