"""Spatial geometrically exact beams (Simo and Vu-Quoc 1986).

Rotations between the nodes of an element are that of one node times the exponential of polynomials
of relative rotation vectors, so that the strains are invariant under rigid motions (Crisfield and
Jelenić 1999).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from dalembert.elements.base import Condition, Powers, Rate, Scalar, Vector, option, quantity
from dalembert.elements.flexible import beam
from dalembert.elements.flexible.nodes import CrossSection
from dalembert.elements.frame import Frame
from dalembert.elements.rotation import Orientation, as_orientation
from dalembert.elements.spatial.node import ElementNode
from dalembert.errors import ModelError
from dalembert.symbolic import rotation
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once


@dataclass(eq=False)
class Beam(beam.Beam):
    """Spatial beam with axial, shear, torsional and bending deformation, for large rotations.

    Its x axis is along the beam, y and z are the principal axes of the cross-section. It extends
    from ``frame_i`` to ``frame_j``, frames of bodies to which it is clamped with its axes along
    theirs. If one is omitted the beam has a free end, ``start`` or ``end``, for joints and forces.
    Internal forces are ``E A ε``, ``G A_y γ_y``, ``G A_z γ_z`` and moments ``G J κ_x``,
    ``E I_y κ_y``, ``E I_z κ_z``.

    Parameters
    ----------
    frame_i, frame_j : frames of bodies
    shear_rigidity_z : ``G A_z`` [N]; that along y by default
    torsional_rigidity : ``G J`` [N m²]
    bending_rigidity_y, bending_rigidity_z : ``E I_y``, ``E I_z`` [N m²], about its y and z axes
    rotary_inertia : (3,) ``ρ I_p``, ``ρ I_y``, ``ρ I_z`` [kg m]; homogeneous material by default
    position, rotation : guesses of a free start [m]; assembly corrects them
    velocity, angular_velocity : guesses of its speeds, inertial axes [m/s], [rad/s]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import spatial
    >>> system = da.System("torsion bar")
    >>> rigid = dict(axial_rigidity=1e6, shear_rigidity=4e5, torsional_rigidity=80.0)
    >>> rigid |= dict(bending_rigidity_y=100.0, bending_rigidity_z=100.0)
    >>> beam = spatial.Beam("bar", system.ground.frame(), length=2.0, elements=1, order=2, **rigid)
    >>> lever = system.add(spatial.Torque("lever", system.add(beam).end, (4, 0, 0)))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["bar.end.bryant"][0, 0].item(), 6)  # M L/(G J)
    0.1
    """

    frame_i: Frame | None = option("frame at the start, clamped", default=None)
    frame_j: Frame | None = option("frame at the end, clamped", default=None)
    shear_rigidity_z: Scalar = quantity("N", "G A_z", default=None, above=0.0, keyword=True)
    torsional_rigidity: Scalar = quantity("N m^2", "G J", above=0.0, keyword=True)
    bending_rigidity_y: Scalar = quantity("N m^2", "E I_y", above=0.0, keyword=True)
    bending_rigidity_z: Scalar = quantity("N m^2", "E I_z", above=0.0, keyword=True)
    rotary_inertia: Vector = quantity(
        "kg m", "ρ I_p, ρ I_y, ρ I_z", default=None, size=3, minimum=0.0, keyword=True
    )
    position: Vector = quantity("m", "of its start", default=None, size=3, keyword=True)
    rotation: Orientation = option("at its start", default=None, keyword=True)
    velocity: Vector = quantity("m/s", "of its start", default=None, size=3, keyword=True)
    angular_velocity: Vector = quantity("rad/s", "at its start", default=None, size=3, keyword=True)
    node_kind = ElementNode
    dimension: ClassVar[int] = 3
    force_names = (
        ("axial_force", "N"),
        ("shear_force_y", "N"),
        ("shear_force_z", "N"),
        ("torque", "N m"),
        ("bending_moment_y", "N m"),
        ("bending_moment_z", "N m"),
    )

    def __post_init__(self) -> None:
        if self.rotation is not None:
            self.rotation = as_orientation(self.rotation, f"{self.name}.rotation")
        for field in ("frame_i", "frame_j"):
            frame = getattr(self, field)
            if frame is not None and not isinstance(frame, Frame):
                raise ModelError(
                    f"{field} must be a frame of a body, its x axis along the beam, e.g. "
                    f"hub.frame((0.1, 0, 0)); got {frame!r}",
                    self.name,
                )
        super().__post_init__()
        if self.shear_rigidity_z is None:
            self.shear_rigidity_z = self.shear_rigidity
        if self.rotary_inertia is None:
            bending = [self.bending_rigidity_y.sx, self.bending_rigidity_z.sx]
            inertia = [self.material_inertia(rigidity) for rigidity in (sum(bending), *bending)]
            self.rotary_inertia = Expression(ca.vertcat(*inertia))

    def first_node(self, name: str) -> Any:
        pose = {"position": self.position, "rotation": self.rotation}
        speeds = {"velocity": self.velocity, "angular_velocity": self.angular_velocity}
        return ElementNode(name, **pose, **speeds)

    @cached_property
    def start_axes(self) -> ca.SX:
        return rotation.matrix(self.sections[0].turn)

    @once
    def natural_pose(self, k: int) -> tuple[ca.SX, ca.SX]:
        base = self.sections[0]
        undeformed = self.natural_section(self.length.sx * self.places[k])
        place = base.place + ca.mtimes(self.start_axes, undeformed.place)
        return place, rotation.product(base.turn, undeformed.turn)

    def node_section(self, node: Any) -> CrossSection:
        return CrossSection(node.pose[:3], node.e, node.spin, node)

    def frame_section(self, frame: Any, last: bool) -> CrossSection:
        spin = ca.mtimes(frame.axes.T, frame.body.turning)
        return CrossSection(frame.position.sx, frame.orientation, spin, frame.body)

    def natural_section(self, s: ca.SX) -> CrossSection:
        place, angle = self.natural(s)
        return CrossSection(ca.vertcat(place, 0), rotation.about_z(angle), ca.SX.zeros(3))

    def strain(
        self, sections: Sequence[CrossSection], values: np.ndarray, slopes: np.ndarray
    ) -> ca.SX:
        middle = sections[len(sections) // 2].turn
        turn, bend, tangent = ca.SX.zeros(3), ca.SX.zeros(3), ca.SX.zeros(3)
        for n, slope, section in zip(values, slopes, sections, strict=True):
            between = rotation.vector(rotation.product(rotation.conjugate(middle), section.turn))
            turn, bend = turn + n * between, bend + slope * between
            tangent = tangent + slope * section.place
        local_tangent = ca.mtimes(rotation.matrix(middle).T, tangent)
        shear = ca.mtimes(rotation.exponential(turn).T, local_tangent)
        curved = ca.mtimes(rotation.turning_map(turn), bend)
        return ca.vertcat(shear, curved) / self.length.sx

    def rigidities(self) -> ca.SX:
        parts = (
            self.axial_rigidity,
            self.shear_rigidity,
            self.shear_rigidity_z,
            self.torsional_rigidity,
            self.bending_rigidity_y,
            self.bending_rigidity_z,
        )
        return ca.vertcat(*(part.sx for part in parts))

    def rotary_powers(self, rate: Rate, shared: np.ndarray, shares: np.ndarray) -> Powers:
        """Rotary inertia of the sections at the nodes, ``J' ω̇' + ω' × J' ω'``."""
        powers = []
        for section, share in zip(self.sections, shares, strict=True):
            inertia = self.length.sx * share * self.rotary_inertia.sx
            spin = section.spin
            effort = inertia * rate(spin) + ca.cross(spin, inertia * spin)
            powers.append((spin, effort))
        return powers

    def shape_error(self, k: int) -> ca.SX:
        last, share = self.sections[-1], self.places[k]
        place, turn = self.natural_pose(k)
        if 0 < k < self.count - 1:
            end, end_turn = self.natural_pose(self.count - 1)
            between = rotation.product(rotation.conjugate(end_turn), last.turn)
            place = place + share * (last.place - end)
            small = rotation.vector(between) * share / 2
            turn = rotation.product(turn, ca.vertcat(1, small) / ca.sqrt(1 + ca.sumsqr(small)))
        off = rotation.product(rotation.conjugate(turn), self.sections[k].turn)
        return ca.vertcat(self.sections[k].place - place, rotation.vector(off))

    def conditions(self) -> list[Condition]:
        rotation = [] if self.rotation is None else self.rotation.conditions()
        ends = [e.conditions() for e in (self.frame_i, self.frame_j) if e is not None]
        return [*super().conditions(), *rotation, *(c for end in ends for c in end)]
