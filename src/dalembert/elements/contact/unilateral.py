"""Unilateral constraints: gaps that do not become negative."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca

from dalembert.elements.base import (
    Condition,
    Element,
    ForceElement,
    Look,
    Powers,
    Rate,
    Scalar,
    option,
    quantity,
)
from dalembert.elements.contact.impact_law import ImpactLaw
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Limit
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import stack


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
    weight : factor of force laws: 1, or the fraction of the length that a station represents
    """

    distance: ca.SX
    slip: ca.SX
    weight: float = 1.0


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

    @property
    def law(self) -> ImpactLaw:
        """Law of restitution."""
        return ImpactLaw.POISSON if self.poisson else ImpactLaw.NEWTON


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


@dataclass(eq=False)
class UnilateralConstraint(Unilateral, ForceElement):
    """A formula of poses, ``t`` and parameters that must not become negative.

    Closing gaps cause impacts, ``ġ⁺ = −e ġ⁻`` (Newton), with friction ``|T| ≤ μ N`` (Coulomb) along
    the slip; closed gaps have a contact force ``N ≥ 0`` and stick or slide. Forces have the dual
    units of the formulas.

    Parameters
    ----------
    distance : formula of positions, positive while separated
    slip : formula of speeds along the surface, linear in them; None without friction
    restitution : ``e``
    tangential_restitution : restitution of the slip
    friction : ``μ``, which may depend on positions and ``t`` as well
    poisson : ``e`` is the ratio of the impulses of restitution and compression, instead of the
        ratio of speeds; the slip then has no restitution

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("bounce", gravity=(0, -10))
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.2)))
    >>> floor = system.add(planar.UnilateralConstraint("floor", ball.y, restitution=0.5))
    >>> motion = da.solve_dynamics(system.build(), 0.25, step=0.01)
    >>> round(motion["ball.vy"][-1].item(), 6)  # rebounds at 1 m/s after 0.2 s
    0.5
    """

    distance: Scalar = quantity("m", "formula that must not become negative")
    slip: Scalar = quantity("m/s", "formula of speeds along the surface", default=None)
    restitution: Scalar = quantity("", "share of the speed that returns", minimum=0.0, keyword=True)
    tangential_restitution: Scalar = quantity(
        "", "share of the slip that returns", default=0.0, minimum=0.0
    )
    friction: Scalar = quantity("", "coefficient of friction", default=0.0, minimum=0.0)
    poisson: bool = option("restitution is a share of the impulse (Poisson)", default=False)

    def __post_init__(self) -> None:
        super().__post_init__()
        friction = self.friction.sx
        if self.slip is None and not (friction.is_constant() and float(friction) <= 0):
            raise ModelError(
                f"friction is {friction} and nothing slips; give slip= too, a velocity "
                "along the surface",
                self.name,
            )
        tangential = self.tangential_restitution.sx
        if self.poisson and not (tangential.is_constant() and float(tangential) == 0):
            raise ModelError(
                f"tangential_restitution is {tangential} and Poisson's law has none; leave it out, "
                "or leave out poisson=True",
                self.name,
            )

    def conditions(self) -> list[Condition]:
        names = "restitution", "tangential_restitution"
        return [at_most_one(getattr(self, name).sx, name) for name in names]

    def gaps(self, rate: Rate) -> list[Gap]:
        slip = stack([] if self.slip is None else [self.slip.sx])
        return [Gap(self.distance.sx, slip)]

    def impact(self) -> Impact:
        normal, tangential = self.restitution.sx, self.tangential_restitution.sx
        return Impact(normal, tangential, self.friction.sx, self.poisson)

    def powers(self, rate: Rate) -> Powers:
        return []

    def parts(self) -> list[Coordinates]:
        return []

    def look(self) -> list[Look]:
        slip = None if self.slip is None else self.slip.sx
        return [Limit(self.distance.sx, ca.SX(0), False, slip)]
