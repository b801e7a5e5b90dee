"""User-defined unilateral constraint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import (
    Condition,
    ForceElement,
    Look,
    Powers,
    Rate,
    Scalar,
    option,
    quantity,
)
from dalembert.elements.contact.unilateral import Gap, Impact, Unilateral, at_most_one
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Limit
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.expression import stack


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
        return [Limit(self.distance.sx, ca.SX(0), False)]
