"""Unilateral constraints: gaps that do not become negative."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from dalembert.elements.base import Condition, Element, Rate


@dataclass(frozen=True, eq=False)
class Gap:
    """A gap of two bodies, ``g(y, t) ≥ 0``.

    A force ``N ≥ 0`` along the gap and one ``T`` along the surface have the power
    ``N ġ + Tᵀ slip`` on both bodies together.

    Attributes
    ----------
    distance : ``g``, positive while separated, minus the penetration in contact [m]
    slip : (k,) velocity along the surface, linear in twists [m/s]; k = 0 without friction, 1 for
        planar, 2 for spatial contact
    """

    distance: ca.SX
    slip: ca.SX


@dataclass(frozen=True, eq=False)
class Impact:
    """Impact law of rigid bodies, ``ġ⁺ = −e ġ⁻``, ``|T| ≤ μ N`` (Newton, Coulomb).

    Attributes
    ----------
    restitution : ``e`` along the gap, 0 to 1
    tangential : restitution of the slip, 0 to 1
    friction : ``μ``
    poisson : ``e`` is the ratio of the impulses of restitution and compression
    """

    restitution: ca.SX
    tangential: ca.SX
    friction: ca.SX
    poisson: bool = False


@dataclass(eq=False)
class Unilateral(Element):
    """An element with gaps that must not become negative."""

    def gaps(self, rate: Rate) -> list[Gap]:
        """All gaps."""
        raise NotImplementedError

    def impact(self) -> Impact | None:
        """The impact law; None for compliant contact."""
        return None

    @cached_property
    def force_symbols(self) -> list[tuple[ca.SX, ca.SX]]:
        """Symbols of the forces ``N`` and ``T`` of a rigid contact, one pair per gap."""
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
        """Gap, slip and forces; numbered if there are several gaps."""
        measures, gaps = {}, self.gaps(rate)
        for k, gap in enumerate(gaps):
            suffix = str(k) if len(gaps) > 1 else ""
            measures[f"gap{suffix}"] = (gap.distance, "m")
            if gap.slip.numel():
                measures[f"slip{suffix}"] = (gap.slip, "m/s")
            for normal, tangential in self.force_symbols[k : k + 1]:
                measures[f"normal_force{suffix}"] = (normal, "N")
                if gap.slip.numel():
                    measures[f"friction_force{suffix}"] = (tangential, "N")
        return measures


def at_most_one(coefficient: ca.SX, name: str) -> Condition:
    """The condition that a coefficient of restitution adds no energy."""
    return (
        1 - coefficient,
        f"{name} is above 1: {{:.6g}}; give 0 to 1, for a bounce gives no energy",
        coefficient,
    )
