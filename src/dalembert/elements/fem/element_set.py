"""Sets of elements of one class between nodes of a set: the cells of a mesh."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from copy import copy
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.fem.base import ElasticElement, StructuralElement, check_options
from dalembert.elements.fem.between_bodies import BetweenBodies
from dalembert.elements.fem.cell_functions import functions_of
from dalembert.elements.fem.node_set import Nodes
from dalembert.errors import ModelError
from dalembert.remedies import Advice, Insert
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression, as_sx


class Elements(ElasticElement):
    """Set of elements of one class between nodes of a set, returned by ``system.add_elements``.

    An element is called ``name[k]``, in formulas and messages, too.

    Parameters
    ----------
    name : str
    cls : class of the elements
    nodes : Nodes that the cells refer to
    cells : (count, nodes of an element) indices of the nodes
    **numbers : quantities and options of the class; a quantity is a number or formula for all, or
        an array with one per element
    """

    def __init__(
        self, name: str, cls: type[StructuralElement], nodes: Nodes, cells, **numbers: Any
    ):
        if not (isinstance(cls, type) and issubclass(cls, StructuralElement)):
            raise ModelError(f"a class of structural elements is needed, got {cls!r}", name)
        self.name, self.cls, self.nodes = name, cls, nodes
        self.cells = self._checked(cells)
        self.numbers = self._numbers(numbers)
        self.options = cls.default_options() | numbers
        unknown = sorted(set(numbers) - set(cls.default_options()))
        if unknown:
            known = [f.name for f in cls.quantity_fields()] + list(cls.default_options())
            raise ModelError(
                f"{cls.__name__} has no {', '.join(unknown)}; known: {', '.join(known)}", name
            )
        check_options(name, self.options)

    def with_numbers(self, numbers: dict[str, Any]) -> Elements:
        """The same elements with other values of some quantities."""
        changed = copy(self)
        vars(changed).pop("between", None)
        changed.numbers = self.numbers | numbers
        return changed

    def __len__(self) -> int:
        return int(self.cells.shape[0])

    @property
    def names(self) -> list[str]:
        """Names of the elements."""
        return [f"{self.name}[{k}]" for k in range(len(self))]

    @property
    def centres(self) -> np.ndarray:
        """(count, d) mean positions of their nodes [m]."""
        return self.nodes.positions[self.cells].mean(axis=1)

    # in a mechanism --------------------------------------------------------------------------
    @cached_property
    def between(self) -> list[BetweenBodies]:
        bodies = self.nodes.whole.bodies
        kind: Any = self.cls
        options, count = tuple(self.options.items()), self.cells.shape[1]
        functions = functions_of(kind, self.nodes.dimension, count, options)
        return [
            BetweenBodies(
                f"{self.name}[{k}]", functions, tuple(bodies[n] for n in nodes), self._row(k)
            )
            for k, nodes in enumerate(self.nodes.index[self.cells])
        ]

    def _row(self, k: int) -> ca.SX:
        """Quantities of one element, as a column."""
        values = (self.numbers[field.name] for field in self.cls.quantity_fields())
        return ca.vertcat(
            *(
                v.sx if isinstance(v, Expression) else as_sx(np.atleast_1d(v[k]).tolist())
                for v in values
            )
        )

    @property
    def members(self) -> dict[str, ElasticElement]:
        """Its elements by name."""
        return {element.name: ElementOfSet(element) for element in self.between}

    def checked_quantities(self) -> list[tuple[str, Expression, Mapping]]:
        def column(value: Any) -> Expression:
            uniform = isinstance(value, Expression)
            return value if uniform else Expression(as_sx(np.ravel(value).tolist()))

        return [
            (f"{self.name}.{f.name}", column(self.numbers[f.name]), f.metadata)
            for f in self.cls.quantity_fields()
        ]

    def _checked(self, connectivity: Any) -> np.ndarray:
        node_count = self.cls.node_count
        try:
            cells = np.asarray(connectivity)
        except ValueError:
            text = f"cells of {self.cls.__name__} must all have {node_count} nodes"
            raise ModelError(text, self.name) from None
        if self.nodes.dimension not in self.cls.dimensions:
            known = " or ".join(map(str, self.cls.dimensions))
            raise ModelError(
                f"{self.cls.__name__} needs nodes with {known} coordinates, "
                f"{self.nodes.name} has {self.nodes.dimension}",
                self.name,
            )
        if cells.ndim != 2 or cells.shape[1] != node_count or cells.dtype.kind not in "iu":
            raise ModelError(
                f"cells of {self.cls.__name__} must be whole numbers (count, {node_count}); got "
                f"shape {cells.shape}",
                self.name,
            )
        wrong = np.flatnonzero(((cells < 0) | (cells >= len(self.nodes))).any(axis=1))
        if wrong.size:
            raise ModelError(
                f"counts nodes {cells[wrong[0]].tolist()}, {self.nodes.name} has 0 to "
                f"{len(self.nodes) - 1}",
                f"{self.name}[{wrong[0]}]",
            )
        return cells.astype(int)

    def _numbers(self, numbers: dict[str, Any]) -> dict[str, Any]:
        """Field → formula for all, or array of numbers or formulas."""
        quantities: dict[str, Any] = {}
        for field in self.cls.quantity_fields():
            meta, entity = field.metadata, f"{self.name}.{field.name}"
            if field.name not in numbers and field.default is dataclasses.MISSING:
                text = f"is missing; give {field.name} = … [{meta['unit']}]"
                raise ModelError(Advice(text, [Insert()]), entity)
            value = numbers.pop(field.name, field.default)
            shape = np.shape(value) if not isinstance(value, Expression) else ()
            if shape[:1] == (len(self),) and shape != (meta["size"],):
                quantities[field.name] = self._each(value, entity, meta)
            else:
                quantities[field.name] = as_expression(value, entity, meta["unit"], meta["size"])
        return quantities

    def _each(self, value: Any, entity: str, meta: Any) -> np.ndarray:
        """A quantity per element, numbers or formulas."""
        array = np.asarray(value)
        if array.size != meta["size"] * len(self):
            raise ModelError(f"has shape {array.shape} for {len(self)} elements", entity)
        if array.dtype.kind in "iuf":
            return array
        values = list(array.ravel())
        unique = {id(v): v for v in values}  # a formula shared by elements is converted once
        expressions = {k: as_expression(v, entity, meta["unit"]) for k, v in unique.items()}
        column = [expressions[id(v)] for v in values]
        return np.fromiter(column, dtype=object, count=len(column)).reshape(array.shape)

    def __repr__(self) -> str:
        return f"<Elements {self.name!r}: {len(self)} {self.cls.__name__}>"


class ElementOfSet(ElasticElement):
    """One element of a set, with its measures."""

    def __init__(self, element: BetweenBodies):
        self.name, self._element = element.name, element

    @cached_property
    def between(self) -> list[BetweenBodies]:
        return [self._element]
