"""The same mechanism written in other units of length, mass and time.

Parameters keep their values; every quantity of every element, a formula of parameters, positions,
speeds and time, is multiplied by the factor of its own unit, with what it is a formula of divided
by theirs. So a mechanism in metres becomes one in nanometres whatever its formulas say.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import casadi as ca
import numpy as np

import dalembert as da
from dalembert import planar, spatial, t
from dalembert.elements.base import Constraint, Element
from dalembert.elements.body import BodyElement
from dalembert.elements.component import Component
from dalembert.elements.curves import Curve, FormulaCurve, u
from dalembert.elements.flexible.beam import Beam
from dalembert.elements.frame import Frame
from dalembert.elements.laws.base import Law
from dalembert.elements.planar import drivers as planar_drivers
from dalembert.elements.springs import SpringDamper
from dalembert.model.graph.description import Description
from dalembert.symbolic.formulas.expression import Expression

DIMENSIONS = {
    "": (0, 0, 0),
    "1": (0, 0, 0),
    "rad": (0, 0, 0),
    "m": (1, 0, 0),
    "kg": (0, 1, 0),
    "s": (0, 0, 1),
    "K": (0, 0, 0),
    "N": (1, 1, -2),
    "Pa": (-1, 1, -2),
    "J": (2, 1, -2),
    "W": (2, 1, -3),
    "A": (0, 0, 0),
    "V": (2, 1, -3),
    "Ω": (2, 1, -3),
    "H": (2, 1, -2),
}
"""Powers of length, mass and time; the ampere stays."""


@dataclass(frozen=True)
class Units:
    """How many new units the old ones are."""

    length: float = 1.0
    mass: float = 1.0
    time: float = 1.0

    def __call__(self, unit: str) -> float:
        """Factor of a quantity, e.g. of ``kg m^2`` or ``N s/m``."""
        above, _, below = unit.partition("/")
        power = np.zeros(3)
        for part, sign in ((above, 1), (below, -1)):
            for word in part.split():
                base, _, exponent = word.partition("^")
                power += sign * int(exponent or 1) * np.array(DIMENSIONS[base])
        return float(np.prod(np.array([self.length, self.mass, self.time]) ** power))

    def of_rates(self, unit: str) -> float:
        return self(unit) / self.time


def in_other_units(system, units: Units) -> da.System:
    """The mechanism of a system, or of the parts of a model."""
    return _Translation(system, units).converted


class _Translation:
    def __init__(self, system, units: Units):
        system = system if isinstance(system, Description) else Description(system)
        self.units, self.converted = units, da.System(system.name)
        self.converted.parameters.update(system.parameters)
        self.converted.derived_parameters.update(system.derived_parameters)
        self.bodies = {"ground": self.converted.ground}
        self.old, self.new = [t.sx], [t.sx / units.time]
        self._identify(system.ground, self.converted.ground)
        if system.gravity is not None:
            self.converted.gravity(*self.formula(system.gravity, "m/s^2"))
        for element in system.elements.values():
            if isinstance(element, BodyElement):
                added = self.converted.add(self.body(element))
                self.bodies[element.name] = added
                self._identify(element, added)
        for element in system.elements.values():
            if not isinstance(element, BodyElement):
                self.converted.elements[element.name] = self.element(element)
        order = list(system.elements)
        self.converted.elements = {name: self.converted.elements[name] for name in order}
        for measure, value in system.initial_conditions:
            self.converted.initial(
                self.formula(measure, measure.unit), self.formula(value, measure.unit)
            )

    def _identify(self, old, new) -> None:
        factors = ca.vertcat(*(self.units(unit) for unit in old.coordinate_units))
        rates = ca.vertcat(*(self.units.of_rates(unit) for unit in old.speed_units))
        self.old += [old.pose, old.twist]
        self.new += [new.pose / factors, new.twist / rates]

    def formula(self, expression: Expression, unit: str) -> Expression:
        return Expression(self.units(unit) * ca.substitute([expression.sx], self.old, self.new)[0])

    def point(self, point: planar.Point) -> planar.Point:
        local = self.formula(point.local, "m")
        body = self.bodies[point.body.name]
        if isinstance(point, Frame):
            frame = body.frame(local)
            frame.local_axes, frame.has_x_axis = point.local_axes, point.has_x_axis
            return frame
        return body.center if not body.rotates else body.point(*local)

    def body(self, body):
        wanted = dict(zip(body.initial_fields, body.initial, strict=True))
        wanted |= {"mass": body.mass, "inertia": body.inertia if body.rotates else None}
        sizes = {f.name for f in body.quantity_fields()} - {*wanted, "density", "center_of_mass"}
        wanted |= {name: getattr(body, name) for name in sizes}
        if isinstance(body, spatial.Body) and body.rotates:
            wanted["center_of_mass"] = body.center_of_mass
        rotation = wanted.pop("rotation", None)
        turned = {"rotation": rotation} if body.dimension == 3 and body.rotates else {}
        metas = {f.name: f.metadata for f in body.quantity_fields()}
        arguments = {
            name: self.formula(value, metas[name]["unit"])
            for name, value in wanted.items()
            if value is not None
        }
        copy = type(body)(body.name, **arguments, **turned)
        for name, point in body.points.items():
            if name not in copy.points:
                copy.add_point(name, self.formula(point.local, "m"))
        return copy

    def element(self, element: Element) -> Element:
        fields = dataclasses.fields(element)
        if isinstance(element, planar_drivers.JointDriver) and element.joint is not None:
            fields = [f for f in fields if f.name in ("name", "joint", "law")]
        return type(element)(**{f.name: self.value(element, f) for f in fields})

    def value(self, element: Element, field: dataclasses.Field):
        value, unit = getattr(element, field.name), field.metadata.get("unit", "")
        if isinstance(value, Expression):
            linear, _, angular = unit.partition(" | ")
            turns = bool(angular) and getattr(element, "free_unit", "m") == "rad"
            unit = angular if turns else linear
            unit = element.unit if isinstance(element, planar.UserConstraint) else unit
            if isinstance(element, planar.Stop) and field.name == "stiffness":
                power = float(element.exponent.sx) if element.exponent.sx.is_constant() else 1.5
                return self.formula(value, "N") * self.units.length**-power
            if unit == "N/m^n":
                power = 1.5
                return self.formula(value, "N") * self.units.length**-power
            return self.formula(value, unit)
        if isinstance(value, BodyElement):
            return self.bodies[value.name]
        if isinstance(value, planar.Point):
            return self.point(value)
        if isinstance(value, tuple):
            return tuple(self.point(point) for point in value)
        if isinstance(value, (Constraint, Beam)):
            return self.converted.elements[value.name]
        if isinstance(value, Law):
            return self.formula(Expression(value.value(t.sx)), element.units()[0])
        if isinstance(value, Component):
            return type(value)(**{f.name: self.value(value, f) for f in dataclasses.fields(value)})
        if isinstance(value, Curve):
            x, y, *z = map(Expression, ca.vertsplit(self.units.length * value.position(u.sx)))
            return FormulaCurve(x, y, *value.interval(), value.closed, *z)
        if callable(value) and isinstance(element, SpringDamper):
            s, f = self.units(element.coordinate_unit), self.units(element.force_unit)
            return lambda stretch, rate: f * value(stretch / s, rate * (self.units.time / s))
        return value
