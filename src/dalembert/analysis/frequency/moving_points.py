"""Inputs that move points of dampers, whose velocities a linear system does not have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

import casadi as ca

from dalembert.elements.frame import Frame
from dalembert.elements.point import Point
from dalembert.errors import UnsupportedError
from dalembert.model.graph.model import Model
from dalembert.symbolic.formulas.expression import as_sx


def refuse_moving_points(model: Model, names: Sequence[str]) -> None:
    """Raise if an input moves a point of an element whose force depends on its velocity.

    Raises
    ------
    UnsupportedError
        Names the input and the element.
    """
    for name in names:
        symbol = model.parameters[name].sx
        for element in model.forces:
            if _moved(element, symbol) and _damped(element):
                raise UnsupportedError(
                    f"input {name} moves a point of {element.name}, whose force depends on the "
                    "velocity of the point; attach the point to a particle that a CoordinateDriver "
                    f"moves with the law {name}, so that velocities and accelerations follow"
                )


def _moved(element: Any, symbol: ca.SX) -> bool:
    """Whether the coordinates of a point in its body depend on a symbol."""
    values = (getattr(element, field.name) for field in fields(element) if field.init)
    places = [value.position.sx for value in values if isinstance(value, (Point, Frame))]
    return any(ca.depends_on(ca.densify(place), symbol) for place in places)


def _damped(element: Any) -> bool:
    """Whether a force may depend on velocities: a coefficient of damping, or a law."""
    damping = getattr(element, "damping", None)
    damping = as_sx(0.0 if damping is None else damping)
    return not damping.is_zero() or getattr(element, "law", None) is not None
