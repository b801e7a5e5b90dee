"""Planar continuum elements: triangles and quadrilaterals in plane stress or plane strain."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Scalar, option, quantity
from dalembert.elements.fem.continuum import Continuum


@dataclass(eq=False)
class PlaneElement(Continuum):
    """A planar continuum element with nodes in counter-clockwise order.

    Parameters
    ----------
    connectivity : its nodes, in the order of VTK and meshio: corners, then midpoints of edges
    thickness : [m]
    modulus : Young's modulus [Pa]
    poisson : Poisson's ratio [-]
    density : [kg/m³]
    expansion : coefficient of thermal expansion ``α`` [1/K]
    temperature : change ``ΔT`` from the stress-free state, for every load case [K]
    plane_strain : plane strain instead of plane stress
    """

    thickness: Scalar = quantity("m", "thickness", above=0.0, keyword=True)
    plane_strain: bool = option("plane strain instead of plane stress", default=False)
    counting: ClassVar[str] = "move its nodes, or count them counter-clockwise"

    @classmethod
    def depth(cls, q: dict) -> ca.SX:
        return q["thickness"]

    @classmethod
    def lame(cls, q: dict) -> tuple[ca.SX, ca.SX]:
        """``λ, μ`` of Hooke's law for plane stress or plane strain."""
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
        elastic = q["poisson"] * (measured["sxx"] + measured["syy"])
        thermal = q["modulus"] * q["expansion"] * q["temperature"]
        return elastic - thermal if q["plane_strain"] else ca.SX(0)


@dataclass(eq=False)
class Triangle(PlaneElement, cell="triangle"):
    """Triangle of 3 nodes with constant strain.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> gusset = da.Structure("gusset")
    >>> a, b, c = gusset.node("a", 0, 0), gusset.node("b", 1, 0), gusset.node("c", 0, 1)
    >>> steel = dict(thickness=0.01, modulus=2e11, poisson=0.25)
    >>> sheet = gusset.add(structures.Triangle("sheet", (a, b, c), **steel))
    >>> gusset.support(a)
    >>> gusset.support(b, ux=1e-3, uy=0)
    >>> gusset.support(c)
    >>> result = da.solve_statics(gusset.build())
    >>> [round(result[f"sheet.{s}"] / 1e6, 6) for s in ("sxx", "syy")]  # E ε/(1 - ν²), ν of it
    [213.333333, 53.333333]
    """


@dataclass(eq=False)
class Triangle6(PlaneElement, cell="triangle6"):
    """Triangle of 6 nodes with linear strain; its edges may be curved.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> arm = da.Structure("cantilever")
    >>> points, cells = structures.rectangle_mesh((10, 1), (10, 1), "triangle6")
    >>> nodes = arm.add_nodes("n", points)
    >>> numbers = dict(thickness=1.0, modulus=1e6, poisson=0.0)
    >>> strip = arm.add_elements("s", structures.Triangle6, nodes, cells, **numbers)
    >>> arm.support(nodes.where(x=0))
    >>> arm.traction(strip, nodes.where(x=10), ty=0.1)
    >>> result = da.solve_statics(arm.build())
    >>> round(result["n[10].uy"] * 3 * 1e6 / 12 / (0.1 * 10**3), 2)  # of F L³/(3 E I)
    1.0
    """


@dataclass(eq=False)
class Quadrilateral(PlaneElement, cell="quad"):
    """Bilinear quadrilateral of 4 nodes, integrated at 2 × 2 points.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> strip = da.Structure("hot strip")
    >>> points, cells = structures.rectangle_mesh((2, 1), (2, 1))
    >>> nodes = strip.add_nodes("n", points)
    >>> steel = dict(thickness=0.01, modulus=2e11, poisson=0.0, expansion=1.2e-5)
    >>> skin = strip.add_elements("skin", structures.Quadrilateral, nodes, cells, **steel)
    >>> strip.heat(skin, temperature=50.0)
    >>> strip.support(nodes.where(x=0))
    >>> strip.support(nodes.where(x=2), ux=0)
    >>> round(da.solve_statics(strip.build())["skin[0].sxx"] / 1e6, 6)  # -E α ΔT [MPa]
    -120.0
    """


@dataclass(eq=False)
class Quadrilateral8(PlaneElement, cell="quad8"):
    """Quadratic quadrilateral of 8 nodes, integrated at 3 × 3 points; its edges may be curved.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> arm = da.Structure("cantilever")
    >>> points, cells = structures.rectangle_mesh((20, 1), (10, 1), "quad8")
    >>> nodes = arm.add_nodes("n", points)
    >>> numbers = dict(thickness=1.0, modulus=1e6, poisson=0.0)
    >>> strip = arm.add_elements("s", structures.Quadrilateral8, nodes, cells, **numbers)
    >>> arm.support(nodes.where(x=0))
    >>> arm.traction(strip, nodes.where(x=20), ty=0.1)
    >>> result = da.solve_statics(arm.build())
    >>> round(result["n[10].uy"] * 3 * 1e6 / 12 / (0.1 * 20**3), 2)  # of F L³/(3 E I)
    1.0
    """
