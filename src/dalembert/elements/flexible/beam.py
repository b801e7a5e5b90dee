"""Geometrically exact beams (Reissner, Simo): common part of planar and spatial beams.

A cross-section is at ``r(s)`` with axes ``R(s)``; its strains are those of the centre line in these
axes, and the rate of rotation of the axes along it,

    Γ = Rᵀ r' − Rᵀ₀ r'₀,      K = axial(Rᵀ R') − K₀,      W = ½ ∫ (Γᵀ C_Γ Γ + Kᵀ C_K K) ds,

minus those of the natural shape (Reissner 1972; Simo and Vu-Quoc 1986). Positions and rotations are
polynomials between nodes; strains are evaluated at as many Gauss points as the order, which avoids
shear locking. The mass matrix is that of the polynomials, so that a beam rotates like a rigid bar.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from dalembert.budget import check_budget, numeral
from dalembert.elements.base import (
    ForceElement,
    Look,
    Powers,
    Rate,
    Scalar,
    option,
    quantity,
)
from dalembert.elements.coordinates import rate_of
from dalembert.elements.flexible.nodes import CrossSection, Lagrange, Noded, gauss, through
from dalembert.elements.look import Strand
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression, stack, t
from dalembert.symbolic.once import CacheOwner

STATIONS = {"start": 0.0, "middle": 0.5, "end": 1.0}
"""Stations of internal forces, as fractions of the length."""
ORDERS = (1, 2, 3, 4)
OF_ITS_START = ("position", "angle", "rotation", "velocity", "angular_velocity")
NODE = 1e6
"""Memory of the graphs of a node [bytes]."""


@dataclass(eq=False)
class Beam(CacheOwner, Noded, ForceElement):
    """Common part of planar and spatial beams.

    It extends from ``frame_i`` to ``frame_j`` of bodies, to which it is clamped. If one is omitted
    it ends in a node, ``start`` or ``end``, a body for joints and forces like any other.

    Parameters
    ----------
    length : stress-free length of the centre line [m]
    curvature : curvature of the natural shape, an arc [1/m]
    axial_rigidity, shear_rigidity, mass_per_length : ``E A`` [N], ``G A_s`` [N], ``ρ A`` [kg/m]
    relaxed : a free end starts without strain; otherwise at its assembled position
    damping : time constant ``τ`` of internal forces ``C (ε + τ ε̇)`` (Kelvin and Voigt) [s]
    elements, order : number of elements, and order of their polynomials

    Raises
    ------
    ModelError
        Both ends on one body, an unknown order.
    """

    frame_i: Any = option("frame or point at the start, clamped", default=None)
    frame_j: Any = option("frame or point at the end, clamped", default=None)
    length: Scalar = quantity("m", "length of the centre line", above=0.0, keyword=True)
    curvature: Scalar = quantity("1/m", "natural curvature", default=0.0, keyword=True)
    axial_rigidity: Scalar = quantity("N", "E A", above=0.0, keyword=True)
    shear_rigidity: Scalar = quantity("N", "G A_s", above=0.0, keyword=True)
    mass_per_length: Scalar = quantity("kg/m", "ρ A", default=0.0, minimum=0.0, keyword=True)
    damping: Scalar = quantity("s", "lead of internal forces", default=0.0, minimum=0.0)
    relaxed: bool = option("a free end starts without strain", default=True, keyword=True)
    elements: int = option("number of elements", default=4, keyword=True)
    order: int = option("order of their polynomials, 1 to 4", default=3, keyword=True)
    dimension: ClassVar[int]

    def __post_init__(self) -> None:
        super().__post_init__()
        if type(self.elements) is not int or self.elements < 1:
            message = f"elements is {self.elements!r}; give a whole number from 1 on"
            raise ModelError(message, self.name)
        subject = f"elements = {numeral(self.elements)} of {self.name}"
        check_budget(subject, memory=NODE * self.elements * self.order, cure="give fewer elements")
        if self.order not in ORDERS:
            raise ModelError(f"order is {self.order!r}; give 1, 2, 3 or 4", self.name)
        idle = [name for name in OF_ITS_START if getattr(self, name, None) is not None]
        if self.frame_i is not None and idle:
            raise ModelError(
                f"{idle[0]} is given, but its start is clamped at frame_i, which determines it; "
                "leave one of them out",
                self.name,
            )
        self.nodes = self._create_nodes()
        self.sections = [self._section(k) for k in range(self.count)]

    # shape ------------------------------------------------------------------------------------
    def natural(self, s: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Position (2,) and angle on the natural arc, from its start."""
        half = self.curvature.sx * s / 2
        if half.is_zero():
            return ca.vertcat(s, 0), ca.SX(0)
        straight = half == 0
        chord = s * ca.if_else(straight, 1, ca.sin(half) / ca.if_else(straight, 1, half))
        return chord * ca.vertcat(ca.cos(half), ca.sin(half)), 2 * half

    def natural_section(self, s: ca.SX) -> CrossSection:
        """The cross-section on the natural arc."""
        raise NotImplementedError

    @cached_property
    def shapes(self) -> Lagrange:
        return Lagrange(self.order)

    def strain(
        self, sections: Sequence[CrossSection], values: np.ndarray, slopes: np.ndarray
    ) -> ca.SX:
        """Total strains ``(Γ, K)`` between the sections of an element.

        Parameters
        ----------
        values, slopes : (p + 1,) of the polynomials, and their derivatives by s over the length
        """
        raise NotImplementedError

    @cached_property
    def _element(self) -> tuple[ca.Function, ca.SX]:
        """``(places, turns, parameters) → strains`` (m, p) of an element at Gauss points."""
        points, _ = gauss(self.order)
        values, slopes = self.shapes.values(points), self.shapes.slopes(points) * self.elements
        template = self.sections[0]
        places = ca.SX.sym("place", template.place.numel(), self.order + 1)
        turns = ca.SX.sym("turn", template.turn.numel(), self.order + 1)
        sections = [
            CrossSection(place, turn, template.spin)
            for place, turn in zip(ca.horzsplit(places), ca.horzsplit(turns), strict=True)
        ]
        arc = self.length.sx * self.shapes.nodes / self.elements
        natural = [self.natural_section(s) for s in ca.vertsplit(arc)]
        strains = [
            self.strain(sections, n, slope) - self.strain(natural, n, slope)
            for n, slope in zip(values, slopes, strict=True)
        ]
        stacked = ca.horzcat(*strains)
        symbols = {s.element_hash() for s in ca.vertsplit(ca.veccat(places, turns))}
        parameters = [s for s in ca.symvar(stacked) if s.element_hash() not in symbols]
        inputs = [places, turns, ca.vertcat(*parameters)]
        return ca.Function("strains", inputs, [stacked], {"cse": True}), inputs[2]

    @cached_property
    def strains(self) -> list[tuple[ca.SX, float]]:
        """(strains relative to the natural shape, fraction of the length) at every Gauss point."""
        function, parameters = self._element
        weights = [float(w) / self.elements for w in gauss(self.order)[1]]
        strains_and_weights: list[tuple[ca.SX, float]] = []
        for e in range(self.elements):
            sections = self.sections[e * self.order : (e + 1) * self.order + 1]
            places, turns = ([getattr(s, name) for s in sections] for name in ("place", "turn"))
            strains = function(ca.horzcat(*places), ca.horzcat(*turns), parameters)
            strains_and_weights += zip(ca.horzsplit(strains), weights, strict=True)
        return strains_and_weights

    def material_inertia(self, rigidity: ca.SX) -> ca.SX:
        """``ρ I`` of a homogeneous beam from ``E I``."""
        return self.mass_per_length.sx * rigidity / self.axial_rigidity.sx

    def rigidities(self) -> ca.SX:
        """Diagonal of ``(C_Γ, C_K)``."""
        raise NotImplementedError

    def fibre_strain(self, strain: ca.SX) -> ca.SX:
        """Strains of the centre line, and of bending and torsion at the edge of a solid section.

        The section is a rectangle with these rigidities, ``κ √3 √(E I/E A)``.
        """
        rigidities = self.rigidities()
        axial = self.axial_rigidity.sx
        edge = ca.sqrt(3 * rigidities[self.dimension :] / axial)
        return ca.vertcat(strain[: self.dimension], strain[self.dimension :] * edge)

    # forces -----------------------------------------------------------------------------------
    def powers(self, rate: Rate) -> Powers:
        time_constant, rigidities, length = self.damping.sx, self.rigidities(), self.length.sx
        return [
            (speed, -length * weight * rigidities * (strain + time_constant * speed))
            for (strain, weight), speed in zip(self.strains, self._strain_rates(rate), strict=True)
        ]

    def _strain_rates(self, rate: Rate) -> list[ca.SX]:
        """Rates of all strains, computed together because each depends on all nodes."""
        strains = ca.horzcat(*(strain for strain, _ in self.strains))
        return ca.horzsplit(ca.reshape(rate(ca.vec(strains)), strains.shape))

    def potential(self) -> ca.SX:
        rigidities = self.rigidities()
        total = sum((weight * ca.dot(rigidities, e**2) for e, weight in self.strains), ca.SX(0))
        return self.length.sx * total / 2

    def dissipation(self, rate: Rate) -> Powers:
        if self.damping.sx.is_zero():
            return []
        viscous = self.length.sx * self.damping.sx * self.rigidities()
        return [
            (speed, -weight * viscous * speed)
            for (_, weight), speed in zip(self.strains, self._strain_rates(rate), strict=True)
        ]

    # inertia ----------------------------------------------------------------------------------
    def _summed(self, entries: np.ndarray) -> np.ndarray:
        """Assembly of an element vector (p + 1,) or matrix (p + 1, p + 1) over all elements."""
        total = np.zeros((self.count,) * entries.ndim)
        for e in range(self.elements):
            indices = slice(e * self.order, (e + 1) * self.order + 1)
            total[(indices,) * entries.ndim] += entries / self.elements
        return total

    def inertial_powers(self, rate: Rate) -> Powers:
        if self.mass_per_length.sx.is_zero():
            return []
        shared, d = self._summed(self.shapes.products), self.dimension
        velocity = rate(stack(section.place for section in self.sections))
        mass = self.length.sx * self.mass_per_length.sx
        coupled = ca.kron(ca.sparsify(ca.DM(shared)), ca.DM.eye(d))
        translation = (velocity, mass * ca.mtimes(coupled, rate(velocity)))
        return [translation, *self.rotary_powers(rate, shared, self._summed(self.shapes.shares))]

    def rotary_powers(self, rate: Rate, shared: np.ndarray, shares: np.ndarray) -> Powers:
        """Powers of the rotary inertia of sections."""
        raise NotImplementedError

    def masses(self) -> list[tuple[ca.SX, ca.SX]]:
        mass = self.length.sx * self.mass_per_length.sx
        fractions = self._summed(self.shapes.shares)
        return [
            (s.place, mass * fraction) for s, fraction in zip(self.sections, fractions, strict=True)
        ]

    # start ------------------------------------------------------------------------------------
    def shape_error(self, k: int) -> ca.SX:
        """Deviation of a node from the natural shape, fitted to the start and the end."""
        raise NotImplementedError

    def initial_conditions(self) -> list[tuple[Expression, Expression]]:
        """Initial conditions: nodes are on the natural shape and move with it."""
        last = self.count - 1
        free = [k for k in self.nodes if 0 < k < last or (k == last and self.relaxed)]
        errors = stack(self.shape_error(k) for k in free)
        rates = rate_of(errors, self.parts(), t.sx)
        return [(Expression(e), Expression(0)) for e in ca.vertsplit(ca.vertcat(errors, rates))]

    # measures ---------------------------------------------------------------------------------
    def forces_at(self, share: float) -> ca.SX:
        """Internal forces ``(C_Γ Γ, C_K K)`` at a fraction of the length."""
        if not 0 <= share <= 1:
            raise ModelError(f"{share} is not a fraction of the length; give 0 to 1", self.name)
        e = min(int(share * self.elements), self.elements - 1)
        points = self.strains[e * self.order : (e + 1) * self.order]
        weights = through(gauss(self.order)[0], share * self.elements - e)
        pairs = zip(weights, points, strict=True)
        return self.rigidities() * sum((w * strain for w, (strain, _) in pairs), ca.SX(0))

    force_names: ClassVar[tuple[tuple[str, str], ...]]
    """Names and units of internal forces."""

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        measures = {"strain_energy": (self.potential(), "J")}
        for station, fraction in STATIONS.items():
            forces = self.forces_at(fraction)
            for k, (name, unit) in enumerate(self.force_names):
                measures[f"{station}_{name}"] = (forces[k], unit)
        return measures

    def look(self) -> list[Look]:
        ends = [self.spot(k) for k in range(self.count)]
        return [Strand(i, j) for i, j in pairwise(ends)]
