"""Truss bar: straight, pinned at its ends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.fem.energies import Named
from dalembert.elements.fem.lines import Line, linear_kinetic
from dalembert.elements.look import Diagram


@dataclass(eq=False)
class Truss(Line):
    """Bar that carries axial force only, ``W = E A e² / (2 L)`` with the elongation ``e``.

    Its mass matrix is that of a linear velocity between its ends.

    Parameters
    ----------
    area : cross-section [m²]
    modulus : Young's modulus [Pa]
    density : [kg/m³]
    expansion : coefficient of thermal expansion ``α`` [1/K]
    temperature : change ``ΔT`` from the stress-free state, for every load case [K]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> bracket = da.Structure("bracket")
    >>> a, b, c = bracket.node("a", 0, 0), bracket.node("b", 0, 3), bracket.node("c", 4, 0)
    >>> steel = dict(area=5e-4, modulus=210e9)
    >>> strut = bracket.add(structures.Truss("strut", a, c, **steel))
    >>> tie = bracket.add(structures.Truss("tie", b, c, **steel))
    >>> bracket.support(a)
    >>> bracket.support(b)
    >>> bracket.load(c, fy=-3e3)
    >>> result = da.solve_statics(bracket.build())
    >>> round(result["strut.force"], 6), round(result["tie.force"], 6)  # by the 3-4-5 triangle
    (-4000.0, 5000.0)
    """

    area: Scalar = quantity("m^2", "cross-section", above=0.0, keyword=True)
    modulus: Scalar = quantity("Pa", "Young's modulus", above=0.0, keyword=True)
    density: Scalar = quantity("kg/m^3", "density", default=0.0, minimum=0.0, keyword=True)
    expansion: Scalar = quantity("1/K", "thermal expansion", default=0.0, keyword=True)
    temperature: Scalar = quantity("K", "change of temperature", default=0.0, keyword=True)

    diagrams: ClassVar[dict[str, Diagram]] = {"force": Diagram("force", "force")}

    @classmethod
    def strains(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        return cls.elongation(u, x)

    @classmethod
    def energy_of(cls, strains: ca.SX, x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        stiffness = q["modulus"] * q["area"] / cls.length(x)
        return stiffness * strains**2 / 2

    @classmethod
    def thermal(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        force = q["modulus"] * q["area"] * q["expansion"] * q["temperature"]
        free = q["expansion"] * q["temperature"] * cls.length(x)
        return force * (free / 2 - cls.elongation(u, x))

    @classmethod
    def kinetic(cls, v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        mass = q["density"] * q["area"] * cls.length(x)
        return linear_kinetic(v[0], v[1], mass)

    @classmethod
    def recovered(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> Named:
        strain = cls.elongation(u, x) / cls.length(x)
        stress = q["modulus"] * (strain - q["expansion"] * q["temperature"])
        return {
            "strain": (strain, ""),
            "stress": (stress, "Pa"),
            "force": (stress * q["area"], "N"),
        }
