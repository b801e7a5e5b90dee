"""Constraint written by the user."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Constraint, Coordinates, Scalar, option, quantity
from dalembert.symbolic.expression import stack


@dataclass(eq=False)
class UserConstraint(Constraint):
    """Any formula of poses, ``t`` and parameters, set to zero.

    ``Φ = formula = 0``. Multipliers have the dual unit of the formula: written in metres they
    are newtons, in radians newton metres.

    Parameters
    ----------
    formula : Expression of positions and angles (no speeds)
    unit : ``m`` or ``rad``
    """

    formula: Scalar = quantity("", "formula that must be zero")
    unit: str = option("m or rad", default="m")

    def residual(self) -> ca.SX:
        return stack([self.formula.sx])

    def units(self) -> list[str]:
        return [self.unit]

    def parts(self) -> list[Coordinates]:
        return []
