"""Moments about fixed axes at spatial nodes with rotations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.fem.attached import AXES, Attached
from dalembert.elements.fem.rotations import spin_map
from dalembert.structures.evaluation.blocks import Part
from dalembert.structures.loads.nodal_load import Load
from dalembert.symbolic.formulas.expression import Expression


@dataclass(eq=False)
class FixedMoment(Attached):
    """A moment that does the virtual work ``Mᵀ δθ`` with the spin ``δθ = 𝗧(r) δr`` of its node.

    The generalized force on the rotation vector is ``𝗧(r)ᵀ M``; it has no potential.

    Parameters
    ----------
    moment_x, moment_y, moment_z : about fixed axes [N m]
    """

    moment_x: Scalar = quantity("N m", "about x", default=0.0, keyword=True)
    moment_y: Scalar = quantity("N m", "about y", default=0.0, keyword=True)
    moment_z: Scalar = quantity("N m", "about z", default=0.0, keyword=True)
    turns: ClassVar[bool] = True
    dimensions: ClassVar[tuple[int, ...]] = (3,)

    @classmethod
    def virtual_work(
        cls, u: list[ca.SX], w: list[ca.SX], x: list[ca.SX], q: dict[str, ca.SX]
    ) -> ca.SX:
        moment = ca.vertcat(*(q[f"moment_{axis}"] for axis in AXES))
        return -ca.dot(moment, ca.mtimes(spin_map(u[0][3:]), w[0][3:]))

    @classmethod
    def part(cls, load: Load) -> Part:
        """The moments of one load, as elements."""
        quantities = {field.name: Expression(0.0) for field in cls.quantity_fields()}
        quantities[f"moment_{load.direction[-1]}"] = load.each
        nodes = load.nodes[:, None]
        return Part(load.entity, cls, {}, nodes, load.nodes.size, quantities, timed=True)
