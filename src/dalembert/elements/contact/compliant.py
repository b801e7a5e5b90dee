"""What is compliant where it touches: forces by laws of gaps."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Condition, ForceElement, Powers, Rate
from dalembert.elements.contact.friction import Friction
from dalembert.elements.contact.laws import NormalLaw
from dalembert.elements.contact.unilateral import Gap, Unilateral
from dalembert.elements.ingredient import Ingredient
from dalembert.symbolic.formulas.expression import Expression

Measured = dict[str, tuple[ca.SX, str]]


@dataclass(frozen=True, eq=False)
class Touch:
    """Forces at one gap.

    Attributes
    ----------
    gap : Gap
    speed : ``ġ`` [m/s]
    press, elastic : normal force and its elastic part [N]
    rub : (k,) force along the surface on the second body [N]
    """

    gap: Gap
    speed: ca.SX
    press: ca.SX
    elastic: ca.SX
    rub: ca.SX


@dataclass(eq=False)
class Compliant(Unilateral, ForceElement):
    """Presses by a law where a gap is negative, ``N(−g, −ġ)``, and rubs there, ``T(N, slip)``."""

    def normal_law(self) -> NormalLaw | None:
        """How it presses; None of what is rigid and makes no forces."""
        raise NotImplementedError

    def rubbing(self) -> Friction | None:
        """How it rubs; not at all by default."""
        return None

    def states(self) -> Iterable[ca.SX]:
        """Those of friction, by gap."""
        return itertools.repeat(ca.SX(0, 1))

    def ingredients(self) -> dict[str, Ingredient]:
        """What it is made of beside numbers, by field."""
        return {}

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        named = self.ingredients().items()
        of_these = [q for field, i in named for q in i.checked_quantities(f"{self.name}.{field}")]
        return [*super().checked_quantities(), *of_these]

    def conditions(self) -> list[Condition]:
        of_these = [c for i in self.ingredients().values() for c in i.conditions()]
        return [*super().conditions(), *of_these]

    def touches(self, rate: Rate) -> list[Touch]:
        """The forces at every gap."""
        law, friction, found = self.normal_law(), self.rubbing(), []
        if law is None:
            return []
        for gap, state in zip(self.gaps(rate), self.states(), strict=False):
            depth, speed = -gap.distance, rate(gap.distance)
            press = pressed(depth, lambda d, v=-speed, law=law: law.force(d, v))
            elastic = pressed(depth, law.elastic)
            rub = ca.SX(gap.slip.numel(), 1)
            if friction is not None and gap.slip.numel():
                rub = friction.force(press, gap.slip, state)
            found.append(Touch(gap, speed, press, elastic, rub))
        return found

    def powers(self, rate: Rate) -> Powers:
        touches = self.touches(rate)
        normal: Powers = [(touch.speed, touch.press) for touch in touches]
        return [*normal, *((touch.gap.slip, touch.rub) for touch in touches)]

    def touching(self, rate: Rate, energy: float) -> Powers:
        law = self.normal_law()
        if law is None:
            return []
        depth, speed = ca.SX.sym("depth"), ca.SX.sym("speed")
        force, resting = law.force(depth, speed), ca.vertcat(depth, speed)
        at = ca.vertcat(law.depth_storing(energy), 0)
        stiffness, damping = (
            ca.substitute(ca.jacobian(force, s), resting, at) for s in (depth, speed)
        )
        gaps = self.gaps(rate)
        return [
            (rate(g.distance), -stiffness * g.distance - damping * rate(g.distance)) for g in gaps
        ]

    def potential(self) -> ca.SX | None:
        law = self.normal_law()
        if law is None:
            return None
        gaps = self.gaps(lambda s: ca.SX.zeros(s.shape))
        return sum((pressed(-gap.distance, law.stored) for gap in gaps), ca.SX(0))

    def dissipation(self, rate: Rate) -> Powers:
        touches = self.touches(rate)
        damped: Powers = [(touch.speed, touch.press - touch.elastic) for touch in touches]
        return [*damped, *((touch.gap.slip, touch.rub) for touch in touches)]

    def measures(self, rate: Rate) -> Measured:
        if self.normal_law() is None:  # rigid: its forces are found, not stated
            return Unilateral.measures(self, rate)
        gaps, touches = self.gaps(rate), self.touches(rate)
        distances, nearest = [gap.distance for gap in gaps], gaps[0].distance
        for distance in distances[1:]:
            nearest = ca.fmin(nearest, distance)
        found: Measured = {"gap": (nearest, "m"), "penetration": (ca.fmax(0, -nearest), "m")}
        if touches:
            found["force"] = (sum((touch.press for touch in touches), ca.SX(0)), "N")
        rubs = bool(touches) and self.rubbing() is not None
        if rubs:
            rubbed = sum((_size(touch.rub) for touch in touches), ca.SX(0))
            found["friction_force"] = (rubbed, "N")
        if len(gaps) == 1 and gaps[0].slip.numel():
            found["slip"] = (_size(gaps[0].slip), "m/s")
        if len(gaps) > 1:
            found |= _numbered("gap", distances, "m")
            found |= _numbered("force", [touch.press for touch in touches], "N")
        return found


def pressed(depth: ca.SX, law) -> ca.SX:
    """What a law says of a depth where it is positive, else nothing."""
    inside = ca.if_else(depth > 0, depth, 1)  # keeps 0^(n−1) out of the derivative
    return ca.if_else(depth > 0, law(inside), 0)


def _size(vector: ca.SX) -> ca.SX:
    """Of the plane the component, with its sign; of space the length."""
    return vector if vector.numel() == 1 else ca.sqrt(ca.sumsqr(vector) + 1e-60)


def _numbered(name: str, values: list[ca.SX], unit: str) -> Measured:
    return {f"{name}{k + 1}": (value, unit) for k, value in enumerate(values)}
