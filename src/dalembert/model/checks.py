"""What is refused before anything is assembled."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import partial

import casadi as ca
import numpy as np

from dalembert.elements.base import Constraint, ForceElement, rate_of
from dalembert.errors import ExpressionError, ModelError
from dalembert.model.description import Description
from dalembert.symbolic.expression import free_symbols, stack, t


def check_membership(d: Description) -> None:
    """Every part an element is tied to must belong to the mechanism."""
    if not d.bodies:
        raise ModelError("has no bodies; add at least one", d.name)
    known = {id(c) for c in (*d.coordinates, d.ground)}
    for element in d.elements.values():
        for part in element.parts():
            if id(part) not in known:
                raise ModelError(
                    f"is tied to {part.name!r}, which was not added to the system; "
                    f"add it with system.add(...)",
                    element.name,
                )
        joint = getattr(element, "joint", None)
        if isinstance(joint, Constraint) and d.elements.get(joint.name) is not joint:
            raise ModelError(f"its joint {joint.name!r} was not added to the system", element.name)


def check_symbols(d: Description) -> None:
    """What formulas may depend on: lengths on parameters, joints on poses, forces on speeds."""
    parameters = set(d.parameters)
    poses = {"t"} | _names(c.pose for c in (*d.coordinates, d.ground))
    states = poses | _names(c.twist for c in (*d.coordinates, d.ground))
    for element in d.elements.values():
        if isinstance(element, Constraint):
            _allow(element.name, element.equations, parameters | poses, "positions and t")
        elif isinstance(element, ForceElement):
            rate = partial(rate_of, owners=element.parts() or d.coordinates, time=t.sx)
            for s, q in element.works(rate):
                _allow(element.name, s, parameters | poses, "positions and t")
                _allow(element.name, q, parameters | states, "positions, speeds and t")
        else:
            for entity, formula, _ in element.checked_quantities():
                _allow(entity, formula.sx, parameters, "")
    for name, formula in d.derived_parameters.items():
        _allow(name, formula.sx, parameters, "")


def _allow(entity: str, formula: ca.SX, allowed: set[str], also: str) -> None:
    foreign = free_symbols(formula) - allowed
    if foreign:
        what = f"parameters of this system, {also}" if also else "parameters of this system"
        raise ExpressionError(
            f"depends on {', '.join(sorted(foreign))}; only {what} are allowed here", entity
        )


def check_values(d: Description, values: Sequence[float] | np.ndarray) -> None:
    """Numbers must be finite and within their limits at the given parameter values."""
    symbols = stack(p.sx for p in d.parameters.values())
    for element in d.elements.values():
        for entity, formula, meta in element.checked_quantities():
            if free_symbols(formula.sx) - set(d.parameters):
                continue
            numbers = ca.Function("q", [symbols], [formula.sx])(values).full().ravel()
            for number in numbers:
                _check_number(float(number), entity, meta)
        for condition, wrong in element.conditions():
            found = ca.Function("c", [symbols], [condition])(values)
            if not float(found) >= 0:
                raise ModelError(wrong, element.name)


def _names(columns: Iterable[ca.SX]) -> set[str]:
    return {name for column in columns for name in free_symbols(column)}


def _check_number(number: float, entity: str, meta: Mapping) -> None:
    unit = f" {meta['unit']}" if meta["unit"] else ""
    if not math.isfinite(number):
        raise ModelError(f"its value is {number}; give a finite number", entity)
    if number < meta["minimum"]:
        raise ModelError(
            f"is {number:g}{unit}, but it must not be "
            f"{'negative' if meta['minimum'] == 0 else 'below ' + str(meta['minimum'])}",
            entity,
        )
    if number <= meta["above"]:
        raise ModelError(f"is {number:g}{unit}, but it must be above {meta['above']:g}", entity)
