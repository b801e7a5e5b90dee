"""Complete parts of a mechanism, with its parameter vector and its forces."""

from __future__ import annotations

from copy import copy
from functools import cached_property
from typing import Any

import numpy as np

from dalembert.elements.base import Constraint, ForceElement
from dalembert.elements.loads import Gravity
from dalembert.errors import ModelError
from dalembert.model.graph.conditions import MechanismConditions
from dalembert.model.graph.parameter_space import ParameterSpace
from dalembert.model.graph.parts import MechanismParts
from dalembert.model.supports_and_loads import SupportsAndLoads
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, stack


class Description(MechanismParts):
    """The parts of a mechanism: nodes are bodies, supports and loads are joints and forces.

    Parameters
    ----------
    system : builder, to which later additions do not affect the description

    Raises
    ------
    ModelError
        Loads that mechanisms do not have.
    """

    def __init__(self, system: SupportsAndLoads):
        conditions = MechanismConditions(system)
        self.name, self.description, self.ground = system.name, system.description, system.ground
        self.parameters = dict(system.parameters)
        self.derived_parameters = dict(system.derived_parameters)
        self.tables, self.nodes = dict(system.tables), dict(system.nodes)
        self.gravity, self.elements = conditions.gravity, conditions.elements()
        self.initial_conditions = conditions.initial_conditions()

    def with_conditions(self, conditions: list[tuple[Expression, Expression]]) -> Description:
        """The same parts with additional initial conditions."""
        changed = copy(self)
        changed.initial_conditions = [*self.initial_conditions, *conditions]
        return changed

    @cached_property
    def space(self) -> ParameterSpace:
        """Parameters, and numbers computed from them; for a complete description."""
        computed = [c for element in self.elements.values() for c in element.computed()]
        return ParameterSpace(stack(p.sx for p in self.parameters.values()), computed)

    @property
    def conditions(self) -> list[tuple[Expression, Expression]]:
        """(measure, value) prescribed at the start, by the user or by elements."""
        own = [c for element in self.elements.values() for c in element.initial_conditions()]
        return [*self.initial_conditions, *own]

    @property
    def rows(self) -> list[tuple[Constraint, int]]:
        """Constraint and component of each equation, nonholonomic ones last."""
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


def gravity_field(gravity: Any) -> tuple[Expression, ...]:
    """Gravity as two components in the plane, three in space."""
    size = gravity.sx.numel() if isinstance(gravity, Expression) else 1
    if isinstance(gravity, (list, tuple, np.ndarray)):
        size = len(gravity)
        if any(np.ndim(part) for part in gravity if isinstance(part, (list, tuple, np.ndarray))):
            raise ModelError(f"gravity is {gravity!r}; give 2 or 3 numbers", "gravity")
    field = as_expression(gravity, "gravity", "m/s^2", 3 if size == 3 else 2)
    return tuple(field[k] for k in range(len(field)))
