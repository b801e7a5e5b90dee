"""Supports, loads and initial conditions of nodes of a model under construction."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.fem.between_bodies import NodeBody
from dalembert.elements.fem.nodal import ROTATIONS, TRANSLATIONS, effort, missing_rotation
from dalembert.elements.fem.node import Node
from dalembert.elements.fem.node_set import Nodes
from dalembert.errors import ModelError
from dalembert.model.load_records import Load
from dalembert.model.parts import Parts
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression
from dalembert.text.arguments import check_arguments

UNITS = {"u": "m", "r": "rad", "v": "m/s", "vr": "rad/s", "f": "N", "m": "N m"}
"""First letters of a direction → unit of the prescribed quantity."""
AnyNode = Node | Nodes | NodeBody
AnyNodes = AnyNode | Sequence[AnyNode]


class NodalConditions(Parts):
    """Parts with supports, loads and initial conditions of nodes.

    Parameters
    ----------
    name : str
    description : str

    Attributes
    ----------
    node_bodies : bodies that are nodes, with supports, loads or initial conditions
    supports : (node, direction) → prescribed displacement
    fixed : names of nodes all displacements of which are zero
    loads : load case → nodal loads
    initials : displacements and velocities of nodes at the start
    initial_conditions : measures of a mechanism at the start, with their values
    """

    def __init__(self, name: str, description: str = ""):
        super().__init__(name, description)
        self.node_bodies: dict[str, NodeBody] = {}
        self.supports: dict[tuple[str, str], Expression] = {}
        self.fixed: list[str] = []
        self.loads: dict[str, list[Load]] = {}
        self.initials: dict[str, list[Load]] = {"displacement": [], "velocity": []}
        self.initial_conditions: list[tuple[Expression, Expression]] = []

    def support(self, nodes: AnyNodes, **displacements) -> None:
        """Prescribe displacements of nodes, e.g. ``ux=0, uy=0.01`` [m], ``rz=0`` [rad].

        By default all displacements are zero. A value, which may be a formula of parameters and
        time, is for every node, or an array has one value per node of a set. In a mechanism the
        rotations of a node in space are held all together at zero, with all displacements, or free.

        Parameters
        ----------
        nodes : a node, a set or selection of nodes, or a list of these

        Raises
        ------
        ModelError
            An unknown direction, or a displacement already prescribed with another value.
        """
        for node in self._listed(nodes):
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

    def load(
        self, nodes: AnyNodes, case: str = "", fixed_axes: bool = False, **forces: Any
    ) -> None:
        """Add forces and moments at nodes, e.g. ``fx=10, fy=-3`` [N], ``mz=2`` [N m].

        Loads at one node add up. A value acts at every node, or an array has one value per node of
        a set.

        Parameters
        ----------
        nodes : a node, a set or selection of nodes, or a list of these
        case : name of the load case
        fixed_axes : moments in space act about fixed axes, ``Mᵀ δθ`` with the spin ``δθ`` of the
            node, instead of on the components of its rotation vector; for small rotations and in
            the plane both are the same; in mechanisms axes are always fixed
        """
        for node in self._listed(nodes):
            if not isinstance(fixed_axes, bool):
                raise ModelError(f"fixed_axes is {fixed_axes!r}; give True or False", node.name)
            directions = {effort(d): d for d in self._directions(node)}
            if not forces:
                raise ModelError(f"gets no load; give one of {', '.join(directions)}", node.name)
            for direction, value in forces.items():
                self._check_direction(node, direction, directions)
                motion = directions[direction]
                entity = f"load {node.name}.{direction}"
                fixed = fixed_axes and motion in ROTATIONS[3] and node.dimension == 3
                values = self._values_at(node, value, entity, UNITS[direction[0]])
                load = Load(self._numbers(node), motion, values, entity, fixed)
                self.loads.setdefault(case, []).append(load)

    @check_arguments
    def initial(self, what: AnyNodes | Expression, value: Any = None, **motion: Any) -> None:
        """Prescribe the start of a motion, exactly.

        Parameters
        ----------
        what : nodes, or a position-level measure or a speed of a mechanism
        value : of the measure; unlike the initial poses of bodies, assembly never changes it
        **motion : of nodes: displacements ``ux``, ``uy``, ``uz`` [m], ``rz`` [rad], velocities
            ``vx``, ``vy``, ``vz`` [m/s], ``vrz`` [rad/s]; zero by default. A value is for every
            node, or an array has one value per node of a set.

        Raises
        ------
        ModelError
            An unknown direction, a value without its direction, or a direction of a measure.
        """
        if isinstance(what, Expression):
            if value is None or motion:
                raise ModelError("a measure takes one value, initial(measure, value)", "initial")
            measure = as_expression(what, "initial condition", getattr(what, "unit", ""))
            self.initial_conditions.append((measure, as_expression(value, "initial value")))
            return
        for node in self._listed(what):
            directions = self._directions(node)
            velocities = {f"v{d.removeprefix('u')}": d for d in directions}
            if value is not None or not motion:
                accepted = ", ".join((*directions, *velocities))
                raise ModelError(f"gets no initial motion; give one of {accepted}", node.name)
            for name, number in motion.items():
                self._check_direction(node, name, (*directions, *velocities))
                entity = f"initial {node.name}.{name}"
                unit = UNITS[name[:2] if name.startswith("vr") else name[0]]
                values = [as_expression(v, entity, unit) for v in self._each(node, number)]
                kind = "velocity" if name in velocities else "displacement"
                direction = velocities.get(name, name)
                self.initials[kind].append(Load(self._numbers(node), direction, values, entity))

    def prescribed(
        self, directions: Callable[[str], Sequence[str]]
    ) -> dict[tuple[str, str], Expression]:
        """Prescribed displacements by node and direction.

        Parameters
        ----------
        directions : directions of the displacements that a node has

        Raises
        ------
        ModelError
            A displacement that a node does not have, or of a fixed node another than zero.
        """
        supports = dict(self.supports)
        for name, direction in supports:
            if direction not in directions(name):
                raise missing_rotation(direction, f"support {name}")
        for name in self.fixed:
            for direction in directions(name):
                value = supports.setdefault((name, direction), Expression(0.0))
                if not value.sx.is_zero():
                    raise ModelError(
                        f"is fixed, and {direction} is prescribed as {value.sx}; give one of them",
                        f"support {name}",
                    )
        return supports

    def node_body(self, name: str) -> Any:
        """The node of this name as a body."""
        if name in self.node_bodies:
            return self.node_bodies[name]
        owner, _, number = name.partition("[")
        node = self.nodes[owner]
        return node.whole.bodies[int(number[:-1])] if isinstance(node, Nodes) else node.body

    def _listed(self, nodes: Any) -> list[Any]:
        """Nodes, sets and selections of this model, from one of them or a list."""
        listed = list(nodes) if isinstance(nodes, (list, tuple)) else [nodes]
        for node in listed:
            self._check_nodes(node)
            if isinstance(node, NodeBody) and node.name not in self.node_bodies:
                self.node_bodies[node.name] = node
                self.numbers.add(node.name)
        return listed

    @staticmethod
    def _directions(node: AnyNode) -> tuple[str, ...]:
        """Directions of the displacements of nodes; rotations may depend on the elements."""
        rotates = getattr(node, "rotates", True) if isinstance(node, NodeBody) else True
        return TRANSLATIONS[: node.dimension] + (ROTATIONS[node.dimension] if rotates else ())

    @staticmethod
    def _names(node: AnyNode) -> list[str]:
        return node.names if isinstance(node, Nodes) else [node.name]

    def _numbers(self, node: AnyNode) -> np.ndarray:
        first = self.numbers.first(node.name)
        return first + node.index if isinstance(node, Nodes) else np.array([first])

    @staticmethod
    def _each(node: AnyNode, value: Any) -> Any:
        """One value per node."""
        count = len(node) if isinstance(node, Nodes) else 1
        if isinstance(value, Expression) or np.ndim(value) != 1:
            return [value] * count
        if len(value) != count:
            raise ModelError(f"has {count} node(s), got {len(value)} values", node.name)
        return value

    def _values_at(self, node: AnyNode, value: Any, entity: str, unit: str) -> Any:
        """A formula for all nodes, or a list with one per node."""
        if isinstance(value, Expression) or np.ndim(value) != 1:
            return as_expression(value, entity, unit)
        return [as_expression(v, entity, unit) for v in self._each(node, value)]

    @staticmethod
    def _check_direction(node: AnyNode, direction: str, known) -> None:
        if direction not in known:
            raise ModelError(
                f"{node.name}: unknown direction {direction!r}; known: {', '.join(known)}"
            )

    def _prescribe(self, name: str, direction: str, value: Expression) -> None:
        present = self.supports.setdefault((name, direction), value)
        if present is not value and not ca.is_equal(present.sx, value.sx, 1):
            raise ModelError(
                f"{direction} is prescribed twice, {present.sx} and {value.sx}; support it once",
                f"support {name}",
            )
