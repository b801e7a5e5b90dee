"""Compliant contact: forces as functions of gaps and slip."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, ForceElement, Powers, Rate
from dalembert.elements.component import Component
from dalembert.elements.contact.friction import Friction
from dalembert.elements.contact.laws import NormalLaw
from dalembert.elements.contact.unilateral import Gap, Unilateral
from dalembert.symbolic.formulas.expression import Expression

Measured = dict[str, tuple[ca.SX, str]]


@dataclass(frozen=True, eq=False)
class ContactForces:
    """Forces at one gap.

    Attributes
    ----------
    gap : Gap
    speed : ``ġ`` [m/s]
    normal, elastic : normal force and its elastic part [N]
    friction : (k,) force along the surface on the second body [N]
    """

    gap: Gap
    speed: ca.SX
    normal: ca.SX
    elastic: ca.SX
    friction: ca.SX


@dataclass(eq=False)
class Compliant(Unilateral, ForceElement):
    """Normal force ``N(−g, −ġ)`` and friction ``T(N, slip)`` at negative gaps."""

    def normal_law(self) -> NormalLaw | None:
        """The normal force law; None for rigid contact."""
        raise NotImplementedError

    def friction_law(self) -> Friction | None:
        """The friction law; None by default."""
        return None

    def states(self) -> Iterable[ca.SX]:
        """States of friction, one group per gap."""
        return itertools.repeat(ca.SX(0, 1))

    def components_by_field(self) -> dict[str, Component]:
        """Laws and shapes by field."""
        return {}

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        parts = self.components_by_field().items()
        quantities = [
            q for field, part in parts for q in part.checked_quantities(f"{self.name}.{field}")
        ]
        return [*super().checked_quantities(), *quantities]

    def conditions(self) -> list[Condition]:
        conditions = [c for part in self.components_by_field().values() for c in part.conditions()]
        return [*super().conditions(), *conditions]

    def contact_forces(self, rate: Rate) -> list[ContactForces]:
        """The forces at every gap; none for rigid contact."""
        law, friction_law, forces = self.normal_law(), self.friction_law(), []
        if law is None:
            return []
        for gap, state in zip(self.gaps(rate), self.states(), strict=False):
            depth, speed = -gap.distance, rate(gap.distance)
            normal = if_penetrating(depth, lambda d, v=-speed, law=law: law.force(d, v))
            normal, elastic = normal * gap.weight, if_penetrating(depth, law.elastic) * gap.weight
            friction = ca.SX(gap.slip.numel(), 1)
            if friction_law is not None and gap.slip.numel():
                friction = friction_law.force(normal, gap.slip, state)
            forces.append(ContactForces(gap, speed, normal, elastic, friction))
        return forces

    def powers(self, rate: Rate) -> Powers:
        forces = self.contact_forces(rate)
        normal: Powers = [(f.speed, f.normal) for f in forces]
        return [*normal, *((f.gap.slip, f.friction) for f in forces)]

    def contact_powers(self, rate: Rate, energy: float) -> Powers:
        law = self.normal_law()
        if law is None:
            return []
        depth, speed = ca.SX.sym("depth"), ca.SX.sym("speed")
        force, arguments = law.force(depth, speed), ca.vertcat(depth, speed)
        powers: Powers = []
        for gap in self.gaps(rate):
            values = ca.vertcat(law.depth_storing(energy / gap.weight), 0)
            stiffness, damping = (
                gap.weight * ca.substitute(ca.jacobian(force, s), arguments, values)
                for s in (depth, speed)
            )
            closing = rate(gap.distance)
            powers.append((closing, -stiffness * gap.distance - damping * closing))
        return powers

    def potential(self) -> ca.SX | None:
        law = self.normal_law()
        if law is None:
            return None
        gaps = self.gaps(lambda s: ca.SX.zeros(s.shape))
        stored = (gap.weight * if_penetrating(-gap.distance, law.stored) for gap in gaps)
        return sum(stored, ca.SX(0))

    def dissipation(self, rate: Rate) -> Powers:
        forces = self.contact_forces(rate)
        damping: Powers = [(f.speed, f.normal - f.elastic) for f in forces]
        return [*damping, *((f.gap.slip, f.friction) for f in forces)]

    def measures(self, rate: Rate) -> Measured:
        if self.normal_law() is None:  # rigid: forces are unknowns
            return Unilateral.measures(self, rate)
        gaps, forces = self.gaps(rate), self.contact_forces(rate)
        distances, nearest = [gap.distance for gap in gaps], gaps[0].distance
        for distance in distances[1:]:
            nearest = ca.fmin(nearest, distance)
        measures: Measured = {"gap": (nearest, "m"), "penetration": (ca.fmax(0, -nearest), "m")}
        if forces:
            measures["force"] = (sum((f.normal for f in forces), ca.SX(0)), "N")
        if forces and self.friction_law() is not None:
            friction = sum((_size(f.friction) for f in forces), ca.SX(0))
            measures["friction_force"] = (friction, "N")
        if len(gaps) == 1 and gaps[0].slip.numel():
            measures["slip"] = (_size(gaps[0].slip), "m/s")
        if len(gaps) > 1:
            measures |= _numbered("gap", distances, "m")
            measures |= _numbered("force", [f.normal for f in forces], "N")
        return measures


def if_penetrating(depth: ca.SX, law) -> ca.SX:
    """Value of a law at a positive depth, else zero."""
    inside = ca.if_else(depth > 0, depth, 1)  # avoids 0^(n−1) in the derivative
    return ca.if_else(depth > 0, law(inside), 0)


def _size(vector: ca.SX) -> ca.SX:
    """Signed component of a planar vector, norm of a spatial one."""
    return vector if vector.numel() == 1 else ca.sqrt(ca.sumsqr(vector) + 1e-60)


def _numbered(name: str, values: list[ca.SX], unit: str) -> Measured:
    return {f"{name}{k + 1}": (value, unit) for k, value in enumerate(values)}
