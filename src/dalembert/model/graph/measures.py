"""Measures: named quantities of a mechanism.

``body.quantity``, ``body.point.quantity``, ``joint.quantity``, ``force.quantity`` or a quantity
of the whole system; a vector's components are ``.x``, ``.y`` and ``.z``.
"""

from __future__ import annotations

from typing import Protocol

import casadi as ca

from dalembert.elements.base import Constraint, Element, ForceElement
from dalembert.elements.body import BodyElement
from dalembert.elements.coordinates import Coordinates, rate_of
from dalembert.elements.pair import Pair
from dalembert.elements.point import AXES
from dalembert.symbolic.formulas.expression import Expression, t

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
        return rate_of(expression, owners, t.sx)

    if isinstance(element, BodyElement):
        own = element.measures()
        for name in element.places:
            own |= _about(element, everything, name)
        return own
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
