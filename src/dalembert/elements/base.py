"""Base classes of elements, and the contract of a new one.

1. An element is a dataclass with ``name`` first, then the bodies or points it connects, then its
   quantities.
2. A **constraint** states ``residual()``, its position-level equations in the symbols of its
   bodies. Jacobian, velocity and acceleration equations, reactions and design derivatives follow by
   differentiation. Equations are physical, in metres and radians, so that multipliers are in
   newtons and newton metres.
3. A **force** states ``powers(rate)``: pairs of a velocity ``u``, linear in the twists, and the
   effort ``Q`` with the power ``Qᵀu``. Optionally it states its ``potential()``.
4. Elements see poses and twists only, not the coordinates that the model chooses.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.computed import ComputedNumbers
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.representation import brief, fields_of
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, stack
from dalembert.text.arguments import CheckedArguments
from dalembert.text.wording import check_length

Scalar = Any  # number or Expression
Vector = Any  # two numbers or Expressions
Rows = Sequence[Any] | np.ndarray
Rate = Callable[[ca.SX], ca.SX]
"""Time derivative of an expression of positions."""
Condition = tuple[ca.SX, str] | tuple[ca.SX, str, ca.SX]
"""Expression that must not be negative, message if it is, numbers for the ``{}`` of that text."""
Powers = list[tuple[ca.SX, ca.SX]]
"""Pairs (velocity ``u``, effort ``Q``), scalars or columns, with the power ``Qᵀu``."""


def quantity(
    unit: str | None,
    description: str,
    *,
    default: Any = dataclasses.MISSING,
    size: int = 1,
    minimum_size: int = 0,
    minimum: float = -math.inf,
    above: float = -math.inf,
    keyword: bool = False,
) -> Any:
    """Field for a number (or ``size`` numbers) or a formula.

    Parameters
    ----------
    unit : or alternatives separated by ``|``; None for any dimension
    minimum_size : smallest number of entries in a file, for classes that complete them
    minimum : inclusive lower limit
    above : exclusive lower limit; limits are checked at the values of the parameters
    keyword : a field without default must be passed by keyword
    """
    metadata = {
        "kind": "quantity",
        "unit": unit,
        "description": description,
        "size": size,
        "minimum_size": minimum_size,
        "minimum": minimum,
        "above": above,
    }
    return dataclasses.field(default=default, metadata=metadata, kw_only=keyword)


def option(description: str, *, default: Any = dataclasses.MISSING, keyword: bool = False) -> Any:
    """Field that is not a number: a switch, a law, a curve, a formula with own variables.

    A point or frame declared as an option may be omitted; a file states it by its own key.
    """
    metadata = {"kind": "option", "description": description}
    return dataclasses.field(default=default, metadata=metadata, kw_only=keyword)


def power_unit(unit: str, exponent: Scalar, entity: str) -> str:
    """A unit such as ``N/m^n`` with the value of the exponent ``n``, unless parameters determine
    this."""
    value = as_expression(exponent, entity, "").sx
    if not value.is_constant():
        return unit
    return unit.replace("^n", "" if float(value) == 1 else f"^{float(value):.10g}")


class Look:
    """Base of the graphical primitives in ``look``."""


@dataclass(eq=False)
class Element(CheckedArguments):
    """A named part that can be added to a system."""

    name: str

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "__repr__" not in vars(cls):  # dataclasses would print all fields of all parts
            cls.__repr__ = Element.__repr__  # type: ignore[method-assign]

    def __repr__(self) -> str:
        return brief(type(self).__name__, self.name, fields_of(self))

    def __post_init__(self) -> None:
        self.check_name()
        for field, meta in self.quantities():
            value = getattr(self, field)
            if value is None:
                if self._defaults().get(field) is not None:
                    message = "is None; give a number, or leave it out"
                    raise ModelError(message, f"{self.name}.{field}")
            else:
                unit = self._unit(field, meta["unit"])
                value = as_expression(value, f"{self.name}.{field}", unit, meta["size"])
                setattr(self, field, value)

    def _unit(self, field: str, unit: str | None) -> str | None:
        """Expected unit of a quantity; subclasses override it where other fields determine it."""
        return unit

    def check_name(self) -> None:
        """Check that the name can be used in formulas.

        Raises
        ------
        ModelError
            The name is not an identifier, or too long.
        """
        if not isinstance(self.name, str) or not self.name:
            raise ModelError(f"the first argument is the name, a text; got {self.name!r}")
        if not self.name.isidentifier():
            raise ModelError(
                "a name consists of letters, digits and '_', and starts with a letter; "
                f"got {self.name!r}"
            )
        check_length(self.name, type(self).__name__)

    @classmethod
    @functools.cache
    def _defaults(cls) -> dict[str, Any]:
        """Default values of the quantities; None for optional ones."""
        fields, missing = cls.quantity_fields(), dataclasses.MISSING
        return {f.name: f.default for f in fields if f.default is not missing}

    @classmethod
    def quantity_fields(cls) -> list[dataclasses.Field]:
        return [f for f in dataclasses.fields(cls) if f.metadata.get("kind") == "quantity"]

    def quantities(self):
        """(field name, metadata) of the quantities of this element."""
        for field in self.quantity_fields():
            yield field.name, field.metadata

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        """(``element.field``, formula, metadata) of the quantities, checked by the build."""
        return [
            (f"{self.name}.{field}", getattr(self, field), meta)
            for field, meta in self.quantities()
            if isinstance(getattr(self, field), Expression)
        ]

    def conditions(self) -> list[Condition]:
        """Conditions that must hold at the values of the parameters."""
        return []

    def warnings(self) -> list[Condition]:
        """Conditions whose violation at the values of the parameters causes a warning."""
        return []

    def foreign_parameters(self) -> list[str]:
        """Parameters of its parts, such as a structure, that no parameter of the mechanism sets."""
        return []

    def computed(self) -> list[ComputedNumbers]:
        """Numbers in its equations that depend on parameters and are computed outside the graph."""
        return []

    def parts(self) -> list[Coordinates]:
        """The bodies (and own coordinates) that this element connects."""
        return []

    def own_coordinates(self) -> list[Coordinates]:
        """Additional coordinates: nodes, the parameter of a curve."""
        return []

    def inertial_powers(self, rate: Rate) -> Powers:
        """Velocities ``u`` and efforts ``Q``, linear in accelerations, with the power ``Qᵀu`` of
        its inertia, by d'Alembert; ``rate`` also applies to speeds. Bodies state theirs directly.
        """
        return []

    @property
    def own_mass(self) -> bool:
        """Whether it has inertia in addition to that of bodies."""
        return bool(self.inertial_powers(lambda s: s))

    def masses(self) -> list[tuple[ca.SX, ca.SX]]:
        """(position, mass) of the masses that gravity acts on."""
        return []

    def initial_conditions(self) -> list[tuple[Expression, Expression]]:
        """(measure, value) pairs that hold at the start."""
        return []

    def own_constraints(self) -> list[Constraint]:
        """Constraints of an element that is not one itself (the foot point of a contact)."""
        return []

    not_drawn = ""
    """The reason why pictures do not show it; empty if they do."""

    def look(self) -> list[Look]:
        """Primitives that represent it in pictures."""
        return []


@dataclass(eq=False)
class Constraint(Element):
    """Equations ``Φ(poses, t) = 0`` of positions, and nonholonomic equations
    ``Ψ(poses, twists, t) = 0`` of speeds. Both are physical: metres or radians, per second.

    The multiplier follows (4.22), ``M v̇ + d = f − Cᵀλ``.
    """

    relative = False
    """Whether its equations depend only on the relative position of its two bodies."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.equations = ca.densify(self.residual())
        self.slip = ca.densify(self.slipping())
        count = self.equations.numel() + self.slip.numel()
        self.multiplier = stack(ca.SX.sym(f"{self.name}.lambda{k}") for k in range(count))

    @property
    def end_points(self) -> tuple[Any, Any] | None:
        """The points of its two bodies that it connects, or None."""
        return None

    def residual(self) -> ca.SX:
        """Equations ``Φ`` in the pose symbols of the parts and time."""
        raise NotImplementedError

    def assembly_conditions(self) -> ca.SX:
        """Expressions that are positive in the intended assembly; none by default.

        The equations alone may also permit a hinge whose axis is reversed.
        """
        return ca.SX(0, 1)

    def slipping(self) -> ca.SX:
        """Speeds ``Ψ`` that must vanish, linear in the twists of the parts; none by default."""
        return ca.SX(0, 1)

    def units(self) -> list[str]:
        """Unit of each equation: ``m`` or ``rad``; of speeds, per second."""
        return ["m"] * self.multiplier.numel()

    def measured_and_target(self) -> tuple[ca.SX, ca.SX] | None:
        """The length or angle in its equation and the prescribed value; None if there is none."""
        return None

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        """Measures: name → (expression, unit)."""
        return {}

    def freedoms(self) -> dict[str, tuple[ca.SX, str]]:
        """Free relative motions of the joint: name → (coordinate, unit)."""
        return {}


@dataclass(eq=False)
class ForceElement(Element):
    """Applied force, stated by virtual power."""

    conservative = False
    """Whether its potential accounts for all its work, exactly."""
    internal = False
    """Whether it acts within one body."""

    def powers(self, rate: Rate) -> Powers:
        """Pairs of a velocity, ``rate(s)`` of a coordinate or ``ω``, and the effort on it."""
        raise NotImplementedError

    def contact_powers(self, rate: Rate, energy: float) -> Powers:
        """``powers``; for one-sided forces linearised in contact at a stored energy [J]."""
        return self.powers(rate)

    def coordinate(self) -> ca.SX:
        """The coordinate it acts along, if there is a single one."""
        raise NotImplementedError

    def potential(self) -> ca.SX | None:
        """Potential energy of the conservative part, or None."""
        return None

    def dissipation(self, rate: Rate) -> Powers:
        """The dissipative part of ``powers`` (dampers, friction)."""
        return []

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        """Measures: name → (expression, unit)."""
        return {}
