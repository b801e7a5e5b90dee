"""Structures as elements of mechanisms: every node is a body for joints and forces.

Strain and kinetic energies are those of the finite elements, at displacements of any size; the
displacement of a node is that of its body. Many nodes give a large model: see ``FlexibleBody`` for
models with few shapes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import (
    Condition,
    ForceElement,
    Look,
    Powers,
    Rate,
    option,
)
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.fem.between_bodies import BetweenBodies, NodeBody
from dalembert.elements.fem.cell_functions import functions_of
from dalembert.elements.fem.node import Node
from dalembert.elements.fem.sets import Nodes
from dalembert.elements.look import Strand
from dalembert.elements.planar import node as planar
from dalembert.elements.rotation import identity
from dalembert.elements.spatial import node as spatial
from dalembert.errors import ModelError, UnsupportedError
from dalembert.model.assembled.evaluation.blocks import Part
from dalembert.model.meshes.mesh import Mesh
from dalembert.model.supports_and_loads import StructureDescription
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, as_sx
from dalembert.text.wording import unknown


@dataclass(eq=False)
class ElasticStructure(ForceElement):
    """A structure with all its nodes as bodies, free of stress in its initial configuration.

    It is supported and loaded by joints and forces of the mechanism, on ``node("A")``.

    Parameters
    ----------
    structure : nodes and elements; their formulas use parameters of the mechanism
    velocity : initial velocity of the structure [m/s]
    angular_velocity : initial angular velocity about the origin, one number in the plane, three in
        space [rad/s]

    Raises
    ------
    ModelError
        The structure has supports, loads or parameters of its own.
    UnsupportedError
        Elements of one dimension.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar, structures
    >>> rod = da.Structure("rod")
    >>> a, b = rod.node("a", 0, 0), rod.node("b", 1, 0)
    >>> steel = dict(area=1e-4, modulus=2e11, density=7850.0)
    >>> element = rod.add(structures.Truss("rod", a, b, **steel))
    >>> system = da.System("free rod", gravity=(0, -9.81))
    >>> free = system.add(structures.ElasticStructure("part", structure=rod, velocity=(2.0, 0.0)))
    >>> motion = da.solve_dynamics(system.build(), 0.01, step=1e-3)
    >>> round(motion["kinetic_energy"][0].item(), 6)  # m v²/2
    1.57
    """

    structure: StructureDescription = option("nodes and elements", keyword=True)
    velocity: Any = option("of the whole at the start [m/s]", default=None, keyword=True)
    angular_velocity: Any = option("about the origin [rad/s]", default=None, keyword=True)
    conservative = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self._check()
        self.dimension = self.structure.dimension
        self._spin = self._initial_spin()
        self.parts_of_structure = [
            Part.of(element, self.structure.numbers) for element in self.structure.elements.values()
        ]
        self.places = ca.horzcat(*self._places())
        self.bodies = self._node_bodies()

    def _check(self) -> None:
        s = self.structure
        if not isinstance(s, StructureDescription) or not s.elements:
            raise ModelError(f"structure must be a Structure with elements; got {s!r}", self.name)
        own = {"supports": s.supports or s.fixed, "loads": s.loads or s.spread or s.temperatures}
        for kind, quantities in own.items():
            if quantities:
                raise ModelError(
                    f"its structure has {kind} of its own; give the mechanism joints and forces "
                    f"on {self.name}.node(...) instead",
                    self.name,
                )
        if s.parameters:
            raise ModelError(
                f"its structure has parameters of its own ({', '.join(s.parameters)}); declare "
                "them with system.parameter(...)",
                self.name,
            )
        if s.dimension == 1:
            raise UnsupportedError("structures of one dimension are not part of mechanisms")

    # nodes ------------------------------------------------------------------------------------
    def _places(self) -> Iterator[ca.SX]:
        """(d,) stress-free position of each node."""
        for node in self.structure.nodes.values():
            if isinstance(node, Node):
                yield node.position.sx
            else:
                yield from (as_sx(list(row)) for row in node.points)

    def _node_bodies(self) -> list[Any]:
        rotates = np.zeros(self.places.shape[1], dtype=bool)
        for part in self.parts_of_structure:
            rotates[part.nodes] |= part.cls.turns
        kinds = planar if self.dimension == 2 else spatial
        bodies = []
        for name, place, turns in zip(
            self._names(), ca.horzsplit(self.places), rotates, strict=True
        ):
            kind = kinds.ElementNode if turns else kinds.ElementPointNode
            start = self._initial_rotation if turns else {}
            bodies.append(
                kind(
                    f"{self.name}.{name}",
                    position=Expression(place),
                    velocity=self._velocity_at(place),
                    **start,
                )
            )
        return bodies

    def _initial_spin(self) -> Expression:
        """Initial angular velocity."""
        size = 1 if self.dimension == 2 else 3
        still: Any = 0.0 if size == 1 else (0.0,) * 3
        spin = still if self.angular_velocity is None else self.angular_velocity
        return as_expression(spin, f"{self.name}.angular_velocity", "rad/s", size)

    @property
    def _initial_rotation(self) -> dict[str, Any]:
        """Initial rotation of nodes with rotations."""
        still = {"angle": 0.0} if self.dimension == 2 else {"rotation": identity()}
        return {**still, "angular_velocity": self._spin}

    def _velocity_at(self, place: ca.SX) -> Expression:
        velocity = ca.SX.zeros(self.dimension) if self.velocity is None else as_sx(self.velocity)
        spin = self._spin.sx
        if self.dimension == 2:
            return Expression(velocity + spin * ca.vertcat(-place[1], place[0]))
        return Expression(velocity + ca.cross(spin, place))

    def _names(self) -> list[str]:
        """Names of single nodes, and of nodes of sets with their number appended."""
        names = []
        for name, node in self.structure.nodes.items():
            names += [name] if isinstance(node, Node) else [f"{name}{k}" for k in node.index]
        return names

    def node(self, name: str | Node, number: int | None = None) -> Any:
        """The body of a node, or of a node of a set by its number."""
        base = name.name if isinstance(name, Node) else name
        full_name = f"{base}{'' if number is None else number}"
        if full_name not in self.named_nodes:
            raise ModelError(unknown("node", full_name, self.named_nodes), self.name)
        return self.named_nodes[full_name]

    def at(self, nodes: Node | Nodes) -> list[NodeBody]:
        """The bodies of nodes of the structure."""
        first = self.structure.numbers.first(nodes.name)
        numbers = first + nodes.index if isinstance(nodes, Nodes) else [first]
        return [self.bodies[k] for k in numbers]

    @property
    def mesh(self) -> Mesh:
        """The only mesh of its structure.

        Raises
        ------
        ModelError
            No mesh, or several.
        """
        meshes = getattr(self.structure, "meshes", {})
        if len(meshes) != 1:
            raise ModelError(f"has {len(meshes)} meshes; get nodes from its structure", self.name)
        return next(iter(meshes.values()))

    @property
    def named_nodes(self) -> dict[str, NodeBody]:
        """Bodies by the names of their nodes."""
        return dict(zip(self._names(), self.bodies, strict=True))

    def where(
        self,
        condition: Callable[..., np.ndarray] | None = None,
        *,
        tolerance: float | None = None,
        **coordinates: float,
    ) -> list[NodeBody]:
        """The bodies of nodes with stress-free coordinates, e.g. ``x=0``, or where
        ``condition(x, y)`` is true.

        Raises
        ------
        ModelError
            No node fulfils the condition.
        """
        nodes = self._points.where(condition, tolerance=tolerance, **coordinates)
        return [self.bodies[k] for k in nodes.index]

    def nearest(self, *place: float) -> NodeBody:
        """The body of the node nearest to a point [m] in the stress-free configuration."""
        return self.bodies[self._points.nearest(*place).index[0]]

    @property
    def _points(self) -> Nodes:
        """All nodes."""
        points = [[Expression(x) for x in ca.vertsplit(p)] for p in ca.horzsplit(self.places)]
        return Nodes(self.name, np.array(points, dtype=object))

    def own_coordinates(self) -> list[Coordinates]:
        return list(self.bodies)

    def parts(self) -> list[Coordinates]:
        return list(self.bodies)

    # elements ---------------------------------------------------------------------------------
    @cached_property
    def cells(self) -> list[BetweenBodies]:
        """Every finite element."""
        cells = []
        for part in self.parts_of_structure:
            count, options = part.nodes.shape[1], tuple(part.options.items())
            kind: Any = part.cls
            functions = functions_of(kind, self.dimension, count, options)
            for row, nodes in enumerate(part.nodes):
                numbers = [self._number(part, f.name, row) for f in part.cls.quantity_fields()]
                name = part.name if part.count is None else f"{part.name}{row}"
                bodies = tuple(self.bodies[k] for k in nodes)
                cells.append(BetweenBodies(name, functions, bodies, ca.vertcat(*numbers)))
        return cells

    @staticmethod
    def _number(part: Part, name: str, row: int) -> ca.SX:
        values = part.quantities[name]
        if isinstance(values, Expression):
            return values.sx
        return as_sx(np.atleast_1d(np.asarray(values)[row]).tolist())

    def powers(self, rate: Rate) -> Powers:
        return [pair for cell in self.cells for pair in cell.powers(rate)]

    def potential(self) -> ca.SX:
        return sum((cell.stored for cell in self.cells), ca.SX(0))

    def inertial_powers(self, rate: Rate) -> Powers:
        return [pair for cell in self.cells for pair in cell.inertial_powers(rate)]

    def masses(self) -> list[tuple[ca.SX, ca.SX]]:
        return [share for cell in self.cells for share in cell.masses()]

    def conditions(self) -> list[Condition]:
        return [*super().conditions(), *(c for cell in self.cells for c in cell.conditions())]

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        measures = {"strain_energy": (self.potential(), "J")}
        for cell in self.cells:
            if cell.name in self.structure.elements:
                for name, value in cell.recovered().items():
                    measures[f"{cell.name}.{name}"] = value
        return measures

    def look(self) -> list[Look]:
        """Edges of the elements, each once."""
        edges = {frozenset((i.name, j.name)): (i, j) for c in self.cells for i, j in c.edges()}
        return [Strand(i.center, j.center) for i, j in edges.values()]
