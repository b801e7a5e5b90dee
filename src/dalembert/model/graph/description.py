"""Complete parts of a mechanism, with its forces and the space of its parameters.

Computed numbers (shapes of flexible bodies) are appended to the parameters, ``(p, r(p))``, so that
equations, steps and gradients treat both as parameters. Gradients follow by the chain rule,
``dJ/dp = ∂J/∂p + (∂J/∂r) (∂r/∂p)``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from copy import copy
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Constraint, Element, ForceElement
from dalembert.elements.computed import ComputedNumbers
from dalembert.elements.loads import Gravity
from dalembert.errors import ModelError
from dalembert.model.graph.conditions import MechanismConditions
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
        self.outputs = dict(system.outputs)
        self.gravity, self.elements = conditions.gravity, conditions.elements()
        self.initial_conditions = conditions.initial_conditions()

    def with_conditions(self, conditions: list[tuple[Expression, Expression]]) -> Description:
        """The same parts with additional initial conditions."""
        changed = copy(self)
        changed.initial_conditions = [*self.initial_conditions, *conditions]
        return changed

    def with_elements(self, elements: Iterable[Element]) -> Description:
        """The same parts with additional elements, which have no coordinates or parameters."""
        kind = type(self)
        changed = copy(self)
        for name in [n for n in vars(self) if isinstance(getattr(kind, n, None), cached_property)]:
            delattr(changed, name)
        changed.elements = self.elements | {element.name: element for element in elements}
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


class ParameterSpace:
    """Parameters and the numbers computed from them.

    Parameters
    ----------
    parameters : (np,) SX symbols
    computed : computed numbers, in their order in the vector
    """

    def __init__(self, parameters: ca.SX, computed: list[ComputedNumbers]):
        self.computed = computed
        self.count = parameters.numel()
        self.symbols = stack([parameters, *(c.symbols for c in computed)])
        arguments = [c.arguments for c in computed]
        self._arguments = ca.Function("arguments", [parameters], arguments)
        self._slopes = ca.Function(
            "slopes", [parameters], [ca.densify(ca.jacobian(a, parameters)) for a in arguments]
        )

    def complete(self, p: np.ndarray) -> np.ndarray:
        """``(p, r(p))`` from ``p``, replacing appended numbers if there are any.

        Raises
        ------
        ModelError, AnalysisError
            A number cannot be computed at these values.
        """
        own = np.asarray(p, dtype=float)[: self.count]
        if not self.computed:
            return own
        arguments = zip(self.computed, self._columns(self._arguments, own), strict=True)
        return np.concatenate([own, *(c.values(a.ravel()) for c, a in arguments)])

    def arguments(self, p: np.ndarray, of: ComputedNumbers) -> np.ndarray:
        """Arguments of some of the computed numbers."""
        return self._columns(self._arguments, p[: self.count])[self.computed.index(of)].ravel()

    def tangents(self, p: np.ndarray, columns: Sequence[int]) -> np.ndarray:
        """(n, columns) changes of the whole vector with some of the parameters."""
        changes = [np.eye(self.count)[:, list(columns)]]
        for numbers, arguments, slopes in self._chains(p):
            changes.append(numbers.push(arguments.ravel(), slopes @ changes[0]))
        return np.vstack(changes)

    def parameter_gradients(self, p: np.ndarray, gradients: np.ndarray) -> np.ndarray:
        """(rows, np) gradients by the parameters from (rows, n) by the whole vector."""
        if not self.computed:
            return gradients
        total, begin = gradients[:, : self.count].copy(), self.count
        for numbers, arguments, slopes in self._chains(p):
            size = numbers.symbols.numel()
            own = gradients[:, begin : begin + size].T
            total += numbers.pull(arguments.ravel(), own).T @ slopes
            begin += size
        return total

    def _chains(self, p: np.ndarray) -> Iterator[tuple[ComputedNumbers, np.ndarray, np.ndarray]]:
        """Computed numbers, their arguments, and the slopes of these (k, np)."""
        if not self.computed:
            return iter(())
        own = p[: self.count]
        arguments, slopes = (self._columns(f, own) for f in (self._arguments, self._slopes))
        return zip(self.computed, arguments, slopes, strict=True)

    def _columns(self, function: ca.Function, p: np.ndarray) -> list[np.ndarray]:
        results = function(p)
        return [x.full() for x in (results if isinstance(results, (tuple, list)) else [results])]
