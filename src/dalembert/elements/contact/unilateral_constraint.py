"""One-sided constraint written by the user."""

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
    """Any formula of poses, ``t`` and parameters that must not become negative.

    Where it reaches zero while closing it bounces, ``ġ⁺ = −e ġ⁻`` (Newton), and rubs by
    ``|T| ≤ μ N`` (Coulomb) along the slip; where it stays at zero it holds, ``N ≥ 0``, and sticks
    or slides. Forces have the dual units of the formulas.

    Parameters
    ----------
    distance : formula of positions, positive while apart
    slip : formula of speeds along the surface, linear in them; None where nothing rubs
    restitution : ``e``
    tangential_restitution : of the slip
    friction : ``μ``, which may depend on positions and ``t`` as well
    poisson : ``e`` is the share of the impulse of compression that follows in restitution, instead
        of the share of the speed that returns; nothing then returns of the slip

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("bounce", gravity=(0, -10))
    >>> ball = system.add(planar.Particle("ball", mass=1.0, position=(0, 0.2)))
    >>> floor = system.add(planar.UnilateralConstraint("floor", ball.y, restitution=0.5))
    >>> motion = da.solve_dynamics(system.build(), 0.25, step=0.01)
    >>> round(motion["ball.vy"][-1].item(), 6)  # it left at 1 m/s after 0.2 s
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
        rough = self.friction.sx
        if self.slip is None and not (rough.is_constant() and float(rough) <= 0):
            raise ModelError(
                f"friction is {rough} and nothing slips; give slip= too, a velocity "
                "along the surface",
                self.name,
            )
        returned = self.tangential_restitution.sx
        if self.poisson and not (returned.is_constant() and float(returned) == 0):
            raise ModelError(
                f"tangential_restitution is {returned} and Poisson's law has none; leave it out, "
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
        returned, along = self.restitution.sx, self.tangential_restitution.sx
        return Impact(returned, along, self.friction.sx, self.poisson)

    def powers(self, rate: Rate) -> Powers:
        return []

    def parts(self) -> list[Coordinates]:
        return []

    def look(self) -> list[Look]:
        return [Limit(self.distance.sx, ca.SX(0), False)]
