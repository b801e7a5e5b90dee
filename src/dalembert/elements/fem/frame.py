"""Planar frame elements with axial force, shear and bending.

The energy is that of a beam relative to its chord (co-rotational): exact for large displacements
and rotations with small deformation of the element, and the textbook element for small
displacements. The axial strain is that of the bent axis, not of the chord (shallow-arch strain,
averaged along the element; Crisfield, Non-linear Finite Element Analysis 2, 1997), so that
compression reduces the bending stiffness within an element too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.fem.energies import Named
from dalembert.elements.fem.lines import Bending, Line, linear_kinetic
from dalembert.elements.look import Diagram
from dalembert.errors import ModelError


@dataclass(eq=False)
class Frame(Line):
    """Euler–Bernoulli beam between two planar nodes.

    ``W = E A e²/(2L) + 2 E I (θ₁² + θ₁θ₂ + θ₂²)/L`` with the rotations ``θ`` of the ends relative
    to the chord and the elongation ``e`` of the axis: that of the chord plus ``½ ∫ w'² dx``.

    Parameters
    ----------
    area : cross-section [m²]
    second_moment : second moment of area ``I`` [m⁴]
    modulus : Young's modulus [Pa]
    density : [kg/m³]
    expansion : coefficient of thermal expansion ``α`` [1/K]
    temperature : change ``ΔT`` from the stress-free state, for every load case [K]
    temperature_gradient : its derivative along the y axis of the element, to the left [K/m]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> cantilever = da.Structure("cantilever")
    >>> root, tip = cantilever.node("root", 0, 0), cantilever.node("tip", 2, 0)
    >>> profile = dict(area=1e-3, second_moment=1e-7, modulus=2e11)
    >>> beam = cantilever.add(structures.Frame("beam", root, tip, **profile))
    >>> cantilever.support(root)
    >>> cantilever.load(tip, fy=-300.0)
    >>> result = da.solve_statics(cantilever.build())
    >>> round(result["tip.uy"], 9), round(result["beam.moment_i"], 6)  # F L³/(3 E I), F L
    (-0.04, 600.0)
    """

    area: Scalar = quantity("m^2", "cross-section", above=0.0, keyword=True)
    second_moment: Scalar = quantity("m^4", "second moment of area", above=0.0, keyword=True)
    modulus: Scalar = quantity("Pa", "Young's modulus", above=0.0, keyword=True)
    density: Scalar = quantity("kg/m^3", "density", default=0.0, minimum=0.0, keyword=True)
    expansion: Scalar = quantity("1/K", "thermal expansion", default=0.0, keyword=True)
    temperature: Scalar = quantity("K", "change of temperature", default=0.0, keyword=True)
    temperature_gradient: Scalar = quantity("K/m", "rise along y", default=0.0, keyword=True)
    turns: ClassVar[bool] = True
    floats: ClassVar[bool] = True
    dimensions: ClassVar[tuple[int, ...]] = (2,)
    diagrams: ClassVar[dict[str, Diagram]] = {
        "force": Diagram("force", "force"),
        "shear": Diagram("shear", "shear"),
        "moment": Diagram("moment_i", "moment_j", -1.0, across=-1),  # on the side in tension
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.node_i.dimension != 2:
            raise ModelError(
                "is a planar element, whose nodes have two coordinates; use SpaceFrame in space",
                self.name,
            )

    @classmethod
    def strains(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        rotations = cls.end_turns(u, x)
        return ca.vertcat(cls.elongation(u, x) + cls.bending(x, q).bow(*rotations), *rotations)

    @classmethod
    def energy_of(cls, strains: ca.SX, x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        beam, (elongation, first, second) = cls.bending(x, q), ca.vertsplit(strains)
        axial = q["modulus"] * q["area"] * elongation**2 / (2 * beam.length)
        return axial + beam.energy(first, second)

    @classmethod
    def bending(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> Bending:
        """The beam in bending."""
        rigidity = q["modulus"] * q["second_moment"]
        return Bending(cls.length(x), rigidity, cls.shear_softness(x, q))

    @classmethod
    def shear_softness(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """``φ = 12 E I / (G A_s L²)``; zero for rigid shear."""
        return ca.SX(0)

    @classmethod
    def rotary_inertia(cls, q: dict[str, ca.SX]) -> ca.SX:
        """``ρ I`` of elements with rotary inertia [kg m]."""
        return ca.SX(0)

    @classmethod
    def end_turns(cls, u: list[ca.SX], x: list[ca.SX]) -> tuple[ca.SX, ca.SX]:
        """Rotations of the ends relative to the chord."""
        cosine, sine = cls.chord_turn(u, x)
        chord = ca.atan2(sine, cosine)

        def against_chord(turn: ca.SX) -> ca.SX:  # small for any number of common revolutions
            relative = turn - chord
            return relative - 2 * np.pi * ca.floor(relative / (2 * np.pi) + 0.5)

        return against_chord(u[0][2]), against_chord(u[1][2])

    @classmethod
    def thermal(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        first, second = cls.end_turns(u, x)
        elongation = cls.elongation(u, x) + cls.bending(x, q).bow(first, second)
        strain, curvature = q["expansion"] * q["temperature"], cls.thermal_curvature(q)
        axial = q["modulus"] * q["area"] * strain * (strain * cls.length(x) / 2 - elongation)
        rotation = curvature * cls.length(x) / 2 - (second - first)
        return axial + q["modulus"] * q["second_moment"] * curvature * rotation

    @classmethod
    def thermal_curvature(cls, q: dict[str, ca.SX]) -> ca.SX:
        """Thermal curvature of a free beam [1/m]."""
        return -q["expansion"] * q["temperature_gradient"]

    @staticmethod
    def chord_turn(u: list[ca.SX], x: list[ca.SX]) -> tuple[ca.SX, ca.SX]:
        """Cosine and sine of the rotation of the chord, times both its lengths."""
        before = x[1] - x[0]
        after = before + u[1][:2] - u[0][:2]
        return ca.dot(before, after), before[0] * after[1] - before[1] * after[0]

    @classmethod
    def own_axes(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        axis = x[1] - x[0] + u[1][:2] - u[0][:2]
        axis /= ca.norm_2(axis)
        return ca.horzcat(axis, ca.vertcat(-axis[1], axis[0]))

    @classmethod
    def kinetic(cls, v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        to_axes = cls.own_axes([ca.SX.zeros(2)] * 2, x, q).T
        velocities = [ca.vertcat(ca.mtimes(to_axes, end[:2]), end[2]) for end in v]
        return cls.kinetic_in_axes(velocities, x, q)

    @classmethod
    def kinetic_in_axes(cls, v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        length, mass = cls.length(x), q["density"] * q["area"]
        first, second = (end[0] for end in v)
        ends = [motion for end in v for motion in (end[1], end[2])]
        bending = cls.bending(x, q).kinetic(ends, mass, cls.rotary_inertia(q))
        return linear_kinetic(first, second, mass * length) + bending

    @classmethod
    def mass_center(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        deflection = cls.bending(x, q).mean_deflection(*cls.end_turns(u, x))
        return cls.middle(u, x) + cls.own_axes(u, x, q)[:, 1] * deflection

    @classmethod
    def recovered(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> Named:
        beam, rotations, length = cls.bending(x, q), cls.end_turns(u, x), cls.length(x)
        moment_i, moment_j = beam.moments(*rotations)
        shear = (moment_i + moment_j) / length
        thermal_moment = beam.rigidity * cls.thermal_curvature(q)
        strain = (cls.elongation(u, x) + beam.bow(*rotations)) / length
        axial = q["modulus"] * q["area"] * (strain - q["expansion"] * q["temperature"])
        return {
            "force": (axial, "N"),
            "stress": (axial / q["area"], "Pa"),
            "shear": (shear, "N"),
            "moment_i": (moment_i + thermal_moment, "N m"),
            "moment_j": (moment_j - thermal_moment, "N m"),
        }


@dataclass(eq=False)
class TimoshenkoFrame(Frame):
    """Frame element with shear deformation, ``φ = 12 E I / (G A_s L²)``, and rotary inertia.

    Parameters
    ----------
    shear_modulus : ``G`` [Pa]
    shear_area : ``A_s``, the cross-section times the shear correction factor [m²]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> stub = da.Structure("stub")
    >>> root, tip = stub.node("root", 0, 0), stub.node("tip", 1, 0)
    >>> numbers = dict(area=1e-2, modulus=3e9, second_moment=1e-4)
    >>> shear = dict(shear_modulus=1e9, shear_area=1e-3)
    >>> beam = structures.TimoshenkoFrame("stub", root, tip, **numbers, **shear)
    >>> element = stub.add(beam)
    >>> stub.support(root)
    >>> stub.load(tip, fy=900.0)
    >>> round(da.solve_statics(stub.build())["tip.uy"] * 1e3, 6)  # F L³/(3 E I) + F L/(G A_s) [mm]
    1.9
    """

    shear_modulus: Scalar = quantity("Pa", "shear modulus", above=0.0, keyword=True)
    shear_area: Scalar = quantity("m^2", "shear area", above=0.0, keyword=True)

    @classmethod
    def shear_softness(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        bending = 12 * q["modulus"] * q["second_moment"]
        return bending / (q["shear_modulus"] * q["shear_area"] * ca.sumsqr(x[1] - x[0]))

    @classmethod
    def rotary_inertia(cls, q: dict[str, ca.SX]) -> ca.SX:
        return q["density"] * q["second_moment"]
