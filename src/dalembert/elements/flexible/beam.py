"""Beams that turn and bend without limit: the geometrically exact beam of Reissner and Simo.

A cross-section is at ``r(s)`` with axes ``R(s)``; its strains are those of its centre line seen
from these axes, and how fast the axes turn along it,

    Γ = Rᵀ r' − Rᵀ₀ r'₀,      K = axial(Rᵀ R') − K₀,      W = ½ ∫ (Γᵀ C_Γ Γ + Kᵀ C_K K) ds,

less those of the natural shape (Reissner 1972; Simo and Vu-Quoc 1986). Places and turns are
polynomials between nodes, strains are taken at as many points of Gauss as the order, where shear
does not lock; the mass is that of the polynomials, so that a beam turns as a rigid bar does.
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
from dalembert.elements.flexible.interpolation import Lagrange, gauss, through
from dalembert.elements.flexible.nodes import CrossSection, Noded
from dalembert.elements.look import Strand
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import Expression, stack, t

STATIONS = {"start": 0.0, "middle": 0.5, "end": 1.0}
"""Where forces inside are named, in shares of the length."""
ORDERS = (1, 2, 3, 4)
OF_ITS_START = ("position", "angle", "rotation", "velocity", "angular_velocity")
NODE = 1e6
"""Bytes of the graphs of a node, whose constraints and inertia take far longer than that."""


@dataclass(eq=False)
class Beam(Noded, ForceElement):
    """What beams of the plane and of space share.

    It reaches from one section to another, at ``frame_i`` and ``frame_j`` of bodies, which it is
    clamped to. Where none is given it ends in a node of its own, ``start`` or ``end``, a body on
    which joints and forces hold like on any other.

    Parameters
    ----------
    length : along the centre line, free of stress [m]
    curvature : of the natural shape, an arc [1/m]
    axial_rigidity, shear_rigidity, mass_per_length : ``E A`` [N], ``G A_s`` [N], ``ρ A`` [kg/m]
    relaxed : an end of its own is where its start carries it; otherwise where it was assembled
    damping : time by which internal forces lead, ``C (ε + τ ε̇)`` (Kelvin and Voigt) [s]
    elements, order : number of elements, and the order of their polynomials

    Raises
    ------
    ModelError
        Both ends on one body, an unknown order.
    """

    frame_i: Any = option("where it starts", default=None)
    frame_j: Any = option("where it ends", default=None)
    length: Scalar = quantity("m", "length of the centre line", above=0.0, keyword=True)
    curvature: Scalar = quantity("1/m", "natural curvature", default=0.0, keyword=True)
    axial_rigidity: Scalar = quantity("N", "E A", above=0.0, keyword=True)
    shear_rigidity: Scalar = quantity("N", "G A_s", above=0.0, keyword=True)
    mass_per_length: Scalar = quantity("kg/m", "ρ A", default=0.0, minimum=0.0, keyword=True)
    damping: Scalar = quantity("s", "lead of internal forces", default=0.0, minimum=0.0)
    relaxed: bool = option("its own end starts free of strain", default=True, keyword=True)
    elements: int = option("number of elements", default=4, keyword=True)
    order: int = option("order of their polynomials, 1 to 4", default=3, keyword=True)
    dimension: ClassVar[int]

    def __post_init__(self) -> None:
        super().__post_init__()
        if type(self.elements) is not int or self.elements < 1:
            told = f"elements is {self.elements!r}; give a whole number from 1 on"
            raise ModelError(told, self.name)
        what = f"elements = {numeral(self.elements)} of {self.name}"
        check_budget(what, memory=NODE * self.elements * self.order, cure="give fewer elements")
        if self.order not in ORDERS:
            raise ModelError(f"order is {self.order!r}; give 1, 2, 3 or 4", self.name)
        idle = [name for name in OF_ITS_START if getattr(self, name, None) is not None]
        if self.frame_i is not None and idle:
            raise ModelError(
                f"{idle[0]} is given, and its start is clamped at frame_i, which tells where it "
                "is; leave one of them out",
                self.name,
            )
        self.nodes = self._made_nodes()
        self.sections = [self._section(k) for k in range(self.count)]

    # shape ------------------------------------------------------------------------------------
    def natural(self, s: ca.SX) -> tuple[ca.SX, ca.SX]:
        """Place (2,) and angle on the natural arc, from its start."""
        half = self.curvature.sx * s / 2
        if half.is_zero():
            return ca.vertcat(s, 0), ca.SX(0)
        straight = half == 0
        chord = s * ca.if_else(straight, 1, ca.sin(half) / ca.if_else(straight, 1, half))
        return chord * ca.vertcat(ca.cos(half), ca.sin(half)), 2 * half

    def natural_section(self, s: ca.SX) -> CrossSection:
        """The same as a section."""
        raise NotImplementedError

    @cached_property
    def shapes(self) -> Lagrange:
        return Lagrange(self.order)

    def strain(
        self, sections: Sequence[CrossSection], values: np.ndarray, slopes: np.ndarray
    ) -> ca.SX:
        """Strains ``(Γ, K)`` between the sections of an element, from no reference.

        Parameters
        ----------
        values, slopes : (p + 1,) of the polynomials there, by share of the length
        """
        raise NotImplementedError

    @cached_property
    def _element(self) -> tuple[ca.Function, ca.SX]:
        """``(places, turns, others) → strains`` (m, p) of an element at its points of Gauss."""
        at, _ = gauss(self.order)
        values, slopes = self.shapes.values(at), self.shapes.slopes(at) * self.elements
        like = self.sections[0]
        places = ca.SX.sym("place", like.place.numel(), self.order + 1)
        turns = ca.SX.sym("turn", like.turn.numel(), self.order + 1)
        own = [
            CrossSection(place, turn, like.spin)
            for place, turn in zip(ca.horzsplit(places), ca.horzsplit(turns), strict=True)
        ]
        first = self.length.sx * self.shapes.nodes / self.elements
        natural = [self.natural_section(s) for s in ca.vertsplit(first)]
        strains = [
            self.strain(own, n, slope) - self.strain(natural, n, slope)
            for n, slope in zip(values, slopes, strict=True)
        ]
        stacked = ca.horzcat(*strains)
        known = {s.element_hash() for s in ca.vertsplit(ca.veccat(places, turns))}
        others = [s for s in ca.symvar(stacked) if s.element_hash() not in known]
        inputs = [places, turns, ca.vertcat(*others)]
        return ca.Function("strains", inputs, [stacked], {"cse": True}), inputs[2]

    @cached_property
    def strains(self) -> list[tuple[ca.SX, float]]:
        """(strains less those of the natural shape, share of the length) by point of Gauss."""
        function, others = self._element
        weights = [float(w) / self.elements for w in gauss(self.order)[1]]
        found: list[tuple[ca.SX, float]] = []
        for e in range(self.elements):
            own = self.sections[e * self.order : (e + 1) * self.order + 1]
            places, turns = ([getattr(s, name) for s in own] for name in ("place", "turn"))
            strains = function(ca.horzcat(*places), ca.horzcat(*turns), others)
            found += zip(ca.horzsplit(strains), weights, strict=True)
        return found

    def material_inertia(self, rigidity: ca.SX) -> ca.SX:
        """``ρ I`` of a beam of one material, of ``E I``."""
        return self.mass_per_length.sx * rigidity / self.axial_rigidity.sx

    def rigidities(self) -> ca.SX:
        """Diagonal of ``(C_Γ, C_K)``."""
        raise NotImplementedError

    def fibre_strain(self, strain: ca.SX) -> ca.SX:
        """Strain of the centre line, and of bending and torsion at the edge of a solid section.

        The section is a rectangle with these rigidities, ``κ √3 √(E I/E A)``.
        """
        rigid = self.rigidities()
        stretched = self.axial_rigidity.sx
        edge = ca.sqrt(3 * rigid[self.dimension :] / stretched)
        return ca.vertcat(strain[: self.dimension], strain[self.dimension :] * edge)

    # forces -----------------------------------------------------------------------------------
    def powers(self, rate: Rate) -> Powers:
        lead, rigid, length = self.damping.sx, self.rigidities(), self.length.sx
        return [
            (speed, -length * weight * rigid * (strain + lead * speed))
            for (strain, weight), speed in zip(self.strains, self._strain_rates(rate), strict=True)
        ]

    def _strain_rates(self, rate: Rate) -> list[ca.SX]:
        """Of all strains, taken at once: a rate looks at all nodes."""
        each = ca.horzcat(*(strain for strain, _ in self.strains))
        return ca.horzsplit(ca.reshape(rate(ca.vec(each)), each.shape))

    def potential(self) -> ca.SX:
        rigid = self.rigidities()
        total = sum((weight * ca.dot(rigid, e**2) for e, weight in self.strains), ca.SX(0))
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
    def _summed(self, part: np.ndarray) -> np.ndarray:
        """Entries of one element, (p + 1,) or (p + 1, p + 1), added up over all of them."""
        total = np.zeros((self.count,) * part.ndim)
        for e in range(self.elements):
            own = slice(e * self.order, (e + 1) * self.order + 1)
            total[(own,) * part.ndim] += part / self.elements
        return total

    def inertial_powers(self, rate: Rate) -> Powers:
        if self.mass_per_length.sx.is_zero():
            return []
        shared, d = self._summed(self.shapes.products), self.dimension
        velocity = rate(stack(section.place for section in self.sections))
        mass = self.length.sx * self.mass_per_length.sx
        coupled = ca.kron(ca.sparsify(ca.DM(shared)), ca.DM.eye(d))
        moved = (velocity, mass * ca.mtimes(coupled, rate(velocity)))
        return [moved, *self.rotary_powers(rate, shared, self._summed(self.shapes.shares))]

    def rotary_powers(self, rate: Rate, shared: np.ndarray, shares: np.ndarray) -> Powers:
        """Of the turning of sections."""
        raise NotImplementedError

    def masses(self) -> list[tuple[ca.SX, ca.SX]]:
        mass = self.length.sx * self.mass_per_length.sx
        shares = self._summed(self.shapes.shares)
        return [(s.place, mass * share) for s, share in zip(self.sections, shares, strict=True)]

    # start ------------------------------------------------------------------------------------
    def shape_error(self, k: int) -> ca.SX:
        """How far a node is from the natural shape, carried by its start and drawn to its end."""
        raise NotImplementedError

    def initial_conditions(self) -> list[tuple[Expression, Expression]]:
        """Its nodes are on that shape at the start, and move with it."""
        last = self.count - 1
        free = [k for k in self.nodes if 0 < k < last or (k == last and self.relaxed)]
        errors = stack(self.shape_error(k) for k in free)
        rates = rate_of(errors, self.parts(), t.sx)
        return [(Expression(e), Expression(0)) for e in ca.vertsplit(ca.vertcat(errors, rates))]

    # what is known of it ----------------------------------------------------------------------
    def forces_at(self, share: float) -> ca.SX:
        """Internal forces ``(C_Γ Γ, C_K K)`` at a share of the length."""
        if not 0 <= share <= 1:
            raise ModelError(f"{share} is no share of the length; give 0 to 1", self.name)
        e = min(int(share * self.elements), self.elements - 1)
        points = self.strains[e * self.order : (e + 1) * self.order]
        weights = through(gauss(self.order)[0], share * self.elements - e)
        pairs = zip(weights, points, strict=True)
        return self.rigidities() * sum((w * strain for w, (strain, _) in pairs), ca.SX(0))

    force_names: ClassVar[tuple[tuple[str, str], ...]]
    """Names and units of internal forces."""

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        found = {"strain_energy": (self.potential(), "J")}
        for station, share in STATIONS.items():
            forces = self.forces_at(share)
            for k, (name, unit) in enumerate(self.force_names):
                found[f"{station}_{name}"] = (forces[k], unit)
        return found

    def look(self) -> list[Look]:
        ends = [self.spot(k) for k in range(self.count)]
        return [Strand(i, j) for i, j in pairwise(ends)]
