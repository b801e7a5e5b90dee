"""Homogeneous bodies: mass and inertia from density and dimensions."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.simple_bodies import unused
from dalembert.elements.spatial.body import Body
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression


@dataclass(eq=False)
class Shape(Body):
    """Homogeneous body with a specified mass or density.

    A new shape implements ``volume`` and ``gyration``, and ``middle`` if the mass centre is not the
    origin of the body frame.

    Parameters
    ----------
    density : [kg/m³]

    Raises
    ------
    ModelError
        Both mass and density, or an impossible size.
    """

    geometry: Any = unused()
    density: Scalar = quantity("kg/m^3", "density, instead of the mass", default=None, minimum=0.0)

    def __post_init__(self) -> None:
        if self.mass is not None and self.density is not None:
            raise ModelError("give mass= or density=, not both", self.name)
        self._read_sizes()
        if self.density is not None:
            self.mass = self.density * Expression(self.volume())
        if self.center_of_mass is None:
            self.center_of_mass = Expression(self.middle())
        if self.mass is not None and self.inertia is None:
            mass = as_expression(self.mass, f"{self.name}.mass", "kg")
            self.inertia = Expression(mass.sx * self.gyration())
        super().__post_init__()

    def _read_sizes(self) -> None:
        """Convert the additional quantities of the shape to formulas."""
        inherited = {field.name for field in Body.quantity_fields()}
        for field, meta in self.quantities():
            value = getattr(self, field)
            if field not in inherited and value is not None:
                expression = as_expression(
                    value, f"{self.name}.{field}", meta["unit"], meta["size"]
                )
                setattr(self, field, expression)

    def differences(self) -> dict[str, Expression]:
        """Differences of sizes [m] that must not be negative."""
        return {}

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        """Quantities with the sizes before the mass that depends on them."""
        inherited = {f"{self.name}.{field.name}" for field in Body.quantity_fields()}
        quantities = super().checked_quantities()
        unlimited = {"unit": "m", "minimum": 0.0, "above": -math.inf}
        walls = [(f"{self.name}.{n}", wall, unlimited) for n, wall in self.differences().items()]
        sizes, rest_of_body = (
            [entry for entry in quantities if (entry[0] in inherited) is is_inherited]
            for is_inherited in (False, True)
        )
        return [*sizes, *walls, *rest_of_body]

    def volume(self) -> ca.SX:
        """[m³]"""
        raise NotImplementedError

    def gyration(self) -> ca.SX:
        """(6,) moments and products of inertia about the mass centre per unit mass [m²]."""
        raise NotImplementedError

    def middle(self) -> ca.SX:
        """(3,) the mass centre in the body frame [m]."""
        return ca.SX.zeros(3)


def moments(x: ca.SX, y: ca.SX, z: ca.SX) -> ca.SX:
    """(6,) principal moments with zero products."""
    return ca.vertcat(x, y, z, 0, 0, 0)
