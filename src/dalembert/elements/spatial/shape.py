"""What homogeneous bodies of a shape share: mass and inertia that follow from their sizes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import casadi as ca

from dalembert.elements.base import Scalar, quantity
from dalembert.elements.spatial.body import Body
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression


@dataclass(eq=False)
class Shape(Body):
    """Homogeneous body; its mass is given or follows from its density.

    To write a new one, give ``volume`` and ``gyration``, and ``middle`` if the mass centre is not
    the origin of the body frame.

    Parameters
    ----------
    density : [kg/m³]

    Raises
    ------
    ModelError
        Mass and density are both given, or an impossible size.
    """

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
        """Numbers that no other body has, as formulas."""
        of_any = {field.name for field in Body.quantity_fields()}
        for field, meta in self.quantities():
            given = getattr(self, field)
            if field not in of_any and given is not None:
                read = as_expression(given, f"{self.name}.{field}", meta["unit"], meta["size"])
                setattr(self, field, read)

    def differences(self) -> dict[str, Expression]:
        """Differences of sizes [m] that must not be negative."""
        return {}

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        """Sizes come before the mass that follows from them."""
        of_any = {f"{self.name}.{field.name}" for field in Body.quantity_fields()}
        found = super().checked_quantities()
        unlimited = {"unit": "m", "minimum": 0.0, "above": -math.inf}
        walls = [(f"{self.name}.{n}", wall, unlimited) for n, wall in self.differences().items()]
        sizes, others = (
            [entry for entry in found if (entry[0] in of_any) is which] for which in (False, True)
        )
        return [*sizes, *walls, *others]

    def volume(self) -> ca.SX:
        """[m³]"""
        raise NotImplementedError

    def gyration(self) -> ca.SX:
        """(6,) moments and products about the mass centre for a mass of one [m²]."""
        raise NotImplementedError

    def middle(self) -> ca.SX:
        """(3,) the mass centre in the body frame [m]."""
        return ca.SX.zeros(3)


def moments(x: ca.SX, y: ca.SX, z: ca.SX) -> ca.SX:
    """(6,) moments about principal axes, without products."""
    return ca.vertcat(x, y, z, 0, 0, 0)
