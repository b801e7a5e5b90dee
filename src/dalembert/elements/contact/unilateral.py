"""What may part but not pass through each other: distances that do not become negative."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from dalembert.elements.base import Condition, Element, Rate


@dataclass(frozen=True, eq=False)
class Gap:
    """A place where two things may touch, ``g(y, t) ≥ 0``.

    A force ``N ≥ 0`` along the gap and one ``T`` along the surface have the power
    ``N ġ + Tᵀ slip`` on both bodies together.

    Attributes
    ----------
    distance : ``g``, positive while apart, the depth of penetration negative [m]
    slip : (k,) velocity along the surface, linear in twists [m/s]; k = 0 where nothing rubs, 1 in
        the plane, 2 in space
    """

    distance: ca.SX
    slip: ca.SX


@dataclass(frozen=True, eq=False)
class Impact:
    """How rigid things bounce and rub, ``ġ⁺ = −e ġ⁻``, ``|T| ≤ μ N`` (Newton, Coulomb).

    Attributes
    ----------
    restitution : ``e`` along the gap, 0 to 1
    tangential : of the slip, 0 to 1
    friction : ``μ``
    poisson : ``e`` is the share of the impulse of compression that follows in restitution
    """

    restitution: ca.SX
    tangential: ca.SX
    friction: ca.SX
    poisson: bool = False


@dataclass(eq=False)
class Unilateral(Element):
    """Anything that keeps distances from becoming negative."""

    def gaps(self, rate: Rate) -> list[Gap]:
        """Every place where it may touch."""
        raise NotImplementedError

    def impact(self) -> Impact | None:
        """How it bounces; None of what is compliant, which states forces instead."""
        return None

    @cached_property
    def pressing(self) -> list[tuple[ca.SX, ca.SX]]:
        """Symbols of the forces ``N`` and ``T`` of what is rigid, gap by gap."""
        if self.impact() is None:
            return []
        return [
            (
                ca.SX.sym(f"{self.name}.normal{k}"),
                ca.SX.sym(f"{self.name}.tangential{k}", gap.slip.numel()),
            )
            for k, gap in enumerate(self.gaps(lambda expression: expression))
        ]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        """Gap, slip and forces of every place; numbered where there are several."""
        found, gaps = {}, self.gaps(rate)
        for k, gap in enumerate(gaps):
            end = str(k) if len(gaps) > 1 else ""
            found[f"gap{end}"] = (gap.distance, "m")
            if gap.slip.numel():
                found[f"slip{end}"] = (gap.slip, "m/s")
            for normal, tangential in self.pressing[k : k + 1]:
                found[f"normal_force{end}"] = (normal, "N")
                if gap.slip.numel():
                    found[f"friction_force{end}"] = (tangential, "N")
        return found


def at_most_one(share: ca.SX, name: str) -> Condition:
    """That a coefficient of restitution gives no energy."""
    return (
        1 - share,
        f"{name} is above 1: {{:.6g}}; give 0 to 1, for a bounce gives no energy",
        share,
    )
