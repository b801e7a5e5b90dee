"""The mutable, validating builder of a model."""

from __future__ import annotations

import math
from collections.abc import Iterable

import casadi as ca

from dalembert.elements.base import Constraint, Coordinates, Element, ForceElement, rate_of
from dalembert.elements.planar.body import Body, Ground
from dalembert.elements.planar.loads import Gravity
from dalembert.errors import ExpressionError, ModelError
from dalembert.model.measures import element_measures, find_measure
from dalembert.model.model import Model
from dalembert.symbolic.expression import Expression, as_expression, free_symbols, stack, t
from dalembert.symbolic.parameter import Parameter
from dalembert.symbolic.parser import parse_formula

RESERVED = {"t", "u", "pi", "e", "ground", "system", "extension", "rate"}


class System:
    """A mechanism under construction.

    Parameters
    ----------
    name : str
    gravity : (2,) acceleration of gravity [m/s²]; none by default
    description : str
    """

    def __init__(self, name: str, gravity=None, description: str = ""):
        self.name = name
        self.description = description
        self.gravity = None if gravity is None else as_expression(gravity, "gravity", "m/s^2", 2)
        self.ground = Ground()
        self.parameters: dict[str, Parameter] = {}
        self.derived_parameters: dict[str, Expression] = {}
        self.elements: dict[str, Element] = {}
        self.initial_conditions: list[tuple[Expression, Expression]] = []

    # building ----------------------------------------------------------------
    def parameter(
        self, name: str, value: float, unit: str = "", bounds=None, description: str = ""
    ) -> Parameter:
        """Declare a parameter; use it in formulas wherever a number is accepted."""
        self._claim(name)
        if not name.isidentifier():
            raise ModelError(
                f"{name!r} is not an identifier; use letters, digits and '_'", "parameter"
            )
        made = Parameter(name, value, unit, bounds, description)
        self.parameters[name] = made
        return made

    def derived(self, name: str, formula, unit: str = "", description: str = "") -> Expression:
        """Name a formula of parameters; it is listed beside them."""
        self._claim(name)
        made = as_expression(formula, name, unit)
        made.name = name
        self.derived_parameters[name] = made
        return made

    def add(self, element):
        """Add a body, joint, driver or force; returns it."""
        if not isinstance(element, Element):
            raise ModelError(f"add() takes an element, got {element!r}", self.name)
        if element.name in self.elements:
            raise ModelError(
                "the name is already used by another element; choose a different one", element.name
            )
        self._claim(element.name)
        self.elements[element.name] = element
        return element

    def initial(self, measure: Expression, value) -> None:
        """Prescribe a position-level measure, or a speed, at the start, exactly.

        Unlike the guesses given to bodies, assembly never moves it.
        """
        self.initial_conditions.append(
            (as_expression(measure, "initial condition"), as_expression(value, "initial value"))
        )

    def _claim(self, name: str) -> None:
        if name in RESERVED:
            raise ModelError(f"the name {name!r} is reserved; choose another", self.name)
        if name in self.parameters or name in self.derived_parameters or name in self.elements:
            raise ModelError("the name is already used; choose a different one", name)

    # looking up ----------------------------------------------------------------
    @property
    def bodies(self) -> list[Body]:
        return [e for e in self.elements.values() if isinstance(e, Body)]

    @property
    def constraints(self) -> list[Constraint]:
        return [e for e in self.elements.values() if isinstance(e, Constraint)]

    @property
    def forces(self) -> list[ForceElement]:
        own = [e for e in self.elements.values() if isinstance(e, ForceElement)]
        if self.gravity is not None:
            own.insert(0, Gravity(self.gravity, self.bodies))
        return own

    @property
    def coordinates(self) -> list[Coordinates]:
        """All groups of coordinates: bodies, then those that constraints bring along."""
        own = [c for constraint in self.constraints for c in constraint.own_coordinates()]
        return [*self.bodies, *own]

    def body(self, name: str) -> Body:
        """The body (or the ground) of this name."""
        if name == "ground":
            return self.ground
        found = self.elements.get(name)
        if not isinstance(found, Body):
            known = ", ".join(b.name for b in self.bodies) or "none"
            raise ModelError(f"unknown body {name!r} (known: ground, {known})")
        return found

    def lookup(self, name: str) -> Expression | None:
        """The parameter, time or measure behind a name of a formula."""
        if name == "t":
            return t
        if name in self.parameters:
            return self.parameters[name]
        if name in self.derived_parameters:
            return self.derived_parameters[name]
        return find_measure(self, name)

    def formula(self, text: str, local: dict[str, Expression] | None = None) -> Expression:
        """Parse the text of a formula in parameters, ``t`` and measures."""

        def lookup(name: str) -> Expression | None:
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

    # freezing ------------------------------------------------------------------
    def build(self, strict: bool = False) -> Model:
        """Check, assemble and freeze.

        Parameters
        ----------
        strict : refuse inconsistent initial speeds instead of projecting them

        Raises
        ------
        ModelError
            A wrong number, a dangling joint, an over-driven mechanism, …
        AssemblyError
            The joints cannot be closed; names the worst one and its residual.
        """
        self._check_membership()
        self._check_symbols()
        self._check_values()
        return Model(self, strict=strict)

    def _check_membership(self) -> None:
        if not self.bodies:
            raise ModelError("has no bodies; add at least one", self.name)
        known = {id(c) for c in (*self.coordinates, self.ground)}
        for element in self.elements.values():
            for part in element.parts():
                if id(part) not in known:
                    raise ModelError(
                        f"is tied to {part.name!r}, which was not added to the system; "
                        f"add it with system.add(...)",
                        element.name,
                    )
            joint = getattr(element, "joint", None)
            if isinstance(joint, Constraint) and self.elements.get(joint.name) is not joint:
                raise ModelError(
                    f"its joint {joint.name!r} was not added to the system", element.name
                )

    def _check_symbols(self) -> None:
        """What formulas may depend on: lengths on parameters, joints on poses, forces on speeds."""
        parameters = set(self.parameters)
        poses = {"t"} | _names(c.pose for c in (*self.coordinates, self.ground))
        states = poses | _names(c.twist for c in (*self.coordinates, self.ground))
        for element in self.elements.values():
            if isinstance(element, Constraint):
                self._allow(element.name, element.equations, parameters | poses, "positions and t")
            elif isinstance(element, ForceElement):
                owners = element.parts() or self.coordinates
                works = element.works(lambda s, owners=owners: rate_of(s, owners, t.sx))
                for s, q in works:
                    self._allow(element.name, s, parameters | poses, "positions and t")
                    self._allow(element.name, q, parameters | states, "positions, speeds and t")
            else:
                for entity, formula, _ in element.checked_quantities():
                    self._allow(entity, formula.sx, parameters, "")
        for name, formula in self.derived_parameters.items():
            self._allow(name, formula.sx, parameters, "")

    @staticmethod
    def _allow(entity: str, formula: ca.SX, allowed: set[str], also: str) -> None:
        foreign = free_symbols(formula) - allowed
        if foreign:
            what = f"parameters of this system, {also}" if also else "parameters of this system"
            raise ExpressionError(
                f"depends on {', '.join(sorted(foreign))}; only {what} are allowed here", entity
            )

    def _check_values(self) -> None:
        symbols = stack(p.sx for p in self.parameters.values())
        values = [p.value for p in self.parameters.values()]
        for element in self.elements.values():
            for entity, formula, meta in element.checked_quantities():
                if free_symbols(formula.sx) - set(self.parameters):
                    continue
                numbers = ca.Function("q", [symbols], [formula.sx])(values).full().ravel()
                for number in numbers:
                    _check_number(float(number), entity, meta)
            for formula, wrong in element.conditions():
                found = ca.Function("c", [symbols], [formula])(values)
                if not float(found) >= 0:
                    raise ModelError(wrong, element.name)


def _names(columns: Iterable[ca.SX]) -> set[str]:
    return {name for column in columns for name in free_symbols(column)}


def _check_number(number: float, entity: str, meta: dict) -> None:
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
