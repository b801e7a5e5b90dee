"""States of a structure (load cases, modes, instants) and their fields.

Fields are quantities per element, or averaged at the nodes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from dalembert.elements.fem.node import Node
from dalembert.elements.fem.node_set import Nodes
from dalembert.elements.look import Cells
from dalembert.errors import AnalysisError
from dalembert.model.assembled.measures import State
from dalembert.model.assembled.model import StructuralModel
from dalembert.model.meshes.mesh import Mesh
from dalembert.results.result import Result
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.text.wording import suggestions


class StructuralStates(Result):
    """States of a structure: load cases, modes or instants.

    Attributes
    ----------
    cases : names of the states
    displacements, forces : (n, states)
    """

    model: StructuralModel
    cases: list[str]
    displacements: np.ndarray
    forces: np.ndarray

    kind_of_state: ClassVar[str] = "load case"
    """Name of a state in texts."""
    totals: ClassVar[tuple[str, ...]] = ("mass", "compliance", "strain_energy")
    """Measures of the whole structure in summaries."""
    in_sequence: ClassVar[bool] = False
    """Whether the states are consecutive, such as instants."""
    of_any_size: ClassVar[bool] = False
    """Whether the displacements have no absolute scale, such as those of modes."""
    main: ClassVar[str] = ""
    """Measure in the names of modes."""

    @property
    def kinds_of_state(self) -> str:
        """The plural."""
        kind = self.kind_of_state
        return f"{kind[:-1]}ies" if kind.endswith("cy") else f"{kind}s"

    @property
    def state_names(self) -> list[str]:
        """Names of the states in pictures and reports."""
        return [str(name) if name != "" else "load" for name in self.cases]

    @property
    def large(self) -> bool:
        """Whether displacements and rotations are finite."""
        return not (self.model.linear or self.of_any_size)

    @property
    def strained(self) -> StructuralModel:
        """Model whose elements evaluate fields; that of modes has small displacements."""
        return self.model.linearized if self.of_any_size else self.model

    def state(self, case: int) -> State:
        """Displacements and forces of one case."""
        raise NotImplementedError

    def case(self, name: str | int) -> int:
        """Index of a load case from its name or number.

        Raises
        ------
        AnalysisError
            Unknown load case.
        """
        if isinstance(name, str) and name in self.cases:
            return self.cases.index(name)
        count = len(self.cases)
        if isinstance(name, str) or not -count <= name < count:
            names = ", ".join(repr(c) for c in self.cases)
            raise AnalysisError(f"no load case {name!r}; known: {names}")
        return range(count)[name]

    def field(self, name: str, case: str | int = 0) -> np.ndarray:
        """A quantity of every element of a set, e.g. ``"plate.von_mises"``.

        Parameters
        ----------
        name : set of elements (or one element) and quantity
        case : load case, by name or number

        Returns
        -------
        (elements,)

        Raises
        ------
        AnalysisError
            Unknown set or quantity (suggests the nearest ones), or unknown case.
        """
        return set_field(self.strained, self.state(self.case(case)), name)

    def displacement_of(self, nodes: Node | Nodes | Mesh, case: str | int = 0) -> np.ndarray:
        """Displacements of several nodes.

        Parameters
        ----------
        nodes : a node, a set or selection of nodes, or a mesh
        case : load case, by name or number

        Returns
        -------
        (nodes, d) [m]
        """
        selected = nodes.nodes() if isinstance(nodes, Mesh) else nodes
        degrees = self.model.degrees
        if isinstance(selected, Nodes):
            numbers = degrees.of_set(selected)
        else:
            numbers = np.array([degrees.nodes.first(selected.name)])
        table = degrees.table[numbers, : degrees.dimension]
        return self.displacements[table, self.case(case)]

    def applied(self, number: int) -> np.ndarray:
        """(n,) applied forces of a state, without reactions of supports."""
        forces = self.forces[:, number].copy()
        forces[self.model.assembly.prescribed] = 0.0
        return forces


DISPLACEMENT = "displacement"
"""Name of the field of displacement magnitudes."""


@dataclass(frozen=True)
class Field:
    """One quantity over a structure.

    Attributes
    ----------
    values : (elements,) over all blocks, NaN if undefined; or (vertices,) if ``at_vertices``
    """

    name: str
    unit: str
    values: np.ndarray
    at_vertices: bool = False

    @property
    def range(self) -> tuple[float, float]:
        """Minimum and maximum; symmetric about zero if both signs occur."""
        finite = self.values[np.isfinite(self.values)]
        low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 0.0)
        if low < 0 < high:
            high = max(-low, high)
            low = -high
        return (low, high) if high > low else (low, low + (abs(low) or 1.0))

    @property
    def has_both_signs(self) -> bool:
        """Whether both signs occur."""
        return bool(np.nanmin(self.values) < 0 < np.nanmax(self.values))

    @property
    def label(self) -> str:
        """Name and unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name


def field_names(model: StructuralModel) -> list[str]:
    """Names of the fields: quantities of elements, and the displacement."""
    quantities = dict.fromkeys(q for block in model.blocks for q in block.kind.measures)
    return [DISPLACEMENT, *quantities]


def set_field(model: StructuralModel, state: State, name: str) -> np.ndarray:
    """(k,) quantity of each element of a set, or of one element, ``"plate.von_mises"``.

    Raises
    ------
    AnalysisError
        Unknown field.
    """
    owner, _, quantity = name.partition(".")
    elements = model.measures.elements(owner, quantity)
    if elements is None:
        raise AnalysisError(f"no field {name!r}{suggestions(name, _all_names(model))}")
    return elements.field(state)


def element_field(
    drawing: StructuralDrawing, state: State, name: str, model: StructuralModel | None = None
) -> Field:
    """Field of a quantity over all elements that have it, or over one set.

    Parameters
    ----------
    drawing : StructuralDrawing
    state : displacements and parameters
    name : of the quantity
    model : whose elements evaluate it, by default that of the drawing

    Raises
    ------
    AnalysisError
        No element has the quantity.
    """
    model = model or drawing.model
    values, unit, exists = np.full(drawing.starts[-1], np.nan), "", False
    owner, dot, rest = name.partition(".")
    quantity = rest if dot else owner
    for block, start in zip(model.blocks, drawing.starts, strict=False):
        rows = block.names.numbers(owner) if dot else range(block.count)
        block_unit = None if rows is None else block.kind.unit(quantity)
        if block_unit is None:
            continue
        unit, exists = block_unit, True
        measured = block.kind.measure(quantity, block.gather(state.u), state.data(block)).ravel()
        values[start + np.asarray(rows)] = measured[np.asarray(rows)]
    if not exists:
        names = [*field_names(model), *_all_names(model)]
        raise AnalysisError(f"no element has {name!r}{suggestions(name, names)}")
    return Field(name, unit, values)


def displacement_field(drawing: StructuralDrawing, moved: np.ndarray) -> Field:
    """Field of the magnitudes of displacements (vertices, 3)."""
    return Field(DISPLACEMENT, "m", np.linalg.norm(moved, axis=1), at_vertices=True)


def smoothed(drawing: StructuralDrawing, field: Field) -> Field:
    """Field of the mean values of adjacent elements at each vertex."""
    if field.at_vertices:
        return field
    total, count = np.zeros(len(drawing.rest)), np.zeros(len(drawing.rest))
    cells: list[Cells] = [*drawing.lines, *drawing.faces, *drawing.points]
    for shape in cells:
        values = np.repeat(field.values[shape.elements], shape.vertices.shape[1])
        vertices, finite = shape.vertices.ravel(), np.isfinite(values)
        np.add.at(total, vertices[finite], values[finite])
        np.add.at(count, vertices[finite], 1.0)
    mean = np.divide(total, count, out=np.full_like(total, np.nan), where=count > 0)
    return replace(field, values=mean, at_vertices=True)


def _all_names(model: StructuralModel) -> list[str]:
    return [
        f"{owner}.{quantity}"
        for block in model.blocks
        for owner in block.names.owners[:200]
        for quantity in block.kind.measures
    ]
