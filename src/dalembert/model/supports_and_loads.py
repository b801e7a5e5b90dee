"""Description of a structure: supports and loads, checked on input."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.fem.node import ROTATIONS, Node
from dalembert.elements.fem.sets import Elements, Nodes
from dalembert.errors import ModelError
from dalembert.model.assembled.loads.load_records import (
    LineLoad,
    Load,
    Spread,
    Weight,
    check_expansion,
    elements_of,
    heating,
    lines,
    tractions,
)
from dalembert.model.parts import StructureParts
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression

UNITS = {"u": "m", "r": "rad", "v": "m/s", "vr": "rad/s", "f": "N", "m": "N m"}
"""First letters of a direction → unit of the prescribed quantity."""


class StructureDescription(StructureParts):
    """Nodes, elements between them, supports and loads; base of the builder.

    Every number may be a formula of parameters.

    Parameters
    ----------
    name : str
    description : str
    """

    def __init__(self, name: str, description: str = ""):
        super().__init__(name, description)
        self.supports: dict[tuple[str, str], Expression] = {}
        self.fixed: list[str] = []
        self.loads: dict[str, list[Load]] = {}
        self.spread: dict[str, list[Spread]] = {}
        self.temperatures: dict[str, dict[str, dict[str, Any]]] = {}
        self.initials: dict[str, list[Load]] = {"displacement": [], "velocity": []}

    def support(self, node: Node | Nodes, **displacements) -> None:
        """Prescribe displacements of nodes, e.g. ``ux=0, uy=0.01`` [m], ``rz=0`` [rad].

        By default all displacements are zero. For a set of nodes a value is for all, or an array
        has one value per node.

        Raises
        ------
        ModelError
            An unknown direction, or a displacement already prescribed with another value.
        """
        directions, names = self._directions(node), self._names(node)
        if not displacements:
            self.fixed += names
        for direction, value in displacements.items():
            self._check_direction(node, direction, directions)
            for name, displacement in zip(names, self._each(node, value), strict=True):
                expression = as_expression(
                    displacement, f"support {name}.{direction}", UNITS[direction[0]]
                )
                self._prescribe(name, direction, expression)

    def gravity(self, *acceleration, case: str = "") -> None:
        """Load the masses of all elements by gravity, e.g. ``gravity(0, -9.81)`` [m/s²].

        Raises
        ------
        ModelError
            Not one number per dimension.
        """
        field = self._vector("gravity", acceleration, "m/s^2")
        self.spread.setdefault(case, []).append(Weight(field))

    def line_load(self, parts, case: str = "", qx=0.0, qy=0.0, qz=0.0) -> None:
        """Load bars and beams by forces per length [N/m], in global directions.

        Parameters
        ----------
        parts : an element, a set of elements, or several of them
        """
        d, components = self.dimension, (qx, qy, qz)
        for axis, value in zip("xyz"[d:], components[d:], strict=True):
            if isinstance(value, Expression) or value != 0.0:
                raise ModelError(f"there is no direction {axis} in {d} dimension(s)", "line_load")
        force = self._vector("line_load", components[:d], "N/m")
        self.spread.setdefault(case, []).append(LineLoad(lines(parts), force))

    def heat(self, parts, case: str = "", **changes) -> None:
        """Change the temperature of elements in a load case, in addition to their own change.

        Parameters
        ----------
        parts : an element, a set of elements, or several of them
        **changes : ``temperature`` [K]; for frames ``temperature_gradient`` [K/m], in space
            ``temperature_gradient_y`` and ``_z``; for all elements, or an array with one value each

        Raises
        ------
        ModelError
            Elements without this quantity, or a change given twice.
        """
        changes_of_case = self.temperatures.setdefault(case, {})
        for part in elements_of(parts, "heat"):
            if self.elements.get(part.name) is not part:
                raise ModelError("is no element of this structure", part.name)
            for name, value in heating(part, changes).items():
                if name in changes_of_case.setdefault(part.name, {}):
                    raise ModelError(f"is given twice in load case {case!r}", f"{part.name}.{name}")
                changes_of_case[part.name][name] = value
        check_expansion(elements_of(parts, "heat"))

    def traction(self, elements: Elements, nodes: Nodes, case: str = "", **values) -> None:
        """Load edges or faces of cells by a traction ``tx, ty, tz`` or a ``pressure`` [Pa].

        A dead load: it keeps its direction as the structure moves. Pressure pushes against the
        material.

        Parameters
        ----------
        elements : set of continuum elements
        nodes : facets with all their nodes in this set are loaded

        Raises
        ------
        ModelError
            No facet has all its nodes there, or the elements have no facets.
        """
        self._check_nodes(nodes)
        name = f"traction{sum(len(s) for s in self.spread.values()) + 1}"
        load = tractions(name, elements, nodes, values)
        self.spread.setdefault(case, []).append(load)

    def load(self, node: Node | Nodes, case: str = "", fixed_axes: bool = False, **forces) -> None:
        """Add forces and moments at nodes, e.g. ``fx=10, fy=-3`` [N], ``mz=2`` [N m].

        Loads at one node add up. For a set of nodes a value acts at each of them, or an array has
        one value per node.

        Parameters
        ----------
        case : name of the load case
        fixed_axes : moments in space act about fixed axes, ``Mᵀ δθ`` with the spin ``δθ`` of the
            node, instead of on the components of its rotation vector; for small rotations and in
            the plane both are the same
        """
        if not isinstance(fixed_axes, bool):
            raise ModelError(f"fixed_axes is {fixed_axes!r}; give True or False", node.name)
        directions = {d.replace("u", "f").replace("r", "m"): d for d in self._directions(node)}
        if not forces:
            raise ModelError(f"gets no load; give one of {', '.join(directions)}", node.name)
        for direction, value in forces.items():
            self._check_direction(node, direction, directions)
            motion = directions[direction]
            entity = f"load {node.name}.{direction}"
            if isinstance(value, Expression) or np.ndim(value) != 1:
                value = as_expression(value, entity, UNITS[direction[0]])
            else:
                values = self._each(node, value)
                value = [as_expression(v, entity, UNITS[direction[0]]) for v in values]
            fixed = fixed_axes and motion in ROTATIONS[3] and self.dimension == 3
            load = Load(self._numbers(node), motion, value, entity, fixed)
            self.loads.setdefault(case, []).append(load)

    def initial(self, node: Node | Nodes, **motion) -> None:
        """Prescribe initial displacements or velocities of a motion, e.g. ``ux=0.01, vy=2``.

        Translations are ``ux``, ``uy``, ``uz`` [m] and ``vx``, ``vy``, ``vz`` [m/s], rotations
        ``rz`` [rad] and ``vrz`` [rad/s]. The default is zero. For a set of nodes a value is for
        all, or an array has one value per node.
        """
        directions = self._directions(node)
        velocities = {f"v{d.removeprefix('u')}": d for d in directions}
        for name, value in motion.items():
            self._check_direction(node, name, (*directions, *velocities))
            entity = f"initial {node.name}.{name}"
            unit = UNITS[name[:2] if name.startswith("vr") else name[0]]
            values = [as_expression(v, entity, unit) for v in self._each(node, value)]
            kind = "velocity" if name in velocities else "displacement"
            direction = velocities.get(name, name)
            self.initials[kind].append(Load(self._numbers(node), direction, values, entity))

    def _prescribe(self, name: str, direction: str, value: Expression) -> None:
        present = self.supports.setdefault((name, direction), value)
        if present is not value and not ca.is_equal(present.sx, value.sx, 1):
            raise ModelError(
                f"{direction} is prescribed twice, {present.sx} and {value.sx}; support it once",
                f"support {name}",
            )
