"""Quantities of elements as arrays, one by one or averaged at the nodes."""

from __future__ import annotations

import difflib
from dataclasses import dataclass, replace

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.shapes import Shapes
from dalembert.structures.measuring.measures import State
from dalembert.structures.model import StructuralModel

DISPLACEMENT = "displacement"
"""Name of the field of sizes of the nodes' displacements."""


@dataclass(frozen=True)
class Field:
    """One quantity over a structure.

    Attributes
    ----------
    values : (elements,) over all blocks, NaN where there is none; or (vertices,) if ``at_vertices``
    """

    name: str
    unit: str
    values: np.ndarray
    at_vertices: bool = False

    @property
    def range(self) -> tuple[float, float]:
        """Smallest and largest value; about zero where both signs occur."""
        known = self.values[np.isfinite(self.values)]
        low, high = (float(known.min()), float(known.max())) if known.size else (0.0, 0.0)
        if low < 0 < high:
            high = max(-low, high)
            low = -high
        return (low, high) if high > low else (low, low + (abs(low) or 1.0))

    @property
    def has_both_signs(self) -> bool:
        """Whether there are values on both sides of zero."""
        return bool(np.nanmin(self.values) < 0 < np.nanmax(self.values))

    @property
    def label(self) -> str:
        """Name and unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def field_names(model: StructuralModel) -> list[str]:
    """Quantities that some elements have, and the displacement."""
    found = dict.fromkeys(q for block in model.blocks for q in block.kind.measures)
    return [DISPLACEMENT, *found]


def set_field(model: StructuralModel, state: State, name: str) -> np.ndarray:
    """(k,) a quantity of each element of a set, or of one element, ``"plate.von_mises"``.

    Raises
    ------
    AnalysisError
        There is none of this name.
    """
    owner, _, quantity = name.partition(".")
    found = model.measures.elements(owner, quantity)
    if found is None:
        raise AnalysisError(f"no field {name!r}{_near(name, _all_names(model))}")
    return found.field(state)


def element_field(drawing: StructuralDrawing, state: State, name: str) -> Field:
    """A quantity over all elements that have it, or over one set.

    Raises
    ------
    AnalysisError
        No element has it.
    """
    model = drawing.model
    values, unit, known = np.full(drawing.starts[-1], np.nan), "", False
    owner, dot, rest = name.partition(".")
    quantity = rest if dot else owner
    for block, start in zip(model.blocks, drawing.starts, strict=False):
        rows = block.names.numbers(owner) if dot else range(block.count)
        has = None if rows is None else block.kind.unit(quantity)
        if has is None:
            continue
        unit, known = has, True
        measured = block.kind.measure(quantity, block.gather(state.u), state.data(block)).ravel()
        values[start + np.asarray(rows)] = measured[np.asarray(rows)]
    if not known:
        names = [*field_names(model), *_all_names(model)]
        raise AnalysisError(f"no element has {name!r}{_near(name, names)}")
    return Field(name, unit, values)


def displacement_field(drawing: StructuralDrawing, moved: np.ndarray) -> Field:
    """Sizes of the displacements (vertices, 3)."""
    return Field(DISPLACEMENT, "m", np.linalg.norm(moved, axis=1), at_vertices=True)


def smoothed(drawing: StructuralDrawing, field: Field) -> Field:
    """The mean at each vertex of the values of the elements around it."""
    if field.at_vertices:
        return field
    total, count = np.zeros(len(drawing.rest)), np.zeros(len(drawing.rest))
    shapes: list[Shapes] = [*drawing.lines, *drawing.faces, *drawing.points]
    for shape in shapes:
        values = np.repeat(field.values[shape.owners], shape.vertices.shape[1])
        places, there = shape.vertices.ravel(), np.isfinite(values)
        np.add.at(total, places[there], values[there])
        np.add.at(count, places[there], 1.0)
    mean = np.divide(total, count, out=np.full_like(total, np.nan), where=count > 0)
    return replace(field, values=mean, at_vertices=True)


def _all_names(model: StructuralModel) -> list[str]:
    return [
        f"{owner}.{quantity}"
        for block in model.blocks
        for owner in block.names.owners[:200]
        for quantity in block.kind.measures
    ]


def _near(name: str, known: list[str]) -> str:
    close = difflib.get_close_matches(name, known, 3, 0.4)
    return f"; nearest: {', '.join(close)}" if close else ""
