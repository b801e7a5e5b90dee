"""What a mechanism consists of, and how its names are read."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from dalembert.elements.base import Constraint, Element, ForceElement
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.loads import Gravity
from dalembert.elements.planar.body import Ground
from dalembert.errors import ModelError
from dalembert.model.measures import element_measures, find_measure
from dalembert.model.parameter_space import ParameterSpace
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, stack, t
from dalembert.symbolic.formulas.interpolation import Interpolation
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.symbolic.formulas.parser import parse_formula
from dalembert.text.wording import card, plain_text, table


class Description:
    """The parts of a mechanism by name; the builder fills it, the model keeps a copy.

    Parameters
    ----------
    name : str
    gravity : (2,) or (3,) acceleration of gravity [m/s²]; none by default
    description : str
    """

    def __init__(self, name: str, gravity=None, description: str = ""):
        self.name = plain_text(name, "name of the system")
        self.description = plain_text(description, "description of the system")
        self.gravity = None if gravity is None else _field(gravity)
        self.ground = Ground()
        self.parameters: dict[str, Parameter] = {}
        self.derived_parameters: dict[str, Expression] = {}
        self.tables: dict[str, Interpolation] = {}
        self.elements: dict[str, Element] = {}
        self.initial_conditions: list[tuple[Expression, Expression]] = []

    def copy(self) -> Description:
        """The same parts; adding to one leaves the other as it is."""
        made = Description(self.name, self.gravity, self.description)
        made.ground = self.ground
        made.parameters = dict(self.parameters)
        made.derived_parameters = dict(self.derived_parameters)
        made.tables = dict(self.tables)
        made.elements = dict(self.elements)
        made.initial_conditions = list(self.initial_conditions)
        return made

    def __repr__(self) -> str:
        kind, counted = type(self).__name__, f"{len(self.elements)} elements"
        return f"<{kind} {self.name!r}: {counted}, {len(self.parameters)} parameters>"

    def _repr_html_(self) -> str:
        counted = f"{len(self.elements)} elements, {len(self.parameters)} parameters"
        kinds = [(e.name, type(e).__name__) for e in self.elements.values()]
        parts = (table(kinds, ("element", "kind")), self.parameter_table())
        return card(f"{type(self).__name__} {self.name}", counted, *parts)

    def parameter_table(self) -> str:
        """The parameters, as notebooks show them."""
        rows = [
            (p.name, float(p.value), p.unit or "–", _told(p.bounds), p.description)
            for p in self.parameters.values()
        ]
        return table(rows, ("parameter", "value", "unit", "bounds", ""))

    @property
    def bodies(self) -> list[Any]:
        """Those that were added, and nodes that elements bring along."""
        added = [e for e in self.elements.values() if isinstance(e, BodyElement)]
        return added + [c for c in self._own_coordinates if isinstance(c, BodyElement)]

    @property
    def _own_coordinates(self) -> list[Coordinates]:
        """Those that elements bring along."""
        holders = [*self.elements.values(), *self.constraints]
        found = (c for holder in dict.fromkeys(holders) for c in holder.own_coordinates())
        return list(dict.fromkeys(found))

    @cached_property
    def space(self) -> ParameterSpace:
        """Parameters, and numbers that are computed from them; of a description that is whole."""
        computed = [c for element in self.elements.values() for c in element.computed()]
        return ParameterSpace(stack(p.sx for p in self.parameters.values()), computed)

    @property
    def constraints(self) -> list[Constraint]:
        found: list[Constraint] = []
        for element in self.elements.values():
            found += [element] if isinstance(element, Constraint) else element.own_constraints()
        return found

    @property
    def conditions(self) -> list[tuple[Expression, Expression]]:
        """(measure, value) that hold at the start, given or of elements."""
        own = [c for element in self.elements.values() for c in element.initial_conditions()]
        return [*self.initial_conditions, *own]

    @property
    def rows(self) -> list[tuple[Constraint, int]]:
        """Constraint and component behind each equation, nonholonomic ones last."""
        spans = [(c, c.equations.numel(), c.multiplier.numel()) for c in self.constraints]
        of_position = [(c, k) for c, held, _ in spans for k in range(held)]
        return of_position + [(c, k) for c, held, count in spans for k in range(held, count)]

    @property
    def forces(self) -> list[ForceElement]:
        own = [e for e in self.elements.values() if isinstance(e, ForceElement)]
        own += [force for body in self.bodies for force in body.own_forces()]
        if self.gravity is not None:
            own.insert(0, Gravity(self.gravity, list(self.elements.values())))
        return own

    @property
    def coordinates(self) -> list[Coordinates]:
        """All groups of coordinates: bodies, then others that elements bring along."""
        others = [c for c in self._own_coordinates if not isinstance(c, BodyElement)]
        return [*self.bodies, *others]

    def body(self, name: str) -> Any:
        """The body (or the ground) of this name."""
        if name == "ground":
            return self.ground
        found = next((body for body in self.bodies if body.name == name), None)
        if found is None:
            known = ", ".join(b.name for b in self.bodies) or "none"
            raise ModelError(f"unknown body {name!r} (known: ground, {known})")
        return found

    def lookup(self, name: str) -> Any:
        """The parameter, table, time or measure behind a name of a formula."""
        if name in self.tables:
            return self.tables[name]
        if name == "t":
            return t
        if name in self.parameters:
            return self.parameters[name]
        if name in self.derived_parameters:
            return self.derived_parameters[name]
        return find_measure(self.elements, self.coordinates, name)

    def formula(self, text: str, local: dict[str, Expression] | None = None) -> Expression:
        """Parse the text of a formula in parameters, ``t`` and measures."""

        def lookup(name: str) -> Any:
            return local[name] if local and name in local else self.lookup(name)

        known = [*self.parameters, *self.derived_parameters, "t", *(local or {})]
        return parse_formula(text, lookup, lambda: [*known, *self.measure_names()])

    def measure_names(self) -> list[str]:
        """All names that formulas may use for quantities of elements."""
        return [
            f"{name}.{quantity}"
            for name, element in self.elements.items()
            for quantity in element_measures(element, self.coordinates)
        ]


def _field(gravity) -> Expression:
    """Gravity in the plane, or in space by three components."""
    size = gravity.sx.numel() if isinstance(gravity, Expression) else 1
    if isinstance(gravity, (list, tuple, np.ndarray)):
        size = len(gravity)
        if any(np.ndim(part) for part in gravity if isinstance(part, (list, tuple, np.ndarray))):
            raise ModelError(f"gravity is {gravity!r}; give 2 or 3 numbers", "gravity")
    return as_expression(gravity, "gravity", "m/s^2", 3 if size == 3 else 2)


def _told(bounds: tuple[float | None, float | None]) -> str:
    low, high = ("" if value is None else f"{value:g}" for value in bounds)
    return f"{low} … {high}" if low or high else "–"
