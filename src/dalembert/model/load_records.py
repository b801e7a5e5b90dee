"""Loads as the builder records them: nodal and distributed loads, temperature changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.cells import CELLS, facets
from dalembert.elements.fem.continuum import Continuum
from dalembert.elements.fem.element_set import Elements
from dalembert.elements.fem.energies import CHANGES
from dalembert.elements.fem.lines import Line
from dalembert.elements.fem.node_set import Nodes
from dalembert.elements.fem.reference_cells import REFERENCE_CELLS
from dalembert.elements.fem.tractions import TRACTIONS
from dalembert.errors import ModelError
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression


@dataclass(frozen=True)
class Load:
    """Forces, or initial motions, in one direction at nodes; one value for all, or one per node.

    Attributes
    ----------
    fixed_axes : whether it is a moment about a fixed spatial axis
    """

    nodes: np.ndarray
    direction: str
    value: Any
    entity: str
    fixed_axes: bool = False

    @property
    def is_zero(self) -> np.ndarray:
        """Mask of the nodes at which it is zero for all parameter values."""
        values = self.value if isinstance(self.value, list) else [self.value]
        return np.array([value.sx.is_zero() for value in values])

    @property
    def each(self) -> Any:
        """A formula for all nodes, or an array with one per node."""
        if not isinstance(self.value, list):
            return self.value
        return np.fromiter(self.value, dtype=object, count=len(self.value))


Part = StructuralElement | Elements


@dataclass(frozen=True)
class Weight:
    """Forces ``M a`` of gravity ``a`` [m/s²] on the masses of all elements."""

    acceleration: tuple[Expression, ...]


@dataclass(frozen=True)
class LineLoad:
    """Force per length ``q`` [N/m] on beams and bars."""

    parts: tuple[Part, ...]
    force: tuple[Expression, ...]


Spread = Weight | LineLoad | Elements


def elements_of(parts: Any, load: str) -> tuple[Part, ...]:
    """An element, a set of elements, or several, as a tuple.

    Raises
    ------
    ModelError
        Another type.
    """
    elements = (parts,) if isinstance(parts, (StructuralElement, Elements)) else parts
    is_sequence = isinstance(elements, (list, tuple)) and elements
    if not is_sequence or not all(
        isinstance(part, (StructuralElement, Elements)) for part in elements
    ):
        raise ModelError(f"needs elements or sets of elements; got {parts!r}", load)
    return tuple(elements)


def _fields(part: Part) -> dict[str, Any]:
    """Quantities of an element class, with their metadata."""
    cls = part.cls if isinstance(part, Elements) else type(part)
    return {f.name: f.metadata for f in cls.quantity_fields()}


def lines(parts: Any) -> tuple[Part, ...]:
    """Line elements with mass, or sets of them.

    Raises
    ------
    ModelError
        Other elements.
    """
    elements = elements_of(parts, "line_load")
    for part in elements:
        cls = part.cls if isinstance(part, Elements) else type(part)
        if not issubclass(cls, Line) or not {"area", "density"} <= set(_fields(part)):
            raise ModelError("carries no line load; take trusses or frames", part.name)
    return elements


def heating(part: Part, changes: dict[str, Any]) -> dict[str, Any]:
    """Temperature changes of an element or set, by quantity: a formula, or one per element.

    Raises
    ------
    ModelError
        The elements have no such quantity.
    """
    fields = _fields(part)
    known = [name for name in CHANGES if name in fields]
    wrong = sorted(set(changes) - set(known))
    if wrong or not changes:
        raise ModelError(
            f"feels no {', '.join(wrong) or 'change'}; it feels {', '.join(known) or 'none'}",
            part.name,
        )
    values: dict[str, Any] = {}
    for name, value in changes.items():
        entity, unit = f"heat {part.name}.{name}", fields[name]["unit"]
        if isinstance(part, Elements) and np.shape(value) == (len(part),):
            formulas = [as_expression(v, entity, unit) for v in value]
            values[name] = np.fromiter(formulas, dtype=object, count=len(formulas))
        else:
            values[name] = as_expression(value, entity, unit)
    return values


def check_expansion(parts: Sequence[Part]) -> None:
    """Raise if a temperature change has no effect, for lack of thermal expansion.

    Raises
    ------
    ModelError
        No element has a coefficient of thermal expansion.
    """
    if parts and all(_is_zero(part, "expansion") for part in parts):
        raise ModelError(
            "has no thermal expansion, so that a temperature change has no effect; give "
            "expansion= [1/K], e.g. 1.2e-5 for steel",
            ", ".join(part.name for part in parts[:5]),
        )


def check_temperature(part: Part) -> None:
    """Raise if an element with a temperature change has no thermal expansion.

    Raises
    ------
    ModelError
        It has no coefficient of thermal expansion.
    """
    own = [name for name in CHANGES if name in _fields(part)]
    if not all(_is_zero(part, name) for name in own):
        check_expansion([part])


def _is_zero(part: Part, quantity: str) -> bool:
    """Whether a quantity of an element or set is zero for all parameter values."""
    numbers = part.numbers[quantity] if isinstance(part, Elements) else getattr(part, quantity)
    if isinstance(numbers, np.ndarray) and numbers.dtype.kind in "iuf":
        return not numbers.any()
    values = numbers.ravel() if isinstance(numbers, np.ndarray) else [numbers]
    return all(as_expression(value, part.name).sx.is_zero() for value in values)


def tractions(name: str, elements: Elements, nodes: Nodes, numbers: dict[str, Any]) -> Elements:
    """Traction elements on the outer facets of cells with all their nodes among ``nodes``.

    Raises
    ------
    ModelError
        Not a continuum, no outer facet there, or an unknown component.
    """
    if not isinstance(elements, Elements) or not issubclass(elements.cls, Continuum):
        raise ModelError(f"needs a set of cells of a continuum, got {elements!r}", "traction")
    known = [*("tx", "ty", "tz")[: nodes.dimension], "pressure"]
    wrong = sorted(set(numbers) - set(known))
    if wrong or not numbers:
        raise ModelError(f"has no {', '.join(wrong) or 'value'}; give {', '.join(known)}", name)
    cell = next(n for n, c in REFERENCE_CELLS.items() if c is elements.cls.cell)
    shape, local_facets = facets(cell)
    selected = np.isin(elements.nodes.index[elements.cells], nodes.index)
    facet_cells, owners = [], []
    for facet in local_facets:
        rows = np.flatnonzero(selected[:, facet].all(axis=1))
        facet_cells.append(elements.cells[rows][:, facet])
        owners.append(rows)
    cells, owner = np.concatenate(facet_cells), np.concatenate(owners)
    _, facet_index, count = np.unique(
        np.sort(cells), axis=0, return_inverse=True, return_counts=True
    )
    outer = count[facet_index.ravel()] == 1  # between two cells there is no surface
    cells, owner = cells[outer], owner[outer]
    if nodes.points is not elements.nodes.points or not len(cells):
        raise ModelError(
            f"no {_WORD[CELLS[cell].dimension]} has all its nodes there, on the surface",
            elements.name,
        )
    thickness = elements.numbers.get("thickness")
    if thickness is not None:
        uniform = isinstance(thickness, Expression)
        numbers = {"thickness": thickness if uniform else thickness[owner]} | numbers
    return Elements(name, TRACTIONS[shape], elements.nodes, cells, **numbers)


_WORD = {2: "edge", 3: "face"}
