"""Supports, loads and initial conditions of nodes as joints, drivers and forces of a mechanism."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements import planar, spatial
from dalembert.elements.base import Element
from dalembert.elements.fem.element_set import Elements
from dalembert.elements.fem.nodal import ROTATIONS, TRANSLATIONS, effort, missing_rotation
from dalembert.errors import ModelError
from dalembert.model.load_records import LineLoad, Load, Weight
from dalembert.model.supports_and_loads import SupportsAndLoads
from dalembert.symbolic.formulas.expression import Expression

Values = dict[str, dict[str, Expression]]
"""Node → direction → value."""


class MechanismConditions:
    """Conditions of a model whose nodes are bodies.

    Parameters
    ----------
    system : builder

    Raises
    ------
    ModelError
        A load case or a line load, which mechanisms do not have.
    """

    def __init__(self, system: SupportsAndLoads):
        self.system = system
        cases = [c for c in (*system.loads, *system.spread, *system.temperatures) if c]
        if cases:
            raise ModelError(
                f"load case {cases[0]!r}: a mechanism has one set of loads; give them without case",
                system.name,
            )
        self.spread = system.spread.get("", [])
        if any(isinstance(load, LineLoad) for load in self.spread):
            raise ModelError(
                "is not available in mechanisms; load the nodes by load(...)", "line_load"
            )

    @property
    def gravity(self) -> Expression | None:
        """Sum of the fields of gravity."""
        fields = [load.acceleration for load in self.spread if isinstance(load, Weight)]
        if not fields:
            return None
        size = len(fields[0])
        if size not in (2, 3) or any(len(field) != size for field in fields):
            raise ModelError("needs 2 numbers in the plane, 3 in space", "gravity")
        columns = [ca.vertcat(*(a.sx for a in field)) for field in fields]
        return Expression(sum(columns[1:], columns[0]), "gravity", "m/s^2")

    def elements(self) -> dict[str, Element]:
        """Elements of the system with changed temperatures, tractions, supports and loads."""
        elements = dict(self.system.elements)
        for name, changes in self.system.temperatures.get("", {}).items():
            elements[name] = _heated(elements[name], changes)
        tractions = (load for load in self.spread if isinstance(load, Elements))
        for element in (*tractions, *self.supports(), *self.loads()):
            if element.name in elements:
                raise ModelError(
                    "the name is that of a support or load; choose a different one", element.name
                )
            elements[element.name] = element
        return elements

    # supports --------------------------------------------------------------------------------
    def supports(self) -> Iterator[Element]:
        """Pins, clamps and drivers; displacements that are not zero are drivers.

        Raises
        ------
        ModelError
            A displacement that the node does not have, or rotations in space prescribed alone.
        """
        values: Values = {}
        for (name, direction), value in self.system.prescribed(self._directions).items():
            values.setdefault(name, {})[direction] = value
        for name, displacements in values.items():
            yield from self._support(self.system.node_body(name), displacements)

    def _directions(self, name: str) -> tuple[str, ...]:
        """Directions of the displacements of a node."""
        node = self.system.node_body(name)
        return TRANSLATIONS[: node.dimension] + (ROTATIONS[node.dimension] if node.rotates else ())

    def _nodes(self, section: str, values: Values) -> Iterator[tuple[Any, dict[str, Expression]]]:
        """Nodes with their values, which they must have directions for."""
        for name, directed in values.items():
            for direction in directed:
                if direction not in self._directions(name):
                    condition = effort(direction) if section == "load" else direction
                    raise missing_rotation(condition, f"{section} {name}")
            yield self.system.node_body(name), directed

    def _support(self, node: Any, values: dict[str, Expression]) -> Iterator[Element]:
        directions = self._directions(node.name)
        name = f"{identifier(node.name)}_support"
        fixed = set(values) == set(directions) and all(v.sx.is_zero() for v in values.values())
        ground, d = self.system.ground, node.dimension
        point = ground.point(*(Expression(node.natural[k]) for k in range(d)))
        rotations = [direction for direction in values if direction in ROTATIONS[3]]
        if fixed and d == 2:
            yield (planar.Weld if node.rotates else planar.Revolute)(name, point, node.center)
        elif fixed and not node.rotates:
            yield spatial.Spherical(name, point, node.center)
        elif fixed:
            place = tuple(point.local[k] for k in range(3))
            frame = ground.frame(place, rotation=node.initial[1])
            yield spatial.Weld(name, frame, node.frame())
        elif rotations and d == 3:
            raise ModelError(
                f"{node.name}: {rotations[0]} cannot be prescribed alone in space; hold all of "
                f"{', '.join(directions)} at zero, or use a joint or a RotationalDriver"
            )
        else:
            for direction, value in values.items():
                yield self._driver(f"{name}_{direction}", node, direction, value)

    def _driver(self, name: str, node: Any, direction: str, value: Expression) -> Element:
        """The constraint of one displacement to a value."""
        if direction == "rz":
            return planar.RotationalDriver(name, self.system.ground, node, law=value)
        kind = planar if node.dimension == 2 else spatial
        k = TRANSLATIONS.index(direction)
        axis = tuple(float(i == k) for i in range(node.dimension))
        law = Expression(node.natural[k]) + value
        return kind.CoordinateDriver(name, node.center, law=law, direction=axis)

    # loads -----------------------------------------------------------------------------------
    def loads(self) -> Iterator[Element]:
        """A force and a moment for each loaded node, about fixed axes."""
        for node, forces in self._nodes("load", self._sums(self.system.loads.get("", []))):
            kind, label = (planar if node.dimension == 2 else spatial), identifier(node.name)
            force, moment = (
                tuple(forces.get(f"{letter}{axis}", Expression(0.0)) for axis in "xyz")
                for letter in "ur"
            )
            if not all(component.sx.is_zero() for component in force):
                yield kind.Force(f"{label}_load", node.center, force[: node.dimension])
            if "rz" in forces and node.dimension == 2:
                yield planar.Torque(f"{label}_moment", node, moment[2])
            elif not all(component.sx.is_zero() for component in moment):
                yield spatial.Torque(f"{label}_moment", node, moment)

    def _sums(self, loads: list[Load]) -> Values:
        """Sum of the loads at each node."""
        sums: Values = {}
        for load in loads:
            for name, value in self._each(load):
                forces = sums.setdefault(name, {})
                present = forces.get(load.direction)
                forces[load.direction] = value if present is None else present + value
        return sums

    def _each(self, load: Load) -> Iterator[tuple[str, Expression]]:
        """Nodes of a load with their values."""
        uniform = not isinstance(load.value, list)
        values = [load.value] * load.nodes.size if uniform else load.value
        names = (self.system.numbers.name(int(number)) for number in load.nodes)
        return zip(names, values, strict=True)

    # initial conditions ----------------------------------------------------------------------
    def initial_conditions(self) -> list[tuple[Expression, Expression]]:
        """(measure, value) pairs at the start.

        Raises
        ------
        ModelError
            A motion that the node does not have, a prescribed one, one given twice, or an initial
            rotation in space.
        """
        conditions = list(self.system.initial_conditions)
        held = self.system.prescribed(self._directions)
        for kind, loads in self.system.initials.items():
            values: Values = {}
            for load in loads:
                for name, value in self._each(load):
                    motion = values.setdefault(name, {})
                    if (name, load.direction) in held:
                        raise ModelError(
                            f"{load.direction} is prescribed, so its motion is known; remove one "
                            "of them",
                            load.entity,
                        )
                    if motion.setdefault(load.direction, value) is not value:
                        raise ModelError("is given twice; give it once", load.entity)
            for node, motion in self._nodes("initial", values):
                conditions += [(_motion(node, kind, d), value) for d, value in motion.items()]
        return conditions


def _motion(node: Any, kind: str, direction: str) -> Expression:
    """A displacement or velocity of a node."""
    if direction in TRANSLATIONS:
        k = TRANSLATIONS.index(direction)
        sx = node.twist[k] if kind == "velocity" else node.place[k] - node.natural[k]
    elif kind == "velocity":
        sx = node.turning["xyz".index(direction[1])]
    elif node.dimension == 2:
        sx = node.turned_by
    else:
        raise ModelError(
            f"{direction}: an initial rotation is not available in space; use spatial.Node and its "
            "rotation",
            f"initial {node.name}",
        )
    return Expression(sx, f"{node.name}.{direction}")


def _heated(part: Any, changes: dict[str, Any]) -> Element:
    """A finite element or set with changes added to its temperatures."""
    if isinstance(part, Elements):
        return part.with_numbers({n: _sum(part.numbers[n], c) for n, c in changes.items()})
    return replace(part, **{n: getattr(part, n) + change for n, change in changes.items()})


def _sum(values: Any, changes: Any) -> Any:
    """Sum of quantities of a set of elements, each a formula for all or an array."""
    if isinstance(values, Expression) and isinstance(changes, Expression):
        return values + changes
    count = np.size(changes if isinstance(values, Expression) else values)
    columns = ([x] * count if isinstance(x, Expression) else list(x) for x in (values, changes))
    sums = [value + change for value, change in zip(*columns, strict=True)]
    return np.fromiter(sums, dtype=object, count=count)


def identifier(name: str) -> str:
    """A name of a node as part of a name in formulas: ``n[3]`` as ``n_3``."""
    return re.sub(r"\W+", "_", name).strip("_")
