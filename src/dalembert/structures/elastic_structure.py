"""Structures as elements of mechanisms: every node is a body that joints and forces hold on.

Strain and kinetic energies are those of the finite elements, at displacements of any size; what a
node is displaced by is where its body went. Many nodes make a large model: see ``FlexibleBody`` for
the few shapes that matter.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.base import (
    ForceElement,
    Look,
    Powers,
    Rate,
    option,
    quantity,
)
from dalembert.elements.coordinates import Coordinates
from dalembert.elements.look import Strand
from dalembert.elements.planar import node as planar
from dalembert.elements.spatial import node as spatial
from dalembert.errors import ModelError, UnsupportedError
from dalembert.structures.base import StructuralElement
from dalembert.structures.blocks import Part
from dalembert.structures.cell_functions import CellFunctions
from dalembert.structures.cells import CELLS
from dalembert.structures.continuum import Continuum
from dalembert.structures.description import StructureDescription
from dalembert.structures.graphs import ElementGraphs
from dalembert.structures.node import Node
from dalembert.symbolic.expression import Expression, as_sx


@dataclass(frozen=True, eq=False)
class Cell:
    """One finite element between bodies.

    Attributes
    ----------
    name : of the element, within the structure
    functions : of its kind
    nodes : numbers of its nodes
    u : displacements of its nodes
    data : coordinates of its nodes, then its numbers
    """

    name: str
    functions: CellFunctions
    nodes: np.ndarray
    u: ca.SX
    data: ca.SX


@dataclass(eq=False)
class ElasticStructure(ForceElement):
    """A structure with all its nodes, which stands free of stress where it is drawn at the start.

    What holds and loads it are joints and forces of the mechanism, on ``node("A")``.

    Parameters
    ----------
    structure : nodes and elements; its formulas are of parameters of the mechanism
    velocity : of the whole at the start [m/s]
    angular_velocity : about the origin at the start, in the plane [rad/s]

    Raises
    ------
    ModelError
        The structure has supports, loads or parameters of its own.
    UnsupportedError
        Elements of one dimension, or that turn nodes in space.
    """

    structure: StructureDescription = option("nodes and elements", keyword=True)
    velocity: Any = option("of the whole at the start [m/s]", default=None, keyword=True)
    angular_velocity: Any = quantity("rad/s", "about the origin", default=0.0, keyword=True)
    conservative = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self._check()
        self.dimension = self.structure.dimension
        self.parts_of_structure = [
            Part.of(given, self.structure.numbers) for given in self.structure.elements.values()
        ]
        self.places = ca.horzcat(*self._places())
        self.bodies = self._made_bodies()

    def _check(self) -> None:
        s = self.structure
        if not isinstance(s, StructureDescription) or not s.elements:
            raise ModelError(f"structure must be a Structure with elements; got {s!r}", self.name)
        held = {"supports": s.supports or s.fixed, "loads": s.loads or s.spread or s.temperatures}
        for what, given in held.items():
            if given:
                raise ModelError(
                    f"its structure has {what} of its own; give the mechanism joints and forces "
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
        """(d,) where each node is free of stress."""
        for node in self.structure.nodes.values():
            if isinstance(node, Node):
                yield node.position.sx
            else:
                yield from (as_sx(list(row)) for row in node.points)

    def _made_bodies(self) -> list[Any]:
        turning = np.zeros(self.places.shape[1], dtype=bool)
        for part in self.parts_of_structure:
            turning[part.nodes] |= part.cls.turns
        if self.dimension == 3 and turning.any():
            raise UnsupportedError(
                f"{self.name}: elements that turn nodes in space are not part of mechanisms yet; "
                "use spatial.Beam"
            )
        kinds = planar if self.dimension == 2 else spatial
        found = []
        for name, place, turns in zip(
            self._names(), ca.horzsplit(self.places), turning, strict=True
        ):
            kind = kinds.Node if turns else kinds.PointNode
            angle = {"angle": 0.0} if turns else {}
            spin = {"angular_velocity": self.angular_velocity} if turns else {}
            found.append(
                kind(
                    f"{self.name}.{name}",
                    position=Expression(place),
                    velocity=self._velocity_at(place),
                    **angle,
                    **spin,
                )
            )
        return found

    def _velocity_at(self, place: ca.SX) -> Expression:
        given = ca.SX.zeros(self.dimension) if self.velocity is None else as_sx(self.velocity)
        if self.dimension == 2:
            given = given + self.angular_velocity.sx * ca.vertcat(-place[1], place[0])
        return Expression(given)

    def _names(self) -> list[str]:
        """Those of single nodes, and of sets with their number behind."""
        found = []
        for name, node in self.structure.nodes.items():
            found += [name] if isinstance(node, Node) else [f"{name}{k}" for k in node.index]
        return found

    def node(self, name: str | Node, number: int | None = None) -> Any:
        """The body of a node, or of one of a set by its number."""
        known = name.name if isinstance(name, Node) else name
        wanted = f"{self.name}.{known}{'' if number is None else number}"
        for body in self.bodies:
            if body.name == wanted:
                return body
        raise ModelError(f"has no node {wanted.removeprefix(self.name + '.')!r}", self.name)

    def own_coordinates(self) -> list[Coordinates]:
        return list(self.bodies)

    def parts(self) -> list[Coordinates]:
        return list(self.bodies)

    # elements ---------------------------------------------------------------------------------
    @cached_property
    def cells(self) -> list[Cell]:
        """Every finite element."""
        kinds: dict[tuple, CellFunctions] = {}
        found = []
        for part in self.parts_of_structure:
            key = (part.cls, part.nodes.shape[1], *part.options.items())
            if key not in kinds:
                count = part.nodes.shape[1]
                graphs = ElementGraphs(part.cls, self.dimension, count, part.options)
                kinds[key] = CellFunctions(graphs)
            for row, nodes in enumerate(part.nodes):
                moved = [self._displacement(k, part.cls.turns) for k in nodes]
                numbers = [self._number(part, f.name, row) for f in part.cls.quantity_fields()]
                data = ca.vertcat(*(self.places[:, int(k)] for k in nodes), *numbers)
                name = part.name if part.count is None else f"{part.name}{row}"
                found.append(Cell(name, kinds[key], nodes, ca.vertcat(*moved), data))
        return found

    def _displacement(self, k: int, turns: bool) -> ca.SX:
        body = self.bodies[k]
        moved = body.pose[: self.dimension] - self.places[:, int(k)]
        return ca.vertcat(moved, body.pose[2]) if turns else moved

    @staticmethod
    def _number(part: Part, name: str, row: int) -> ca.SX:
        given = part.quantities[name]
        if isinstance(given, Expression):
            return given.sx
        return as_sx(np.atleast_1d(np.asarray(given)[row]).tolist())

    def powers(self, rate: Rate) -> Powers:
        found = []
        for cell in self.cells:
            _, slope = cell.functions.stored(cell.u, cell.data)
            found.append((rate(cell.u), -slope))
        return found

    def potential(self) -> ca.SX:
        stored = (cell.functions.stored(cell.u, cell.data)[0] for cell in self.cells)
        return sum(stored, ca.SX(0))

    def inertial_powers(self, rate: Rate) -> Powers:
        found = []
        for cell in self.cells:
            if cell.functions.massless:
                continue
            speed = rate(cell.u)
            force = cell.functions.inertia(cell.u, speed, rate(speed), cell.data)
            found.append((speed, force))
        return found

    def masses(self) -> list[tuple[ca.SX, ca.SX]]:
        found: list[tuple[ca.SX, ca.SX]] = []
        for cell in self.cells:
            shares = cell.functions.shares(cell.data)
            places = [self.bodies[k].pose[: self.dimension] for k in cell.nodes]
            found += zip(places, ca.vertsplit(shares), strict=True)
        return found

    def measures(self, rate: Rate) -> dict[str, tuple[ca.SX, str]]:
        found = {"strain_energy": (self.potential(), "J")}
        for cell in self.cells:
            graphs = cell.functions.graphs
            if cell.name in self.structure.elements:
                for name, (_, unit) in graphs.measures.items():
                    value = cell.functions.measure(name)(cell.u, cell.data)
                    found[f"{cell.name}.{name}"] = (value, unit)
        return found

    def look(self) -> list[Look]:
        """Edges of the elements, each once."""
        edges: dict[tuple[int, int], None] = {}
        for cell in self.cells:
            nodes = [int(k) for k in cell.nodes]
            for face in outlines(cell.functions.graphs.cls):
                ring = [nodes[k] for k in (*face, face[0])]
                edges |= {(min(p), max(p)): None for p in pairwise(ring) if p[0] != p[1]}
        return [Strand(self.bodies[i].center, self.bodies[j].center) for i, j in sorted(edges)]


def outlines(cls: type[StructuralElement]) -> tuple[tuple[int, ...], ...]:
    """Faces of a cell, node by node around each; of a line itself."""
    if not issubclass(cls, Continuum):
        return (tuple(range(cls.node_count)),)
    shape = cls.cell.dimension, cls.node_count
    return next(cell.faces for cell in CELLS.values() if (cell.dimension, cell.nodes) == shape)
