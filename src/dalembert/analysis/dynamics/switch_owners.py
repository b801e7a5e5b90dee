"""Which force or law a switch belongs to, for messages."""

from __future__ import annotations

import casadi as ca
import numpy as np

from dalembert.analysis.dynamics.kernel import DynamicsKernel
from dalembert.elements.base import Constraint, Element, ForceElement
from dalembert.elements.coordinates import rate_of
from dalembert.model.model import Model
from dalembert.symbolic.formulas.switches import freeze_branches

SAME = 1e-9
"""Relative difference of two switching functions at a state that makes them the same."""


def owner_of(kernel: DynamicsKernel, mode: int, number: int, t: float, x: np.ndarray, p) -> str:
    """The elements with a switch that has, at this state, the value of this one."""
    model = kernel.model
    distance = float(kernel.distances(t, x, p)[number])
    y, v, *_ = kernel.variants[mode].bodies(t, x, p)
    named = []
    for element in [*model.forces, *model.constraints]:
        values = np.abs(_values(model, element, t, y, v, p))
        if np.any(np.abs(values - abs(distance)) <= SAME * np.maximum(values, SAME)):
            named.append(element.name)
    return f"the force of {', '.join(named)}" if named else "a force"


def _values(model: Model, element: Element, t, y, v, p) -> np.ndarray:
    """The switching functions of one element."""
    e = model.all_equations
    if isinstance(element, ForceElement):
        owners = element.parts() or model.coordinates
        powers = element.powers(lambda s: rate_of(s, owners, e.t))
        formulas = [model.at_ground(effort) for _, effort in powers]
    else:
        formulas = [model.at_ground(element.equations)] if isinstance(element, Constraint) else []
    _, switches = freeze_branches(formulas, ca.vertcat(e.t, e.y, e.v))
    g = ca.substitute(switches.functions, switches.sides, switches.actual)
    return ca.Function("g", [e.t, e.y, e.v, e.p], [g])(t, y, v, p).full().ravel()
