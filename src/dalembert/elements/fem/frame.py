"""Plane frame elements: beams that carry axial force, shear and bending.

The energy is that of a beam in its own chord, which turns with it (co-rotational): exact for large
displacements and rotations of elements whose own deformation is small, and in the limit of small
displacements the textbook element. Stretched is the bent axis, not the chord (shallow-arch strain,
averaged along the element; Crisfield, Non-linear Finite Element Analysis 2, 1997), so that bending
softens under pressure within an element too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca
import numpy as np

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.fem.beams import Bending, linear_kinetic
from dalembert.elements.fem.energies import Named
from dalembert.elements.fem.lines import Line
from dalembert.errors import ModelError


@dataclass(eq=False)
class Frame(Line):
    """Euler–Bernoulli beam between two nodes of the plane.

    ``W = E A e²/(2L) + 2 E I (θ₁² + θ₁θ₂ + θ₂²)/L`` with the turns ``θ`` of the ends against the
    chord and the elongation ``e`` of the axis: that of the chord, and ``½ ∫ w'² dx`` of the bow.

    Parameters
    ----------
    area : cross-section [m²]
    second_moment : second moment of area ``I`` [m⁴]
    modulus : Young's modulus [Pa]
    density : [kg/m³]
    expansion : coefficient of thermal expansion ``α`` [1/K]
    temperature : change ``ΔT`` against the state without stress, under every load [K]
    temperature_gradient : its rise along the own y axis, to the left of the beam [K/m]

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

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.node_i.dimension != 2:
            raise ModelError(
                "is an element of the plane, whose nodes have two coordinates; take SpaceFrame "
                "in space",
                self.name,
            )

    @classmethod
    def energy(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        beam, turns = cls.bending(x, q), cls.end_turns(u, x)
        longer = cls.elongation(u, x) + beam.bow(*turns)
        return q["modulus"] * q["area"] * longer**2 / (2 * beam.length) + beam.energy(*turns)

    @classmethod
    def bending(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> Bending:
        """The beam as it bends."""
        rigidity = q["modulus"] * q["second_moment"]
        return Bending(cls.length(x), rigidity, cls.shear_softness(x, q))

    @classmethod
    def shear_softness(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """``φ = 12 E I / (G A_s L²)``; zero where shear does not deform."""
        return ca.SX(0)

    @classmethod
    def rotary_inertia(cls, q: dict[str, ca.SX]) -> ca.SX:
        """``ρ I`` where the turning of the cross-section counts [kg m]."""
        return ca.SX(0)

    @classmethod
    def end_turns(cls, u: list[ca.SX], x: list[ca.SX]) -> tuple[ca.SX, ca.SX]:
        """Rotations of the ends less that of the chord."""
        along, across = cls.chord_turn(u, x)
        chord = ca.atan2(across, along)

        def against_chord(turn: ca.SX) -> ca.SX:  # small, whatever number of times both went round
            more = turn - chord
            return more - 2 * np.pi * ca.floor(more / (2 * np.pi) + 0.5)

        return against_chord(u[0][2]), against_chord(u[1][2])

    @classmethod
    def thermal(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        first, second = cls.end_turns(u, x)
        longer = cls.elongation(u, x) + cls.bending(x, q).bow(first, second)
        strain, curvature = q["expansion"] * q["temperature"], cls.thermal_curvature(q)
        axial = q["modulus"] * q["area"] * strain * (strain * cls.length(x) / 2 - longer)
        turned = curvature * cls.length(x) / 2 - (second - first)
        return axial + q["modulus"] * q["second_moment"] * curvature * turned

    @classmethod
    def thermal_curvature(cls, q: dict[str, ca.SX]) -> ca.SX:
        """Curvature that the temperature gives a free beam [1/m]."""
        return -q["expansion"] * q["temperature_gradient"]

    @staticmethod
    def chord_turn(u: list[ca.SX], x: list[ca.SX]) -> tuple[ca.SX, ca.SX]:
        """Cosine and sine of the angle by which the chord turned, times both its lengths."""
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
        back = cls.own_axes([ca.SX.zeros(2)] * 2, x, q).T
        own = [ca.vertcat(ca.mtimes(back, end[:2]), end[2]) for end in v]
        return cls.kinetic_seen(own, x, q)

    @classmethod
    def kinetic_seen(cls, v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        length, mass = cls.length(x), q["density"] * q["area"]
        first, second = (end[0] for end in v)
        ends = [motion for end in v for motion in (end[1], end[2])]
        bent = cls.bending(x, q).kinetic(ends, mass, cls.rotary_inertia(q))
        return linear_kinetic(first, second, mass * length) + bent

    @classmethod
    def recovered(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> Named:
        beam, turns, length = cls.bending(x, q), cls.end_turns(u, x), cls.length(x)
        moment_i, moment_j = beam.moments(*turns)
        shear = (moment_i + moment_j) / length
        eased = beam.rigidity * cls.thermal_curvature(q)
        strain = (cls.elongation(u, x) + beam.bow(*turns)) / length
        axial = q["modulus"] * q["area"] * (strain - q["expansion"] * q["temperature"])
        return {
            "force": (axial, "N"),
            "stress": (axial / q["area"], "Pa"),
            "shear": (shear, "N"),
            "moment_i": (moment_i + eased, "N m"),
            "moment_j": (moment_j - eased, "N m"),
        }


@dataclass(eq=False)
class TimoshenkoFrame(Frame):
    """Frame element that shear deforms too, ``φ = 12 E I / (G A_s L²)``, with rotary inertia.

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
