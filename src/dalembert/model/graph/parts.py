"""Bodies, constraints and measures of the elements and nodes of a mechanism.

Measures are named quantities: ``body.quantity``, ``body.point.quantity``, ``joint.quantity``,
``force.quantity`` or a quantity of the whole system; components of a vector are ``.x``, ``.y`` and
``.z``.
"""

from __future__ import annotations

from typing import Any, Protocol

import casadi as ca

from dalembert.elements.base import Constraint, Element, ForceElement
from dalembert.elements.blocks.block import Block
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates, rate_of
from dalembert.elements.fem.element_set import Elements
from dalembert.elements.fem.node import Node
from dalembert.elements.fem.node_set import Nodes
from dalembert.elements.pair import Pair
from dalembert.elements.planar.body import Ground
from dalembert.elements.point import AXES
from dalembert.elements.states import foreign_states
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.declared import declared
from dalembert.symbolic.formulas.expression import Expression, t
from dalembert.symbolic.formulas.inputs import Output
from dalembert.symbolic.formulas.interpolation import Interpolation
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.symbolic.formulas.parser import parse_formula


class MechanismParts:
    """Named parts of a mechanism, under construction or complete."""

    ground: Ground
    parameters: dict[str, Parameter]
    derived_parameters: dict[str, Expression]
    outputs: dict[str, Output]
    tables: dict[str, Interpolation]
    nodes: dict[str, Node | Nodes]
    elements: dict[str, Element]

    @property
    def bodies(self) -> list[Any]:
        """Added bodies, nodes, and nodes of elements."""
        added = [e for e in self.elements.values() if isinstance(e, BodyElement)]
        added += [body for node in self.nodes.values() for body in node.bodies]
        return added + [c for c in self._own_coordinates if isinstance(c, BodyElement)]

    @property
    def _own_coordinates(self) -> list[Coordinates]:
        """Coordinates of elements."""
        holders = [*self.elements.values(), *self.constraints]
        groups = (c for holder in dict.fromkeys(holders) for c in holder.own_coordinates())
        return list(dict.fromkeys(groups))

    @property
    def constraints(self) -> list[Constraint]:
        constraints: list[Constraint] = []
        for element in self.elements.values():
            constraints += (
                [element] if isinstance(element, Constraint) else element.own_constraints()
            )
        return constraints

    @property
    def coordinates(self) -> list[Coordinates]:
        """All groups of coordinates: bodies, then other coordinates of elements."""
        others = [c for c in self._own_coordinates if not isinstance(c, BodyElement)]
        return [*self.bodies, *others]

    def body(self, name: str) -> Any:
        """The body (or the ground) of this name."""
        if name == "ground":
            return self.ground
        added = self.elements.get(name)
        if isinstance(added, BodyElement):
            return added
        named = next((body for body in self.bodies if body.name == name), None)
        if named is None:
            names = ", ".join(b.name for b in self.bodies) or "none"
            raise ModelError(f"unknown body {name!r} (known: ground, {names})")
        return named

    def lookup(self, name: str) -> Any:
        """The parameter, table, time or measure of a name in a formula; None if unknown."""
        value = declared(self, name)
        if value is not None:
            return value
        owner, _, quantity = name.partition(".")
        element = self._owner(owner) if quantity else None
        return None if element is None else find_measure(element, self, owner, quantity)

    def _owner(self, name: str) -> Element | None:
        """The element, element of a set or node of this name."""
        if name in self.elements:
            return self.elements[name]
        base = name.partition("[")[0]
        part: Any = self.nodes.get(base) or self.elements.get(base)
        if isinstance(part, Node):
            return part.body if name == base else None  # type: ignore[no-any-return]
        if isinstance(part, Nodes):
            return next((body for body in part.bodies if body.name == name), None)
        return part.members.get(name) if isinstance(part, Elements) else None

    def formula(self, text: str, local: dict[str, Expression] | None = None) -> Expression:
        """Parse the text of a formula in parameters, ``t`` and measures."""

        def lookup(name: str) -> Any:
            return local[name] if local and name in local else self.lookup(name)

        names = [*self.parameters, *self.derived_parameters, "t", *(local or {})]
        return parse_formula(text, lookup, lambda: [*names, *self.measure_names()])

    def measure_names(self) -> list[str]:
        """Names of quantities of elements and nodes in formulas."""
        owners = dict(self.elements)
        for part in self.elements.values():
            owners |= part.members if isinstance(part, Elements) else {}
        for node in self.nodes.values():
            owners |= {body.name: body for body in node.bodies}
        return [
            f"{name}.{quantity}"
            for name, element in owners.items()
            for quantity in element_measures(element, self)
        ]


Measures = dict[str, tuple[ca.SX, str]]


class Everything(Protocol):
    """Parts with all coordinates, for elements that are formulas and have no list of bodies."""

    @property
    def coordinates(self) -> list[Coordinates]:
        """All groups of coordinates."""


def element_measures(element: Element, everything: Everything) -> Measures:
    """Quantities of an element: name → (expression, unit)."""
    owners = element.parts() or everything.coordinates

    def rate(expression: ca.SX) -> ca.SX:
        others = foreign_states(expression, owners, everything.coordinates)
        return rate_of(expression, [*owners, *others], t.sx)

    if isinstance(element, BodyElement):
        own = element.measures()
        for name in element.places:
            own |= _about(element, everything, name)
        return own
    if isinstance(element, Block):
        return element.measures()
    measures: Measures = {}
    for part in element.own_coordinates():
        if isinstance(part, BodyElement):
            node = part.name.removeprefix(f"{element.name}.")
            measures |= {f"{node}.{q}": m for q, m in part.measures().items()}
    if isinstance(element, ForceElement):
        return measures | element.measures(rate)
    return (
        measures | constraint_measures(element, rate)
        if isinstance(element, Constraint)
        else measures
    )


def constraint_measures(constraint: Constraint, rate) -> Measures:
    measures: Measures = {"violation": (ca.sqrt(ca.sumsqr(constraint.equations)), "m or rad")}
    for name, (coordinate, unit) in constraint.freedoms().items():
        measures[name] = (coordinate, unit)
        measures[f"{name}_rate"] = (rate(coordinate), f"{unit}/s")
    for part in constraint.own_coordinates():
        measures[part.name.rpartition(".")[2]] = (part.pose[0], part.coordinate_units[0])
    if isinstance(constraint, Pair):
        force, moment = constraint.reaction()
        measures["force"] = (force, "N")
        measures["force_norm"] = (ca.sqrt(ca.sumsqr(force)), "N")
        measures["moment"] = (moment, "N m")
    return measures | constraint.measures(rate)


def _about(element: Element, everything: Everything, quantity: str) -> Measures:
    """Measures of an element that include a quantity, if it exists; avoids all points of a body."""
    name = quantity.partition(".")[0]
    if isinstance(element, BodyElement) and name in element.places:
        return {f"{name}.{q}": m for q, m in element.places[name].measures().items()}
    return element_measures(element, everything)


def find_measure(
    element: Element, everything: Everything, owner: str, quantity: str
) -> Expression | None:
    """A measure of an element, or None.

    Parameters
    ----------
    owner : name of the element in formulas
    quantity : name of the measure, or of a component of it
    """
    measures, name = _about(element, everything, quantity), f"{owner}.{quantity}"
    if quantity in measures:
        sx, unit = measures[quantity]
        return Expression(sx, name, unit)
    stem, _, component = quantity.rpartition(".")
    if (
        stem in measures
        and component in AXES[: measures[stem][0].numel()]
        and measures[stem][0].numel() > 1
    ):
        sx, unit = measures[stem]
        return Expression(sx[AXES.index(component)], name, unit)
    return None
