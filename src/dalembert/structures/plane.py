"""Plane continuum: triangles and quadrilaterals in plane stress or plane strain.

``W = t ∫ (λ/2 (tr 𝗘)² + μ 𝗘:𝗘) dA`` with Green's strain ``𝗘 = (𝗙ᵀ𝗙 − 𝟭)/2`` (St Venant–Kirchhoff),
so that rotations cost nothing; for small displacements it is Hooke's law.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Scalar, option, quantity
from dalembert.errors import ModelError
from dalembert.structures.base import StructuralElement
from dalembert.structures.node import Node

Sample = tuple[ca.SX, ca.SX]


@dataclass(eq=False)
class PlaneElement(StructuralElement):
    """A flat piece of material between its corner nodes, counted counter-clockwise.

    Parameters
    ----------
    corners : its nodes
    thickness : [m]
    modulus : Young's modulus [Pa]
    poisson : Poisson's ratio [-]
    density : [kg/m³]
    plane_strain : no strain across the plane, instead of no stress
    """

    corners: tuple[Node, ...]
    thickness: Scalar = quantity("m", "thickness", above=0.0, keyword=True)
    modulus: Scalar = quantity("Pa", "Young's modulus", above=0.0, keyword=True)
    poisson: Scalar = quantity("", "Poisson's ratio", default=0.3, minimum=0.0, keyword=True)
    density: Scalar = quantity("kg/m^3", "density", default=0.0, minimum=0.0, keyword=True)
    plane_strain: bool = option("no strain across the plane, instead of no stress", default=False)

    corner_count: ClassVar[int]
    points: ClassVar[tuple[tuple[float, float, float], ...]]
    """Integration points ``(ξ, η, weight)``."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if len(self.corners) != self.corner_count:
            raise ModelError(
                f"has {len(self.corners)} corners, needs {self.corner_count}", self.name
            )
        for node in self.corners:
            if not isinstance(node, Node) or node.dimension != 2:
                raise ModelError(f"corners must be nodes of the plane; got {node!r}", self.name)

    def nodes(self) -> tuple[Node, ...]:
        return tuple(self.corners)

    @classmethod
    def shapes(cls, xi: float, eta: float) -> ca.DM:
        """(nodes, 2) derivatives of the shape functions by ξ and η."""
        raise NotImplementedError

    @classmethod
    def sample(cls, u, x, xi: float, eta: float) -> Sample:
        """Displacement gradient (2, 2) and area factor at a point of the element."""
        slopes = cls.shapes(xi, eta)
        jacobian = ca.mtimes(ca.horzcat(*x), slopes)
        by_place = ca.mtimes(slopes, ca.inv(jacobian))
        return ca.mtimes(ca.horzcat(*u), by_place), ca.det(jacobian)

    @classmethod
    def lame(cls, q: dict) -> Sample:
        """``λ, μ`` of Hooke's law in the plane."""
        e, nu = q["modulus"], q["poisson"]
        second = e * nu / (1 - nu**2)
        if q["plane_strain"]:
            second = e * nu / ((1 + nu) * (1 - 2 * nu))
        return second, e / (2 * (1 + nu))

    @classmethod
    def energy(cls, u: list[ca.SX], x: list[ca.SX], q: dict) -> ca.SX:
        first, second = cls.lame(q)
        total = ca.SX(0)
        for xi, eta, weight in cls.points:
            gradient, area = cls.sample(u, x, xi, eta)
            strain = (gradient + gradient.T + ca.mtimes(gradient.T, gradient)) / 2
            density = first / 2 * ca.trace(strain) ** 2 + second * ca.sumsqr(strain)
            total += weight * area * density
        return q["thickness"] * total

    @classmethod
    def measures(cls, u, x, q) -> dict[str, tuple[ca.SX, str]]:
        gradient, _ = cls.sample(u, x, *cls.middle)
        strain = (gradient + gradient.T + ca.mtimes(gradient.T, gradient)) / 2
        first, second = cls.lame(q)
        stress = first * ca.trace(strain) * ca.SX.eye(2) + 2 * second * strain
        found = {"sxx": stress[0, 0], "syy": stress[1, 1], "sxy": stress[0, 1]}
        return {name: (value, "Pa") for name, value in found.items()}

    @classmethod
    def mass(cls, x: list[ca.SX], q: dict) -> ca.SX:
        u = [ca.SX.zeros(2) for _ in x]
        area = sum((w * cls.sample(u, x, xi, eta)[1] for xi, eta, w in cls.points), ca.SX(0))
        return q["density"] * q["thickness"] * area

    middle: ClassVar[tuple[float, float]]


@dataclass(eq=False)
class Triangle(PlaneElement):
    """Triangle with constant strain."""

    corner_count = 3
    points = ((1 / 3, 1 / 3, 0.5),)
    middle = (1 / 3, 1 / 3)

    @classmethod
    def shapes(cls, xi: float, eta: float) -> ca.DM:
        return ca.DM([[-1, -1], [1, 0], [0, 1]])


@dataclass(eq=False)
class Quadrilateral(PlaneElement):
    """Bilinear quadrilateral, integrated at 2 × 2 points."""

    corner_count = 4
    points = tuple((x / sqrt(3), y / sqrt(3), 1.0) for x in (-1, 1) for y in (-1, 1))
    middle = (0.0, 0.0)

    @classmethod
    def shapes(cls, xi: float, eta: float) -> ca.DM:
        signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
        return ca.DM([[sx * (1 + sy * eta) / 4, sy * (1 + sx * xi) / 4] for sx, sy in signs])
