"""Planar geometrically exact beams (Reissner 1972)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from dalembert.elements.base import Powers, Rate, Scalar, Vector, option, quantity
from dalembert.elements.flexible import beam
from dalembert.elements.flexible.nodes import CrossSection
from dalembert.elements.pair import need_point
from dalembert.elements.planar.body import rotation
from dalembert.elements.planar.joint import InPlane
from dalembert.elements.planar.node import ElementNode
from dalembert.elements.point import Point
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once


@dataclass(eq=False)
class Beam(InPlane, beam.Beam):
    """Planar beam with axial, shear and bending deformation, for large displacements and rotations.

    It extends from ``frame_i`` to ``frame_j``, points of bodies to which it is clamped along
    directions in these bodies. If one is omitted the beam has a free end, ``start`` or ``end``, for
    joints and forces. Internal forces are ``N = E A ε``, ``Q = G A_s γ`` and ``M = E I κ``.

    Parameters
    ----------
    frame_i, frame_j : points of bodies
    bending_rigidity : ``E I`` [N m²]
    rotary_inertia : ``ρ I`` [kg m]; that of a homogeneous material by default, ``ρ A · E I/(E A)``
    angle_i, angle_j : direction of the beam in the bodies at its ends [rad]
    position, angle : guesses of a free start [m], [rad]; assembly corrects them
    velocity, angular_velocity : guesses of its speeds [m/s], [rad/s]

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("cantilever")
    >>> beam = system.add(planar.Beam("beam", system.ground.center, length=1.0,
    ...     axial_rigidity=1e6, shear_rigidity=4e5, bending_rigidity=100.0))
    >>> tip = system.add(planar.Force("tip", beam.end, (0, -0.1)))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["beam.end.y"].item() * 3e3, 3)  # in F L³/(3 E I)
    -1.001
    """

    frame_i: Point | None = option("point at the start, clamped", default=None)
    frame_j: Point | None = option("point at the end, clamped", default=None)
    bending_rigidity: Scalar = quantity("N m^2", "E I", above=0.0, keyword=True)
    rotary_inertia: Scalar = quantity("kg m", "ρ I", default=None, minimum=0.0, keyword=True)
    angle_i: Scalar = quantity("rad", "direction in the first body", default=0.0, keyword=True)
    angle_j: Scalar = quantity("rad", "direction in the second body", default=0.0, keyword=True)
    position: Vector = quantity("m", "of its start", default=None, size=2, keyword=True)
    angle: Scalar = quantity("rad", "at its start", default=None, keyword=True)
    velocity: Vector = quantity("m/s", "of its start", default=None, size=2, keyword=True)
    angular_velocity: Scalar = quantity("rad/s", "at its start", default=None, keyword=True)
    node_kind = ElementNode
    dimension: ClassVar[int] = 2
    force_names = (("axial_force", "N"), ("shear_force", "N"), ("bending_moment", "N m"))

    def __post_init__(self) -> None:
        for field in ("frame_i", "frame_j"):
            if getattr(self, field) is not None:
                setattr(self, field, need_point(getattr(self, field), self.name, field))
        super().__post_init__()
        if self.rotary_inertia is None:
            self.rotary_inertia = Expression(self.material_inertia(self.bending_rigidity.sx))

    def first_node(self, name: str) -> Any:
        speeds = self.velocity, self.angular_velocity
        return ElementNode(name, None, None, self.position, self.angle, *speeds)

    @cached_property
    def start_axes(self) -> ca.SX:
        return rotation(self.sections[0].turn)

    @once
    def natural_pose(self, k: int) -> tuple[ca.SX, ca.SX]:
        base = self.sections[0]
        place, angle = self.natural(self.length.sx * self.places[k])
        return base.place + ca.mtimes(self.start_axes, place), base.turn + angle

    def node_section(self, node: Any) -> CrossSection:
        return CrossSection(node.pose[:2], node.pose[2], node.twist[2], node)

    def frame_section(self, frame: Any, last: bool) -> CrossSection:
        body, direction = frame.body, self.angle_j if last else self.angle_i
        spin = body.twist[2] if body.rotates else ca.SX(0)
        return CrossSection(frame.position.sx, body.pose_angle + direction.sx, spin, body)

    def natural_section(self, s: ca.SX) -> CrossSection:
        return CrossSection(*self.natural(s), ca.SX(0))

    def strain(
        self, sections: Sequence[CrossSection], values: np.ndarray, slopes: np.ndarray
    ) -> ca.SX:
        turn = sum((n * s.turn for n, s in zip(values, sections, strict=True)), ca.SX(0))
        bend = sum((n * s.turn for n, s in zip(slopes, sections, strict=True)), ca.SX(0))
        tangent = sum((n * s.place for n, s in zip(slopes, sections, strict=True)), ca.SX.zeros(2))
        return ca.vertcat(ca.mtimes(rotation(turn).T, tangent), bend) / self.length.sx

    def rigidities(self) -> ca.SX:
        return ca.vertcat(self.axial_rigidity.sx, self.shear_rigidity.sx, self.bending_rigidity.sx)

    def rotary_powers(self, rate: Rate, shared: np.ndarray, shares: np.ndarray) -> Powers:
        spins = ca.vertcat(*(section.spin for section in self.sections))
        inertia = self.length.sx * self.rotary_inertia.sx
        return [(spins, inertia * ca.mtimes(ca.DM(shared), rate(spins)))]

    def shape_error(self, k: int) -> ca.SX:
        last, share = self.sections[-1], self.places[k]
        place, angle = self.natural_pose(k)
        if 0 < k < self.count - 1:
            end, turn = self.natural_pose(self.count - 1)
            place, angle = place + share * (last.place - end), angle + share * (last.turn - turn)
        return ca.vertcat(self.sections[k].place - place, self.sections[k].turn - angle)
