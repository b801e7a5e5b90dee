"""Loads spread over elements: weight, line loads, tractions; records that the builder keeps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.cells import CELLS, facets
from dalembert.elements.fem.continuum import Continuum
from dalembert.elements.fem.lines import Line
from dalembert.elements.fem.reference_cells import REFERENCE_CELLS
from dalembert.errors import ModelError
from dalembert.structures.evaluation.elements import Elements
from dalembert.structures.loads.temperatures import CHANGES
from dalembert.structures.loads.tractions import TRACTIONS
from dalembert.structures.nodes import Nodes
from dalembert.symbolic.formulas.conversion import as_expression
from dalembert.symbolic.formulas.expression import Expression

Part = StructuralElement | Elements


@dataclass(frozen=True)
class Weight:
    """Forces ``M a`` of a field of gravity ``a`` [m/s²] on the masses of all elements."""

    acceleration: tuple[Expression, ...]


@dataclass(frozen=True)
class LineLoad:
    """Force per length ``q`` [N/m] on beams and bars."""

    parts: tuple[Part, ...]
    force: tuple[Expression, ...]


Spread = Weight | LineLoad | Elements


def elements_of(parts: Any, load: str) -> tuple[Part, ...]:
    """One element, a set of them, or several, as a tuple.

    Raises
    ------
    ModelError
        Something else.
    """
    found = (parts,) if isinstance(parts, (StructuralElement, Elements)) else parts
    known = isinstance(found, (list, tuple)) and found
    if not known or not all(isinstance(part, (StructuralElement, Elements)) for part in found):
        raise ModelError(f"needs elements or sets of elements; got {parts!r}", load)
    return tuple(found)


def _fields(part: Part) -> dict[str, Any]:
    """Quantities of the class of elements, with what is known of them."""
    cls = part.cls if isinstance(part, Elements) else type(part)
    return {f.name: f.metadata for f in cls.quantity_fields()}


def lines(parts: Any) -> tuple[Part, ...]:
    """Line elements that have mass, or sets of them.

    Raises
    ------
    ModelError
        Other elements.
    """
    found = elements_of(parts, "line_load")
    for part in found:
        cls = part.cls if isinstance(part, Elements) else type(part)
        if not issubclass(cls, Line) or not {"area", "density"} <= set(_fields(part)):
            raise ModelError("carries no line load; take trusses or frames", part.name)
    return found


def heating(part: Part, changes: dict[str, Any]) -> dict[str, Any]:
    """Changes of temperature of an element or set, by quantity: formulas, or one for each.

    Raises
    ------
    ModelError
        The elements do not feel one of them.
    """
    fields = _fields(part)
    felt = [name for name in CHANGES if name in fields]
    wrong = sorted(set(changes) - set(felt))
    if wrong or not changes:
        raise ModelError(
            f"feels no {', '.join(wrong) or 'change'}; it feels {', '.join(felt) or 'none'}",
            part.name,
        )
    found: dict[str, Any] = {}
    for name, value in changes.items():
        entity, unit = f"heat {part.name}.{name}", fields[name]["unit"]
        if isinstance(part, Elements) and np.shape(value) == (len(part),):
            each = [as_expression(v, entity, unit) for v in value]
            found[name] = np.fromiter(each, dtype=object, count=len(each))
        else:
            found[name] = as_expression(value, entity, unit)
    return found


def check_expansion(parts: Sequence[Part]) -> None:
    """A change of temperature that cannot strain anything is an input that lacks a number.

    Raises
    ------
    ModelError
        No element has a coefficient of thermal expansion.
    """
    if parts and all(_is_zero(part, "expansion") for part in parts):
        raise ModelError(
            "has no thermal expansion, so that a change of temperature does nothing; give "
            "expansion= [1/K], e.g. 1.2e-5 for steel",
            ", ".join(part.name for part in parts[:5]),
        )


def check_temperature(part: Part) -> None:
    """An element with a change of temperature of its own needs thermal expansion, too.

    Raises
    ------
    ModelError
        It has none.
    """
    own = [name for name in CHANGES if name in _fields(part)]
    if not all(_is_zero(part, name) for name in own):
        check_expansion([part])


def _is_zero(part: Part, quantity: str) -> bool:
    """Whether a quantity of an element, or of all of a set, is zero whatever the parameters."""
    given = part.quantities[quantity] if isinstance(part, Elements) else getattr(part, quantity)
    if isinstance(given, np.ndarray) and given.dtype.kind in "iuf":
        return not given.any()
    each = given.ravel() if isinstance(given, np.ndarray) else [given]
    return all(as_expression(value, part.name).sx.is_zero() for value in each)


def tractions(name: str, elements: Elements, nodes: Nodes, numbers: dict[str, Any]) -> Elements:
    """Traction elements on the outer facets of cells all of whose nodes are among ``nodes``.

    Raises
    ------
    ModelError
        No continuum, no outer facet lies there, or a traction that cannot be.
    """
    if not isinstance(elements, Elements) or not issubclass(elements.cls, Continuum):
        raise ModelError(f"needs a set of cells of a continuum, got {elements!r}", "traction")
    known = [*("tx", "ty", "tz")[: nodes.dimension], "pressure"]
    wrong = sorted(set(numbers) - set(known))
    if wrong or not numbers:
        raise ModelError(f"has no {', '.join(wrong) or 'value'}; give {', '.join(known)}", name)
    cell = next(n for n, c in REFERENCE_CELLS.items() if c is elements.cls.cell)
    shape, each = facets(cell)
    among = np.isin(elements.nodes.index[elements.cells], nodes.index)
    found, owners = [], []
    for facet in each:
        there = np.flatnonzero(among[:, facet].all(axis=1))
        found.append(elements.cells[there][:, facet])
        owners.append(there)
    cells, owner = np.concatenate(found), np.concatenate(owners)
    _, place, count = np.unique(np.sort(cells), axis=0, return_inverse=True, return_counts=True)
    outer = count[place.ravel()] == 1  # between two cells there is no surface
    cells, owner = cells[outer], owner[outer]
    if nodes.points is not elements.nodes.points or not len(cells):
        raise ModelError(
            f"no {_WORD[CELLS[cell].dimension]} has all its nodes there, on the surface",
            elements.name,
        )
    thickness = elements.quantities.get("thickness")
    if thickness is not None:
        one = isinstance(thickness, Expression)
        numbers = {"thickness": thickness if one else thickness[owner]} | numbers
    return Elements(name, TRACTIONS[shape], elements.nodes, cells, **numbers)


_WORD = {2: "edge", 3: "face"}
