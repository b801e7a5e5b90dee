"""Continuum elements with numerical integration.

``W = ∫ (λ/2 (tr 𝗘)² + μ 𝗘:𝗘) dV`` with Green's strain ``𝗘 = (𝗙ᵀ𝗙 − 𝟭)/2`` (St Venant–Kirchhoff),
which is invariant under rotations; for small displacements it is Hooke's law. The same class serves
planar and spatial elements and all reference cells.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.cells import CELLS
from dalembert.elements.fem.energies import Named
from dalembert.elements.fem.nodal import Nodal
from dalembert.elements.fem.reference_cells import REFERENCE_CELLS, ReferenceCell
from dalembert.errors import ModelError

AXES = ("x", "y", "z")


@dataclass(eq=False)
class Continuum(StructuralElement):
    """A cell of isotropic material.

    Parameters
    ----------
    connectivity : its nodes, in the order of VTK and meshio: corners, then midpoints of edges
    modulus : Young's modulus [Pa]
    poisson : Poisson's ratio [-]
    density : [kg/m³]
    expansion : coefficient of thermal expansion ``α`` [1/K]
    temperature : change ``ΔT`` from the stress-free state, for every load case [K]
    """

    connectivity: tuple[Nodal, ...]
    modulus: Scalar = quantity("Pa", "Young's modulus", above=0.0, keyword=True)
    poisson: Scalar = quantity("", "Poisson's ratio", default=0.3, above=-1.0, keyword=True)
    density: Scalar = quantity("kg/m^3", "density", default=0.0, minimum=0.0, keyword=True)
    expansion: Scalar = quantity("1/K", "thermal expansion", default=0.0, keyword=True)
    temperature: Scalar = quantity("K", "change of temperature", default=0.0, keyword=True)

    contractible: ClassVar[bool] = True
    cell: ClassVar[ReferenceCell]

    def __init_subclass__(cls, cell: str = "", **options) -> None:
        """``cell`` : name of the reference cell of a class."""
        super().__init_subclass__(**options)
        if not cell:
            return
        cls.cell = REFERENCE_CELLS[cell]
        cls.node_count, cls.dimensions = len(cls.cell.nodes), (cls.cell.dimension,)
        cls.samples, cls.kinetic_samples = cls.cell.samples, cls.cell.kinetic_samples
        points = {"": cls.cell.centre} | {f"n{k}": p for k, p in enumerate(cls.cell.nodes)}
        cls.stations = {name: (*point, 1.0) for name, point in points.items()}

    def __post_init__(self) -> None:
        super().__post_init__()
        self.connectivity = tuple(self.connectivity)
        if len(self.connectivity) != self.node_count:
            raise ModelError(
                f"has {len(self.connectivity)} nodes, needs {self.node_count}", self.name
            )
        d = self.cell.dimension
        for node in self.connectivity:
            if not isinstance(node, Nodal) or node.dimension != d:
                raise ModelError(f"needs nodes with {d} coordinates; got {node!r}", self.name)

    def nodes(self) -> tuple[Nodal, ...]:
        return self.connectivity

    # geometry -----------------------------------------------------------------------------
    @classmethod
    def _jacobian(cls, x: list[ca.SX], q: dict) -> tuple[ca.SX, ca.SX]:
        """Derivatives of the shape functions (nodes, d) and of the position (d, d)."""
        natural = q["at"][:-1]
        slopes = ca.jacobian(cls.cell.shape_functions(natural), natural)
        return slopes, ca.mtimes(ca.horzcat(*x), slopes)

    @classmethod
    def slopes(cls, x: list[ca.SX], q: dict) -> tuple[ca.SX, ca.SX]:
        """Derivatives ``∇N`` (nodes, d) by position, and the volume of the sample."""
        slopes, jacobian = cls._jacobian(x, q)
        volume = q["at"][-1] * ca.det(jacobian) * cls.depth(q)
        return ca.mtimes(slopes, ca.inv_minor(jacobian)), volume

    @classmethod
    def depth(cls, q: dict) -> ca.SX:
        """Volume per measure of the cell: the thickness of planar elements."""
        return ca.SX(1)

    # material -----------------------------------------------------------------------------
    @classmethod
    def lame(cls, q: dict) -> tuple[ca.SX, ca.SX]:
        """``λ, μ`` of Hooke's law."""
        e, nu = q["modulus"], q["poisson"]
        return e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))

    @classmethod
    def compressibility(cls, q: dict) -> ca.SX:
        """Expression that is positive if Hooke's law is invertible."""
        return 1 - 2 * q["poisson"]

    @staticmethod
    def strain(gradient: ca.SX) -> ca.SX:
        """Green's strain from the displacement gradient."""
        return (gradient + gradient.T + ca.mtimes(gradient.T, gradient)) / 2

    @classmethod
    def energy_density(cls, strain: ca.SX, q: dict) -> ca.SX:
        """Energy per volume of a strain tensor."""
        first, second = cls.lame(q)
        return first / 2 * ca.trace(strain) ** 2 + second * ca.sumsqr(strain)

    @classmethod
    def strains(cls, u: list[ca.SX], x: list[ca.SX], q: dict) -> ca.SX:
        return ca.vec(cls.strain(ca.mtimes(ca.horzcat(*u), cls.slopes(x, q)[0])))

    @classmethod
    def energy_of(cls, strains: ca.SX, x: list[ca.SX], q: dict) -> ca.SX:
        d = len(ca.vertsplit(x[0]))
        return cls.slopes(x, q)[1] * cls.energy_density(ca.reshape(strains, d, d), q)

    @classmethod
    def thermal(cls, u: list[ca.SX], x: list[ca.SX], q: dict) -> ca.SX:
        slopes, volume = cls.slopes(x, q)
        strain = cls.strain(ca.mtimes(ca.horzcat(*u), slopes))
        free_strain = cls.free_directions(q) * q["expansion"] * q["temperature"]
        return volume * cls.thermal_stress(q) * (free_strain / 2 - ca.trace(strain))

    @classmethod
    def free_directions(cls, q: dict) -> int:
        """Number of directions of free thermal expansion."""
        return 3

    @classmethod
    def thermal_stress(cls, q: dict) -> ca.SX:
        """Pressure that suppresses the thermal expansion [Pa]."""
        first, second = cls.lame(q)
        return (3 * first + 2 * second) * q["expansion"] * q["temperature"]

    @classmethod
    def kinetic(cls, v: list[ca.SX], x: list[ca.SX], q: dict) -> ca.SX:
        shapes = cls.cell.shape_functions(q["at"][:-1])
        velocity = ca.mtimes(ca.horzcat(*v), shapes)
        volume = q["at"][-1] * ca.det(cls._jacobian(x, q)[1]) * cls.depth(q)
        return q["density"] * volume * ca.sumsqr(velocity) / 2

    # measures -----------------------------------------------------------------------------
    @classmethod
    def recovered(cls, u: list[ca.SX], x: list[ca.SX], q: dict) -> Named:
        """Green's strain (tensor components) and the second Piola–Kirchhoff stress."""
        strain = cls.strain(ca.mtimes(ca.horzcat(*u), cls.slopes(x, q)[0]))
        first, second = cls.lame(q)
        d = strain.shape[0]
        mean = first * ca.trace(strain) - cls.thermal_stress(q)
        stress = mean * ca.SX.eye(d) + 2 * second * strain
        measures: Named = {}
        for letter, tensor, unit in (("s", stress, "Pa"), ("e", strain, "")):
            for i, j in _components(d):
                measures[f"{letter}{AXES[i]}{AXES[j]}"] = (tensor[i, j], unit)
        return measures

    @classmethod
    def derived(cls, measured: dict[str, ca.SX], q: dict) -> Named:
        """Von Mises stress."""
        zero = ca.SX(0)
        x, y = measured["sxx"], measured["syy"]
        z = cls.across_stress(measured, q)
        shear = [measured.get(name, zero) for name in ("sxy", "syz", "sxz")]
        square = ((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) / 2
        square += 3 * sum(s**2 for s in shear)
        is_zero = square <= 0  # the derivative at zero stress is set to zero
        root = ca.if_else(is_zero, 0.0, ca.sqrt(ca.if_else(is_zero, 1.0, square)))
        return {"von_mises": (root, "Pa")}

    @classmethod
    def across_stress(cls, measured: dict[str, ca.SX], q: dict) -> ca.SX:
        """Normal stress along z."""
        return measured["szz"]

    @classmethod
    def checks(cls, x: list[ca.SX], q: dict) -> list[tuple[ca.SX, str]]:
        return [
            (
                ca.det(cls._jacobian(x, q)[1]),
                "is turned inside out or degenerate (Jacobian {:.3g} at an integration point); "
                + cls.counting,
            ),
            (cls.compressibility(q), "is incompressible; Poisson's ratio must be lower"),
        ]

    @classmethod
    def outlines(cls) -> tuple[tuple[int, ...], ...]:
        shape = cls.cell.dimension, cls.node_count
        return next(c.faces for c in CELLS.values() if (c.dimension, c.nodes) == shape)

    counting: ClassVar[str] = "move its nodes, or count them in the order of VTK"


def _components(d: int) -> list[tuple[int, int]]:
    """Normal components, then ``xy``, ``yz``, ``xz``."""
    return [(i, i) for i in range(d)] + [(0, 1), (1, 2), (0, 2)][: 1 if d == 2 else 3]
