"""Sets of nodes and elements as arrays: the points and cells of a mesh, and selections of them."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np

from dalembert.elements.fem.base import StructuralElement, check_options
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression


class Nodes:
    """Set of nodes of a structure, returned by ``structure.add_nodes``.

    A node is called ``name[k]``, in formulas and messages, too.

    Parameters
    ----------
    name : str
    points : (count, d) coordinates [m], numbers or formulas
    index : (k,) the selected nodes, by default all
    """

    def __init__(self, name: str, points, index: np.ndarray | None = None):
        self.name = name
        self.points = self._checked(points) if index is None else points
        self.index = np.arange(len(self.points)) if index is None else index

    @property
    def dimension(self) -> int:
        """Number of coordinates."""
        return int(self.points.shape[1])

    @property
    def names(self) -> list[str]:
        """Names of the selected nodes."""
        return [f"{self.name}[{k}]" for k in self.index]

    @property
    def positions(self) -> np.ndarray:
        """(k, d) coordinates of the selected nodes; formulas are NaN."""
        selected = self.points[self.index]
        if selected.dtype != object:
            return selected
        numbers = [[_number(c) for c in row] for row in selected]
        return np.array(numbers, dtype=float).reshape(selected.shape)

    def __len__(self) -> int:
        return int(self.index.size)

    def __getitem__(self, which) -> Nodes:
        """Selection of these nodes by number, slice or mask."""
        try:
            return Nodes(self.name, self.points, np.atleast_1d(self.index[which]))
        except IndexError:
            raise ModelError(f"has {len(self)} nodes; there is no {which!r}", self.name) from None

    def where(
        self,
        condition: Callable[..., np.ndarray] | None = None,
        *,
        tolerance: float | None = None,
        **coordinates: float,
    ) -> Nodes:
        """Nodes at coordinates, e.g. ``x=0``, or where ``condition(x, y)`` is true.

        Parameters
        ----------
        condition : function of the coordinate arrays to an array of truth values
        tolerance : distance from the coordinates; by default 1e-9 of the extent [m]
        **coordinates : x, y, z

        Raises
        ------
        ModelError
            No node fulfils the condition.
        """
        positions = self.positions
        if tolerance is None:
            tolerance = 1e-9 * float(np.ptp(positions, axis=0).max(initial=0.0))
        mask = np.ones(len(self), dtype=bool)
        for axis, value in coordinates.items():
            if axis not in "xyz"[: self.dimension]:
                raise ModelError(f"has no coordinate {axis!r}", self.name)
            mask &= np.abs(positions[:, "xyz".index(axis)] - value) <= tolerance
        if condition is not None:
            values = np.asarray(condition(*positions.T), dtype=bool)
            if values.shape not in ((), mask.shape):
                raise ModelError(
                    f"the condition gives shape {values.shape}; it needs one truth value for each "
                    f"of {len(self)} nodes",
                    self.name,
                )
            mask &= values
        if not mask.any():
            wanted = ", ".join(f"{a} = {v:g}" for a, v in coordinates.items())
            raise ModelError(f"no node fulfils {wanted or 'the condition'}", self.name)
        return self[mask]

    def nearest(self, *place: float) -> Nodes:
        """The node nearest to a point [m]."""
        if len(place) != self.dimension:
            raise ModelError(f"a place has {self.dimension} coordinates; got {place}", self.name)
        return self[int(np.argmin(np.linalg.norm(self.positions - np.array(place), axis=1)))]

    def _checked(self, points) -> np.ndarray:
        try:
            mixed = np.asarray(points)
        except ValueError:
            raise ModelError("points must all have as many coordinates", self.name) from None
        if mixed.ndim != 2 or not 1 <= mixed.shape[1] <= 3 or not len(mixed):
            raise ModelError(
                f"points must be an array (count, 1 to 3); got shape {mixed.shape}", self.name
            )
        if mixed.dtype == object:
            return mixed
        mixed = mixed.astype(float)
        if not np.all(np.isfinite(mixed)):
            number = int(np.argwhere(~np.isfinite(mixed))[0, 0])
            raise ModelError(f"point {number} is not finite", self.name)
        return mixed

    def __repr__(self) -> str:
        return f"<Nodes {self.name!r}: {len(self)} of {len(self.points)}>"


def _number(value) -> float:
    if isinstance(value, Expression):
        return float(value.sx) if value.sx.is_constant() else np.nan
    return float(value)


class Elements:
    """Set of elements of one class between nodes of a set, returned by ``structure.add_elements``.

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
        self.quantities = self._quantities(numbers)
        self.options = cls.default_options() | numbers
        unknown = sorted(set(numbers) - set(cls.default_options()))
        if unknown:
            known = [f.name for f in cls.quantity_fields()] + list(cls.default_options())
            raise ModelError(
                f"{cls.__name__} has no {', '.join(unknown)}; known: {', '.join(known)}", name
            )
        check_options(name, self.options)

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

    def _quantities(self, numbers: dict[str, Any]) -> dict[str, Any]:
        """Field → formula for all, or array of numbers or formulas."""
        quantities: dict[str, Any] = {}
        for field in self.cls.quantity_fields():
            meta, entity = field.metadata, f"{self.name}.{field.name}"
            if field.name not in numbers and field.default is dataclasses.MISSING:
                raise ModelError(f"is missing; give {field.name} = … [{meta['unit']}]", entity)
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
