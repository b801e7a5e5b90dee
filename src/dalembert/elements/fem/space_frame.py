"""Spatial frame elements with axial force, shear, bending and torsion.

Co-rotational as in the plane: the element axes rotate with the chord and, about the chord, with the
mean of its ends (Crisfield; Battini and Pacoste, Computer Methods in Applied Mechanics and
Engineering 191, 2002), and its inertia with them. Rotations of nodes are of any size: matrices in a
mechanism, rotation vectors shorter than 2π in a structure. Rotations of the ends relative to the
element axes are below π.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Scalar, Vector, quantity
from dalembert.elements.fem.energies import Named
from dalembert.elements.fem.lines import Bending, Line, linear_kinetic
from dalembert.elements.fem.nodal import rotation_vector, turn_of
from dalembert.elements.look import Diagram
from dalembert.errors import ModelError

UPRIGHT = 1e-3
"""Sine of the angle to the z axis below which a beam counts as vertical."""


@dataclass(eq=False)
class SpaceFrame(Line):
    """Euler–Bernoulli beam between two spatial nodes.

    ``W = E A e²/(2L) + G J (φ_xj − φ_xi)²/(2L)`` plus the bending energy of the planar frame in
    both principal planes, with the elongation ``e`` of the bent axis and the rotations ``φ`` of its
    ends relative to the element axes: x along it, y towards ``orientation``, z normal to both.

    Parameters
    ----------
    area : cross-section [m²]
    second_moment_y, second_moment_z : second moments of area about the element y and z axes [m⁴]
    torsion_constant : ``J`` [m⁴]
    modulus : Young's modulus [Pa]
    shear_modulus : ``G`` [Pa]
    density : [kg/m³]
    expansion : coefficient of thermal expansion ``α`` [1/K]
    temperature : change ``ΔT`` from the stress-free state, for every load case [K]
    temperature_gradient_y, temperature_gradient_z : its derivatives along y and z [K/m]
    orientation : (3,) direction in the plane of the element x and y axes; zero for the global z
        axis, or the y axis if the beam is vertical

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> shelf = da.Structure("bracket")
    >>> wall, end = shelf.node("wall", 0, 0, 0), shelf.node("end", 1, 0, 0)
    >>> steel, profile = structures.Material(2.08e11, 0.3), structures.tube(0.05, 0.005)
    >>> numbers = steel.of(structures.SpaceFrame) | profile.of(structures.SpaceFrame)
    >>> arm = shelf.add(structures.SpaceFrame("arm", wall, end, **numbers))
    >>> shelf.support(wall)
    >>> shelf.load(end, mx=100.0)
    >>> twist = da.solve_statics(shelf.build())["end.rx"]
    >>> round(twist * 8e10 * float(profile.torsion_constant), 6)  # M L
    100.0
    """

    area: Scalar = quantity("m^2", "cross-section", above=0.0, keyword=True)
    second_moment_y: Scalar = quantity("m^4", "about its y axis", above=0.0, keyword=True)
    second_moment_z: Scalar = quantity("m^4", "about its z axis", above=0.0, keyword=True)
    torsion_constant: Scalar = quantity("m^4", "torsion constant", above=0.0, keyword=True)
    modulus: Scalar = quantity("Pa", "Young's modulus", above=0.0, keyword=True)
    shear_modulus: Scalar = quantity("Pa", "shear modulus", above=0.0, keyword=True)
    density: Scalar = quantity("kg/m^3", "density", default=0.0, minimum=0.0, keyword=True)
    expansion: Scalar = quantity("1/K", "thermal expansion", default=0.0, keyword=True)
    temperature: Scalar = quantity("K", "change of temperature", default=0.0, keyword=True)
    temperature_gradient_y: Scalar = quantity("K/m", "rise along y", default=0.0, keyword=True)
    temperature_gradient_z: Scalar = quantity("K/m", "rise along z", default=0.0, keyword=True)
    orientation: Vector = quantity(
        "", "direction towards its y axis", default=(0.0, 0.0, 0.0), size=3, keyword=True
    )
    turns: ClassVar[bool] = True
    floats: ClassVar[bool] = True
    dimensions: ClassVar[tuple[int, ...]] = (3,)
    diagrams: ClassVar[dict[str, Diagram]] = {
        "force": Diagram("force", "force"),
        "torque": Diagram("torque", "torque"),
        "shear y": Diagram("shear_y", "shear_y"),
        "shear z": Diagram("shear_z", "shear_z", across=2),
        "moment y": Diagram("moment_y_i", "moment_y_j", -1.0, across=2),
        "moment z": Diagram("moment_z_i", "moment_z_j", -1.0, across=-1),
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.node_i.dimension != 3:
            raise ModelError(
                "is a spatial element, whose nodes have three coordinates; use Frame in the plane",
                self.name,
            )

    # geometry -----------------------------------------------------------------------------
    @classmethod
    def axes(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        """Undeformed element axes as columns."""
        first = (x[1] - x[0]) / cls.length(x)
        third = ca.cross(first, cls._reference_direction(first, q))
        third /= ca.norm_2(third)
        return ca.horzcat(first, ca.cross(third, first), third)

    @staticmethod
    def _reference_direction(axis: ca.SX, q: dict[str, ca.SX]) -> ca.SX:
        """The orientation or its default."""
        orientation = q["orientation"]
        upright = ca.sumsqr(axis[:2]) < UPRIGHT**2
        default = ca.if_else(upright, ca.DM([0, 1, 0]), ca.DM([0, 0, 1]))
        return ca.if_else(ca.sumsqr(orientation) > 0, orientation, default)

    @classmethod
    def end_rotations(
        cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]
    ) -> tuple[ca.SX, ca.SX]:
        """Rotation vectors of the ends relative to the rotated element axes, in these axes."""
        axes, ends = cls.turned_axes(u, x, q)
        first, second = (rotation_vector(ca.mtimes(axes.T, end)) for end in ends)
        return first, second

    @classmethod
    def turned_axes(
        cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]
    ) -> tuple[ca.SX, list[ca.SX]]:
        """Rotated element axes, and those of its ends, as columns."""
        before = cls.axes(x, q)
        ends = [ca.mtimes(turn_of(end), before) for end in u]
        chord = x[1] - x[0] + u[1][:3] - u[0][:3]
        first = chord / ca.norm_2(chord)
        third = ca.cross(first, ends[0][:, 1] + ends[1][:, 1])
        third /= ca.norm_2(third)
        return ca.horzcat(first, ca.cross(third, first), third), ends

    # energies -----------------------------------------------------------------------------
    @classmethod
    def bending(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> tuple[Bending, Bending]:
        """Bending about the y and the z axis."""
        length, (soft_y, soft_z) = cls.length(x), cls.shear_softness(x, q)
        return (
            Bending(length, q["modulus"] * q["second_moment_y"], soft_y),
            Bending(length, q["modulus"] * q["second_moment_z"], soft_z),
        )

    @classmethod
    def shear_softness(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> tuple[ca.SX, ca.SX]:
        """``φ = 12 E I/(G A_s L²)`` of bending about y and z; zero for rigid shear."""
        return ca.SX(0), ca.SX(0)

    @classmethod
    def rotary_inertia(cls, q: dict[str, ca.SX]) -> tuple[ca.SX, ca.SX]:
        """``ρ I`` about y and z of elements with rotary inertia [kg m]."""
        return ca.SX(0), ca.SX(0)

    @classmethod
    def strains(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        first, second = cls.end_rotations(u, x, q)
        elongation, twist = cls.lengthening(u, x, q, first, second), second[0] - first[0]
        return ca.vertcat(elongation, twist, first[1], second[1], first[2], second[2])

    @classmethod
    def energy_of(cls, strains: ca.SX, x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        length, (about_y, about_z) = cls.length(x), cls.bending(x, q)
        elongation, angle, *rotations = ca.vertsplit(strains)
        axial = q["modulus"] * q["area"] * elongation**2
        twist = q["shear_modulus"] * q["torsion_constant"] * angle**2
        bending = about_y.energy(*rotations[:2]) + about_z.energy(*rotations[2:])
        return (axial + twist) / (2 * length) + bending

    @classmethod
    def lengthening(cls, u, x, q: dict[str, ca.SX], first: ca.SX, second: ca.SX) -> ca.SX:
        """Elongation of the axis bent by the rotations of its ends."""
        about_y, about_z = cls.bending(x, q)
        bow = about_y.bow(first[1], second[1]) + about_z.bow(first[2], second[2])
        return cls.elongation(u, x) + bow

    @classmethod
    def thermal(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        length, (first, second) = cls.length(x), cls.end_rotations(u, x, q)
        strain = q["expansion"] * q["temperature"]
        elongation = cls.lengthening(u, x, q, first, second)
        total = q["modulus"] * q["area"] * strain * (strain * length / 2 - elongation)
        beams, curvatures = cls.bending(x, q), cls.thermal_curvatures(q)
        for k, (beam, curvature) in enumerate(zip(beams, curvatures, strict=True)):
            rotation = second[k + 1] - first[k + 1]
            total += beam.rigidity * curvature * (curvature * length / 2 - rotation)
        return total

    @classmethod
    def thermal_curvatures(cls, q: dict[str, ca.SX]) -> tuple[ca.SX, ca.SX]:
        """Thermal curvatures of a free beam about y and z [1/m]."""
        return (
            q["expansion"] * q["temperature_gradient_z"],
            -q["expansion"] * q["temperature_gradient_y"],
        )

    @classmethod
    def own_axes(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        return cls.turned_axes(u, x, q)[0]

    @classmethod
    def kinetic(cls, v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        to_axes = cls.axes(x, q).T
        velocities = [ca.vec(ca.mtimes(to_axes, ca.reshape(end, 3, 2))) for end in v]
        return cls.kinetic_in_axes(velocities, x, q)

    @classmethod
    def kinetic_in_axes(cls, v: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        length, velocities = cls.length(x), [(end[:3], end[3:]) for end in v]
        mass = q["density"] * q["area"]
        polar = q["density"] * (q["second_moment_y"] + q["second_moment_z"])
        (speed_i, spin_i), (speed_j, spin_j) = velocities
        total = linear_kinetic(speed_i[0], speed_j[0], mass * length)
        total += linear_kinetic(spin_i[0], spin_j[0], polar * length)
        (about_y, about_z), (inertia_y, inertia_z) = cls.bending(x, q), cls.rotary_inertia(q)
        # a positive slope of the deflection along z is a negative rotation about y
        down = [motion for speed, spin in velocities for motion in (-speed[2], spin[1])]
        side = [motion for speed, spin in velocities for motion in (speed[1], spin[2])]
        total += about_y.kinetic(down, mass, inertia_y)
        return total + about_z.kinetic(side, mass, inertia_z)

    @classmethod
    def mass_center(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> ca.SX:
        (about_y, about_z), (first, second) = cls.bending(x, q), cls.end_rotations(u, x, q)
        along_y = about_z.mean_deflection(first[2], second[2])
        along_z = -about_y.mean_deflection(first[1], second[1])
        deflection = ca.mtimes(cls.own_axes(u, x, q)[:, 1:], ca.vertcat(along_y, along_z))
        return cls.middle(u, x) + deflection

    # measures -----------------------------------------------------------------------------
    @classmethod
    def recovered(cls, u: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]) -> Named:
        """Section forces in element axes; moments ``_i``, ``_j`` act on its ends."""
        length, (first, second) = cls.length(x), cls.end_rotations(u, x, q)
        strain = cls.lengthening(u, x, q, first, second) / length
        axial = q["modulus"] * q["area"] * (strain - q["expansion"] * q["temperature"])
        torque = q["shear_modulus"] * q["torsion_constant"] * (second[0] - first[0]) / length
        about_y, about_z = cls.bending(x, q)
        y_i, y_j = about_y.moments(first[1], second[1])
        z_i, z_j = about_z.moments(first[2], second[2])
        curvature_y, curvature_z = cls.thermal_curvatures(q)
        thermal_y, thermal_z = about_y.rigidity * curvature_y, about_z.rigidity * curvature_z
        return {
            "force": (axial, "N"),
            "stress": (axial / q["area"], "Pa"),
            "torque": (torque, "N m"),
            "shear_y": ((z_i + z_j) / length, "N"),
            "shear_z": (-(y_i + y_j) / length, "N"),
            "moment_y_i": (y_i + thermal_y, "N m"),
            "moment_y_j": (y_j - thermal_y, "N m"),
            "moment_z_i": (z_i + thermal_z, "N m"),
            "moment_z_j": (z_j - thermal_z, "N m"),
        }

    @classmethod
    def checks(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> list[tuple[ca.SX, str]]:
        axis = (x[1] - x[0]) / cls.length(x)
        direction = cls._reference_direction(axis, q)
        sine = ca.norm_2(ca.cross(axis, direction)) / ca.norm_2(direction)
        parallel = "has an orientation along its own axis; give a direction across it"
        return [*super().checks(x, q), (sine - UPRIGHT / 2, parallel)]


@dataclass(eq=False)
class TimoshenkoSpaceFrame(SpaceFrame):
    """Spatial frame element with shear deformation and rotary inertia.

    Parameters
    ----------
    shear_area_y, shear_area_z : cross-section times the shear correction factor for shear forces
        along the element y and z axes [m²]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> stub = da.Structure("stub")
    >>> root, tip = stub.node("root", 0, 0, 0), stub.node("tip", 1, 0, 0)
    >>> bending = dict(second_moment_y=1e-4, second_moment_z=1e-4, torsion_constant=2e-4)
    >>> shear = dict(shear_modulus=1e9, shear_area_y=1e-3, shear_area_z=2e-3)
    >>> numbers = dict(area=1e-2, modulus=3e9) | bending | shear
    >>> element = stub.add(structures.TimoshenkoSpaceFrame("stub", root, tip, **numbers))
    >>> stub.support(root)
    >>> stub.load(tip, fy=900.0, fz=900.0)  # element y axis along global z
    >>> result = da.solve_statics(stub.build())
    >>> round(result["tip.uz"] * 1e3, 6), round(result["tip.uy"] * 1e3, 6)  # by shear areas
    (1.9, 1.45)
    """

    shear_area_y: Scalar = quantity("m^2", "for shear along y", above=0.0, keyword=True)
    shear_area_z: Scalar = quantity("m^2", "for shear along z", above=0.0, keyword=True)

    @classmethod
    def shear_softness(cls, x: list[ca.SX], q: dict[str, ca.SX]) -> tuple[ca.SX, ca.SX]:
        ratio = 12 * q["modulus"] / (q["shear_modulus"] * ca.sumsqr(x[1] - x[0]))
        return (
            ratio * q["second_moment_y"] / q["shear_area_z"],
            ratio * q["second_moment_z"] / q["shear_area_y"],
        )

    @classmethod
    def rotary_inertia(cls, q: dict[str, ca.SX]) -> tuple[ca.SX, ca.SX]:
        return q["density"] * q["second_moment_y"], q["density"] * q["second_moment_z"]
