"""Blocks of a structure: elements of one kind, collected from its description."""

from __future__ import annotations

from collections.abc import Iterable, Set
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.element_set import Elements
from dalembert.elements.fem.energies import CHANGES
from dalembert.elements.fem.graphs import graphs_of
from dalembert.elements.fem.node import Node
from dalembert.errors import ModelError
from dalembert.model.assembled.evaluation.block import ElementBlock, ElementKind
from dalembert.model.assembled.evaluation.numbering import Numbering
from dalembert.model.spans import Spans
from dalembert.model.supports_and_loads import SupportsAndLoads
from dalembert.symbolic.formulas.expression import Expression, free_symbols, stack, t
from dalembert.symbolic.parametric_array import ArrayEntries


@dataclass(frozen=True)
class Part:
    """An element or set of elements, with the numbering of the structure.

    Attributes
    ----------
    nodes : (ne, nodes of an element)
    count : number of elements of a set; None for a single element
    quantities : field → formula for all, or array with one value per element
    timed : whether the quantities may depend on time
    """

    name: str
    cls: type[StructuralElement]
    options: dict[str, Any]
    nodes: np.ndarray
    count: int | None
    quantities: dict[str, Any]
    timed: bool = False

    @classmethod
    def of(cls, element: StructuralElement | Elements, numbers: Spans) -> Part:
        """The part of an element or set of elements."""
        if isinstance(element, Elements):
            nodes = numbers.first(element.nodes.name) + element.nodes.index[element.cells]
            quantities = element.numbers
            return cls(element.name, element.cls, element.options, nodes, len(element), quantities)
        nodes = np.array([[numbers.first(node.name) for node in element.nodes()]])
        quantities = {f.name: getattr(element, f.name) for f in element.quantity_fields()}
        return cls(element.name, type(element), element.options(), nodes, None, quantities)


class BlockMaker:
    """Blocks of a structure's elements.

    Attributes
    ----------
    tied, turning : (nodes,) whether any element connects the node, has rotations of it
    """

    def __init__(self, structure: SupportsAndLoads, p: ca.SX, linear: bool):
        self.structure, self.p, self.linear = structure, p, linear
        self._names = {symbol.name() for symbol in ca.vertsplit(p)}
        count = len(structure.numbers)
        self.tied, self.turning = np.zeros(count, dtype=bool), np.zeros(count, dtype=bool)
        self._groups: dict[tuple, list[Part]] = {}
        element: Any
        for element in structure.elements.values():
            part = Part.of(element, structure.numbers)
            key = (part.cls, part.nodes.shape[1], *part.options.items())
            self._groups.setdefault(key, []).append(part)
            self.tied[part.nodes] = True
            self.turning[part.nodes] |= part.cls.turns
        self._coordinates = self._places()

    def _places(self) -> ArrayEntries:
        """Coordinates of all nodes, node by node."""
        d = self.structure.dimension
        entries = ArrayEntries(len(self.structure.numbers) * d)
        for node in self.structure.nodes.values():
            first = self.structure.numbers.first(node.name) * d
            if isinstance(node, Node):
                entries.add(first + np.arange(d), list(node.position))
            else:
                entries.add(first + np.arange(node.points.size), node.points.ravel())
            self._check(entries.formulas, f"{node.name}.position")
        return entries

    def blocks(self, degrees: Numbering) -> list[ElementBlock]:
        """Blocks, one per kind of element."""
        return [self.block(parts, degrees) for parts in self._groups.values()]

    def heated(
        self, number: int, degrees: Numbering, changes: dict[str, dict[str, Any]]
    ) -> ElementBlock | None:
        """Thermal terms of a block, by its number; None without temperature changes.

        Parameters
        ----------
        changes : name of an element or set → quantity → change in addition to its own
        """
        parts = list(self._groups.values())[number]
        own = [part.quantities.get(name) for part in parts for name in CHANGES]
        changes_of_parts = [changes.get(part.name, {}) for part in parts]
        if not any(changes_of_parts) and all(value is None or _zero(value) for value in own):
            return None
        return self.block(parts, degrees, changes)

    def block(
        self,
        parts: list[Part],
        degrees: Numbering,
        changes: dict[str, dict[str, Any]] | None = None,
    ) -> ElementBlock:
        """Block of elements of one kind, or of their thermal terms."""
        cls: Any = parts[0].cls
        options = tuple(parts[0].options.items())
        nodes, names = np.concatenate([part.nodes for part in parts]), Spans()
        thermal, space = changes is not None, self.structure.dimension
        setting = nodes.shape[1], options, self.linear, thermal
        kind = ElementKind(graphs_of(cls, space, *setting))  # type: ignore[arg-type]
        for part in parts:
            names.add(part.name, part.count)
        table = degrees.table[nodes][:, :, : kind.per_node].reshape(nodes.shape[0], -1)
        data = self._data(kind, parts, nodes, changes or {}).array(self.p)
        return ElementBlock(kind, names, nodes.T, table.T.copy(), data)

    def _data(
        self, kind: ElementKind, parts: Iterable[Part], nodes: np.ndarray, changes: dict
    ) -> ArrayEntries:
        """Coordinates of the nodes, then quantities, element by element."""
        d, count = self.structure.dimension, nodes.shape[0]
        entries = ArrayEntries(kind.data_count * count)
        sources = (nodes[:, :, None] * d + np.arange(d)).reshape(count, -1)
        starts = kind.data_count * np.arange(count)
        rows = np.arange(sources.shape[1])
        entries.copy(self._coordinates, sources.ravel(), (starts[:, None] + rows).ravel())
        begin = 0
        for part in parts:
            row, end = rows.size, begin + part.nodes.shape[0]
            for field in part.cls.quantity_fields():
                size = field.metadata["size"]
                places = starts[begin:end, None] + row + np.arange(size)
                names, entity = {"t"} if part.timed else set(), f"{part.name}.{field.name}"
                self._add(entries, places, part.quantities[field.name], entity, names)
                more = changes.get(part.name, {}).get(field.name)
                if more is not None:
                    self._add(entries, places, more, f"heat {entity}", {"t"})
                row += size
            begin = end
        return entries

    def _add(
        self,
        into: ArrayEntries,
        places: np.ndarray,
        value: Any,
        entity: str,
        names: Set[str] = frozenset(),
    ) -> None:
        """Add a quantity: one value for all elements, or an array with one per element."""
        before = len(into.formulas)
        for k in range(places.shape[1]):
            if isinstance(value, Expression):
                into.add(places[:, k], value[k])
            else:
                into.add(places[:, k], value.reshape(places.shape)[:, k])
        self._check(into.formulas[before:], entity, names)

    def _check(self, formulas: list[ca.SX], entity: str, names: Set[str] = frozenset()) -> None:
        foreign = {name for formula in formulas for name in free_symbols(formula)}
        if "t" in self._names and formulas and ca.depends_on(stack(formulas), t.sx):
            raise ModelError("depends on time, but 't' is a parameter here; rename it", entity)
        foreign -= self._names | names
        if foreign:
            raise ModelError(f"depends on {', '.join(sorted(foreign))}, no parameters here", entity)


def _zero(value: Any) -> bool:
    """Whether a quantity is zero everywhere."""
    if isinstance(value, Expression):
        return bool(value.sx.is_zero())
    return value.dtype.kind == "f" and not value.any()
