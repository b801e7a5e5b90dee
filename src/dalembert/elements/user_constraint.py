"""User-defined constraint."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Constraint, Scalar, option, quantity
from dalembert.elements.coordinates import Coordinates
from dalembert.symbolic.formulas.expression import stack


@dataclass(eq=False)
class UserConstraint(Constraint):
    """A formula of poses, ``t`` and parameters that must be zero.

    ``Φ = formula = 0``, or ``Ψ = formula = 0`` of speeds. Multipliers have the dual unit of the
    formula: newtons for metres (or metres per second), newton metres for radians.

    Parameters
    ----------
    formula : Expression of positions and angles, or one that is linear in speeds
    unit : ``m`` or ``rad``; the unit times seconds for a formula of speeds
    speeds : the formula is nonholonomic, linear in speeds

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("bead on an ellipse", gravity=(0, -9.81))
    >>> bead = system.add(planar.Particle("bead", mass=0.1, position=(0.1, -1.0)))
    >>> wire = system.add(planar.UserConstraint("wire", (bead.x / 2)**2 + bead.y**2 - 1))
    >>> rest = da.solve_equilibrium(system.build())
    >>> round(rest["bead.y"].item(), 9)
    -1.0
    """

    formula: Scalar = quantity("m | rad | m/s | rad/s", "formula that must be zero")
    unit: str = option("m or rad", default="m")
    speeds: bool = option("a formula of speeds, linear in them", default=False)

    not_drawn = "a formula has no place"

    def residual(self) -> ca.SX:
        return stack([] if self.speeds else [self.formula.sx])

    def slipping(self) -> ca.SX:
        return stack([self.formula.sx] if self.speeds else [])

    def units(self) -> list[str]:
        return [self.unit]

    def parts(self) -> list[Coordinates]:
        return []
