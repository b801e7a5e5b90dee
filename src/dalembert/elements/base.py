"""What every element is made of.

How to write a new one:

1. An element is a dataclass with ``name`` first, then what it ties, then its quantities.
2. A **constraint** states ``residual()``, its position-level equations in the symbols of its
   bodies. Jacobian, velocity and acceleration equations, reactions and design derivatives follow by
   differentiation; nobody types them. Equations are physical: metres and radians, so that
   multipliers are newtons and newton metres.
3. A **force** states ``powers(rate)``: pairs of a velocity ``u``, linear in the twists, and the
   effort ``Q`` that does the power ``Qᵀu`` on it. Optionally its ``potential()``.
4. Elements see poses and twists only. They do not know which coordinates the model chooses.
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

from dalembert.elements.brief import brief, fields_of
from dalembert.elements.computed import ComputedNumbers
from dalembert.elements.coordinates import Coordinates
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, stack
from dalembert.text.spelling import Spelled

Scalar = Any  # number or Expression
Vector = Any  # two numbers or Expressions
Rows = Sequence[Any] | np.ndarray
Rate = Callable[[ca.SX], ca.SX]
"""Time derivative of an expression of positions."""
Condition = tuple[ca.SX, str] | tuple[ca.SX, str, ca.SX]
"""What must not be negative, what is wrong if it is, and numbers for the ``{}`` of that text."""
Powers = list[tuple[ca.SX, ca.SX]]
"""Pairs (velocity ``u``, effort ``Q``), numbers or columns, of power ``Qᵀu``."""


def quantity(
    unit: str,
    description: str,
    *,
    default: Any = dataclasses.MISSING,
    size: int = 1,
    least: int = 0,
    minimum: float = -math.inf,
    above: float = -math.inf,
    keyword: bool = False,
) -> Any:
    """Field that holds a number (or ``size`` numbers) or a formula.

    Fewer numbers, ``least``, are enough in a file where the class completes them.

    ``keyword`` makes a field without default one that must be given by name.

    ``minimum`` is allowed itself, ``above`` is not; both are checked at the parameters' values.
    """
    metadata = {
        "kind": "quantity",
        "unit": unit,
        "description": description,
        "size": size,
        "least": least,
        "minimum": minimum,
        "above": above,
    }
    return dataclasses.field(default=default, metadata=metadata, kw_only=keyword)


def option(description: str, *, default: Any = dataclasses.MISSING, keyword: bool = False) -> Any:
    """Field that is not a number: a switch, a law, a curve, a formula with own variables.

    A point or frame so described may be left out; a file gives it by its own key.
    """
    metadata = {"kind": "option", "description": description}
    return dataclasses.field(default=default, metadata=metadata, kw_only=keyword)


class Look:
    """A primitive that pictures are made of; the file ``look`` has them."""


@dataclass(eq=False)
class Element(Spelled):
    """Anything with a name that can be added to a system."""

    name: str

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        if "__repr__" not in vars(cls):  # dataclasses would write all fields of all parts
            cls.__repr__ = Element.__repr__  # type: ignore[method-assign]

    def __repr__(self) -> str:
        return brief(type(self).__name__, self.name, fields_of(self))

    def __post_init__(self) -> None:
        self.check_name()
        for field, meta in self.quantities():
            value = getattr(self, field)
            if value is None:
                if self._defaults().get(field) is not None:
                    told = "is None; give a number, or leave it out"
                    raise ModelError(told, f"{self.name}.{field}")
            else:
                value = as_expression(value, f"{self.name}.{field}", meta["unit"], meta["size"])
                setattr(self, field, value)

    def check_name(self) -> None:
        """Names are what formulas can use.

        Raises
        ------
        ModelError
            Anything else.
        """
        if not isinstance(self.name, str) or not self.name:
            raise ModelError(f"the first argument is the name, a text; got {self.name!r}")
        if not self.name.isidentifier():
            raise ModelError(
                "a name is made of letters, digits and '_', and starts with a letter; "
                f"got {self.name!r}"
            )

    @classmethod
    @functools.cache
    def _defaults(cls) -> dict[str, Any]:
        """Numbers that stand where none is given; None where that is missing or optional."""
        fields, missing = cls.quantity_fields(), dataclasses.MISSING
        return {f.name: f.default for f in fields if f.default is not missing}

    @classmethod
    def quantity_fields(cls) -> list[dataclasses.Field]:
        return [f for f in dataclasses.fields(cls) if f.metadata.get("kind") == "quantity"]

    def quantities(self):
        """(field name, metadata) of every number this element is made of."""
        for field in self.quantity_fields():
            yield field.name, field.metadata

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        """(``element.field``, formula, metadata) of the numbers given, to be checked at build."""
        return [
            (f"{self.name}.{field}", getattr(self, field), meta)
            for field, meta in self.quantities()
            if isinstance(getattr(self, field), Expression)
        ]

    def conditions(self) -> list[Condition]:
        """What must hold at the values of the parameters."""
        return []

    def doubts(self) -> list[Condition]:
        """What had better hold at the values of the parameters, and is told where it does not."""
        return []

    def foreign_parameters(self) -> list[str]:
        """Parameters of what it is made of that follow none of the mechanism, so far as is said."""
        return []

    def computed(self) -> list[ComputedNumbers]:
        """Numbers in its graph that follow parameters and are computed outside of it."""
        return []

    def parts(self) -> list[Coordinates]:
        """The bodies (and own coordinates) this element ties together."""
        return []

    def own_coordinates(self) -> list[Coordinates]:
        """Coordinates it brings along: nodes, the parameter of a curve."""
        return []

    def inertial_powers(self, rate: Rate) -> Powers:
        """Velocities ``u`` and efforts ``Q``, linear in accelerations, of the power ``Qᵀu`` that
        its mass takes, by d'Alembert; ``rate`` is that of speeds too. Bodies have their own way.
        """
        return []

    @property
    def own_mass(self) -> bool:
        """Whether it has inertia beside that of bodies."""
        return bool(self.inertial_powers(lambda s: s))

    def masses(self) -> list[tuple[ca.SX, ca.SX]]:
        """(place, mass) of what gravity pulls at."""
        return []

    def initial_conditions(self) -> list[tuple[Expression, Expression]]:
        """(measure, value) that hold at the start."""
        return []

    def own_constraints(self) -> list[Constraint]:
        """Equations that what is no constraint itself brings along (the foot of a contact)."""
        return []

    unseen = ""
    """Why pictures show nothing of its own, where they do not."""

    def look(self) -> list[Look]:
        """What pictures show of it."""
        return []


@dataclass(eq=False)
class Constraint(Element):
    """Equations ``Φ(poses, t) = 0`` of positions, and ``Ψ(poses, twists, t) = 0`` of speeds where
    no equation of positions says the same (nonholonomic ones). Both are physical: metres or
    radians, per second.

    The multiplier follows (4.22), ``M v̇ + d = f − Cᵀλ``.
    """

    relative = False
    """Its equations tell how its two bodies stand to each other, whatever moves both."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.equations = ca.densify(self.residual())
        self.slip = ca.densify(self.slipping())
        count = self.equations.numel() + self.slip.numel()
        self.multiplier = stack(ca.SX.sym(f"{self.name}.lambda{k}") for k in range(count))

    @property
    def spots(self) -> tuple[Any, Any] | None:
        """The points of its two bodies between which it stands, if there are such."""
        return None

    def residual(self) -> ca.SX:
        """Equations ``Φ`` in the pose symbols of the parts and time."""
        raise NotImplementedError

    def facing(self) -> ca.SX:
        """What is positive where parts are put together the right way round; nothing by default.

        An equation may be met by a hinge whose axis points backwards as well.
        """
        return ca.SX(0, 1)

    def slipping(self) -> ca.SX:
        """Speeds ``Ψ`` that must vanish, linear in the twists of the parts; none by default."""
        return ca.SX(0, 1)

    def units(self) -> list[str]:
        """Unit of each equation: ``m`` or ``rad``; of speeds, per second."""
        return ["m"] * self.multiplier.numel()

    def compared(self) -> tuple[ca.SX, ca.SX] | None:
        """The length or angle that its equation measures, and what it asks for; None if none."""
        return None

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        """Named quantities of its own: name → (expression, unit)."""
        return {}

    def freedoms(self) -> dict[str, tuple[ca.SX, str]]:
        """Relative motions the joint leaves free: name → (coordinate, unit)."""
        return {}


@dataclass(eq=False)
class ForceElement(Element):
    """Applied force, stated through virtual power."""

    conservative = False
    """All its work is its potential's, exactly."""
    internal = False
    """It acts within one body, and ties it to nothing."""

    def powers(self, rate: Rate) -> Powers:
        """Efforts with the velocities they do power on: ``rate(s)`` of a coordinate, ``ω`` …"""
        raise NotImplementedError

    def touching(self, rate: Rate, energy: float) -> Powers:
        """``powers``, of what is one-sided as if it touched and stored that energy [J]."""
        return self.powers(rate)

    def coordinate(self) -> ca.SX:
        """The coordinate it acts along, where that is a single one."""
        raise NotImplementedError

    def potential(self) -> ca.SX | None:
        """Potential energy of the conservative part, None if there is none."""
        return None

    def dissipation(self, rate: Rate) -> Powers:
        """The part of ``powers`` that dissipates (dampers, friction)."""
        return []

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        """Named quantities of this element: name → (expression, unit)."""
        return {}
