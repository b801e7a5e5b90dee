"""Description of a mechanism: its parts, its parameter vector, and the names of its measures.

Numbers computed outside of the graph (shapes of flexible bodies) are appended to the parameters,
``(p, r(p))``, so that equations, steps and gradients treat both as parameters. Gradients follow by
the chain rule, ``dJ/dp = ∂J/∂p + (∂J/∂r) (∂r/∂p)``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import Constraint, Element, ForceElement
from dalembert.elements.body import BodyElement
from dalembert.elements.computed import ComputedNumbers
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.loads import Gravity
from dalembert.elements.planar.body import Ground
from dalembert.errors import ModelError
from dalembert.model.measures import element_measures, find_measure
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, stack, t
from dalembert.symbolic.formulas.interpolation import Interpolation
from dalembert.symbolic.formulas.parameter import Parameter
from dalembert.symbolic.formulas.parser import parse_formula
from dalembert.text.wording import card, plain_text, table


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

    def gathered(self, p: np.ndarray, gradients: np.ndarray) -> np.ndarray:
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


class Description:
    """The parts of a mechanism by name; filled by the builder, copied by the model.

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
        """A copy with the same parts; additions do not affect the original."""
        copied = Description(self.name, self.gravity, self.description)
        copied.ground = self.ground
        copied.parameters = dict(self.parameters)
        copied.derived_parameters = dict(self.derived_parameters)
        copied.tables = dict(self.tables)
        copied.elements = dict(self.elements)
        copied.initial_conditions = list(self.initial_conditions)
        return copied

    def __repr__(self) -> str:
        kind, counted = type(self).__name__, f"{len(self.elements)} elements"
        return f"<{kind} {self.name!r}: {counted}, {len(self.parameters)} parameters>"

    def _repr_html_(self) -> str:
        counted = f"{len(self.elements)} elements, {len(self.parameters)} parameters"
        kinds = [(e.name, type(e).__name__) for e in self.elements.values()]
        parts = (table(kinds, ("element", "kind")), self.parameter_table())
        return card(f"{type(self).__name__} {self.name}", counted, *parts)

    def parameter_table(self) -> str:
        """The parameters as an HTML table, for notebooks."""
        rows = [
            (p.name, float(p.value), p.unit or "–", _bounds_text(p.bounds), p.description)
            for p in self.parameters.values()
        ]
        return table(rows, ("parameter", "value", "unit", "bounds", ""))

    @property
    def bodies(self) -> list[Any]:
        """Added bodies, and nodes of elements."""
        added = [e for e in self.elements.values() if isinstance(e, BodyElement)]
        return added + [c for c in self._own_coordinates if isinstance(c, BodyElement)]

    @property
    def _own_coordinates(self) -> list[Coordinates]:
        """Coordinates of elements."""
        holders = [*self.elements.values(), *self.constraints]
        groups = (c for holder in dict.fromkeys(holders) for c in holder.own_coordinates())
        return list(dict.fromkeys(groups))

    @cached_property
    def space(self) -> ParameterSpace:
        """Parameters, and numbers computed from them; for a complete description."""
        computed = [c for element in self.elements.values() for c in element.computed()]
        return ParameterSpace(stack(p.sx for p in self.parameters.values()), computed)

    @property
    def constraints(self) -> list[Constraint]:
        constraints: list[Constraint] = []
        for element in self.elements.values():
            constraints += (
                [element] if isinstance(element, Constraint) else element.own_constraints()
            )
        return constraints

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

    @property
    def coordinates(self) -> list[Coordinates]:
        """All groups of coordinates: bodies, then other coordinates of elements."""
        others = [c for c in self._own_coordinates if not isinstance(c, BodyElement)]
        return [*self.bodies, *others]

    def body(self, name: str) -> Any:
        """The body (or the ground) of this name."""
        if name == "ground":
            return self.ground
        named = next((body for body in self.bodies if body.name == name), None)
        if named is None:
            names = ", ".join(b.name for b in self.bodies) or "none"
            raise ModelError(f"unknown body {name!r} (known: ground, {names})")
        return named

    def lookup(self, name: str) -> Any:
        """The parameter, table, time or measure of a name in a formula."""
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

        names = [*self.parameters, *self.derived_parameters, "t", *(local or {})]
        return parse_formula(text, lookup, lambda: [*names, *self.measure_names()])

    def measure_names(self) -> list[str]:
        """Names of quantities of elements in formulas."""
        return [
            f"{name}.{quantity}"
            for name, element in self.elements.items()
            for quantity in element_measures(element, self.coordinates)
        ]


def _field(gravity) -> Expression:
    """Gravity as an expression of two components in the plane, three in space."""
    size = gravity.sx.numel() if isinstance(gravity, Expression) else 1
    if isinstance(gravity, (list, tuple, np.ndarray)):
        size = len(gravity)
        if any(np.ndim(part) for part in gravity if isinstance(part, (list, tuple, np.ndarray))):
            raise ModelError(f"gravity is {gravity!r}; give 2 or 3 numbers", "gravity")
    return as_expression(gravity, "gravity", "m/s^2", 3 if size == 3 else 2)


def _bounds_text(bounds: tuple[float | None, float | None]) -> str:
    low, high = ("" if value is None else f"{value:g}" for value in bounds)
    return f"{low} … {high}" if low or high else "–"
