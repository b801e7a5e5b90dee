"""Plane continuum: triangles and quadrilaterals in plane stress or plane strain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Scalar, option, quantity
from dalembert.elements.fem.continuum import Continuum


@dataclass(eq=False)
class PlaneElement(Continuum):
    """A flat piece of material between its nodes, counted counter-clockwise.

    Parameters
    ----------
    connectivity : its nodes, in the order of VTK and meshio: corners, then middles of edges
    thickness : [m]
    modulus : Young's modulus [Pa]
    poisson : Poisson's ratio [-]
    density : [kg/m³]
    expansion : coefficient of thermal expansion ``α`` [1/K]
    temperature : change ``ΔT`` against the state without stress, under every load [K]
    plane_strain : no strain across the plane, instead of no stress
    """

    thickness: Scalar = quantity("m", "thickness", above=0.0, keyword=True)
    plane_strain: bool = option("no strain across the plane, instead of no stress", default=False)
    counting: ClassVar[str] = "move its nodes, or count them counter-clockwise"

    @classmethod
    def depth(cls, q: dict) -> ca.SX:
        return q["thickness"]

    @classmethod
    def lame(cls, q: dict) -> tuple[ca.SX, ca.SX]:
        """``λ, μ`` of Hooke's law in the plane."""
        if q["plane_strain"]:
            return super().lame(q)
        e, nu = q["modulus"], q["poisson"]
        return e * nu / (1 - nu**2), e / (2 * (1 + nu))

    @classmethod
    def thermal_stress(cls, q: dict) -> ca.SX:
        if q["plane_strain"]:
            return super().thermal_stress(q)
        return q["modulus"] / (1 - q["poisson"]) * q["expansion"] * q["temperature"]

    @classmethod
    def free_directions(cls, q: dict) -> int:
        return 3 if q["plane_strain"] else 2

    @classmethod
    def compressibility(cls, q: dict) -> ca.SX:
        return super().compressibility(q) if q["plane_strain"] else 1 - q["poisson"]

    @classmethod
    def across_stress(cls, measured: dict[str, ca.SX], q: dict) -> ca.SX:
        in_plane = q["poisson"] * (measured["sxx"] + measured["syy"])
        eased = q["modulus"] * q["expansion"] * q["temperature"]
        return in_plane - eased if q["plane_strain"] else ca.SX(0)


@dataclass(eq=False)
class Triangle(PlaneElement, cell="triangle"):
    """Triangle of 3 nodes with constant strain."""


@dataclass(eq=False)
class Triangle6(PlaneElement, cell="triangle6"):
    """Triangle of 6 nodes with linear strain; its edges may be curved."""


@dataclass(eq=False)
class Quadrilateral(PlaneElement, cell="quad"):
    """Bilinear quadrilateral of 4 nodes, integrated at 2 × 2 points."""


@dataclass(eq=False)
class Quadrilateral8(PlaneElement, cell="quad8"):
    """Quadratic quadrilateral of 8 nodes, integrated at 3 × 3 points; its edges may be curved."""
