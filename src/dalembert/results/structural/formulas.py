"""Formulas behind the payload of a structure, of parameters and of measures of its states."""

from __future__ import annotations

from typing import Any

import casadi as ca
import numpy as np

from dalembert.elements.fem.nodal import effort
from dalembert.elements.look import Cells, Coils
from dalembert.elements.point import AXES
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.files.live_responses import FirstResponse
from dalembert.results.sources import Column, InitialPicture, States, numbers
from dalembert.results.structural.diagrams import line_diagrams
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.shapes import between
from dalembert.results.structural.states import StructuralStates

MAIN_FIELDS = ("von_mises", "stress", "force")
"""Quantities whose maximum is a response by default, the first that exists."""
TOTALS = {"mass": "kg", "compliance": "J"}
"""Measures of the whole structure that are responses by default, with their units."""


def with_formulas(
    payload: dict[str, Any], result: StructuralStates, drawing: StructuralDrawing
) -> dict[str, Any]:
    """The payload of a small structure with formulas of its numbers and columns."""
    return StructureFormulas(result, drawing).tagged(payload)


class StructureFormulas:
    """Formulas of positions, displacements, fields, reactions and loads of a structure.

    Parameters
    ----------
    result : states of a structure with small displacements
    drawing : of the result
    """

    def __init__(self, result: StructuralStates, drawing: StructuralDrawing):
        self.result, self.drawing = result, drawing
        self.model, self.degrees = result.model, result.model.degrees
        self.data = [block.data_formulas for block in self.model.blocks]
        self.nodes = drawing.positions(self.data).astype(object)
        self.prescribed = set(self.model.assembly.prescribed.tolist())
        self.displacements = np.empty(len(self.degrees), dtype=object)
        for k in range(len(self.degrees)):
            node, direction = self.degrees.place(k)
            self.displacements[k] = _symbol(self.model, f"{node}.{direction}")

    def tagged(self, payload: dict[str, Any]) -> dict[str, Any]:
        """The payload with formulas of its numbers and columns."""
        scene, mesh = payload["scene"], payload["scene"]["mesh"]
        mesh["rest"] = numbers(np.ravel(mesh["rest"]).tolist(), self.vertices())
        moved = self.drawing.displaced_from(self.nodes, self.displacements)
        mesh["vertex_displacements"] = States(mesh["vertex_displacements"], _column(moved))
        lines = zip(mesh["lines"], (c for c in self.drawing.lines if len(c.elements)), strict=True)
        mesh["lines"] = [self._group(group, cells) for group, cells in lines]
        for field in scene["fields"]:
            field["values"] = States(field["values"], self.field(field["name"]))
        if "diagrams" in scene:
            formulas = line_diagrams(self.drawing, self.nodes, self.data)
            for diagram, formula in zip(scene["diagrams"], formulas, strict=True):
                across = diagram["across"].tolist()
                diagram["across"] = numbers(across, _column(formula["across"]))
        payload["displacements"] = States(payload["displacements"], _column(self.displacements))
        for row in payload["reactions"]:
            row["values"] = Column(
                row["values"], _symbol(self.model, f"{row['node']}.{row['name']}")
            )
        if self.result.of_any_size:
            states, main = payload["states"], self.result.expression(self.result.main)
            states["values"] = Column(states["values"].tolist(), main.sx)
        else:
            for symbol in scene["symbols"]:
                self._tag_load(symbol)
        return payload

    def vertices(self) -> ca.SX:
        """(3 v,) undeformed positions; turns of springs stay those of the initial design."""
        drawing = self.drawing
        rest = drawing.rest.astype(object)
        rest[: drawing.node_count] = self.nodes
        for cells, along, rows in drawing.curves:
            ends = cells.vertices.T
            offset = drawing.rest[rows] - between(drawing.nodes[ends], along).reshape(-1, 3)
            rest[rows] = between(self.nodes[ends], along).reshape(-1, 3) + offset
        return _column(rest)

    def field(self, name: str) -> ca.SX:
        """(elements,) a quantity; constant where an element does not have it."""
        values = [
            _symbol(self.model, f"{element}.{name}")
            if block.kind.unit(name) is not None
            else ca.SX(0)
            for block in self.model.blocks
            for element in block.names.names
        ]
        return ca.vertcat(*values)

    def _group(self, group: dict[str, Any], cells: Cells) -> dict[str, Any]:
        """Lines; the turns of springs have no formulas."""
        if not isinstance(cells, Coils):
            return group
        names = self.drawing.element_names
        return InitialPicture(f"turns of {names[int(cells.elements[0])]}", group)

    def _tag_load(self, symbol: dict[str, Any]) -> None:
        """Formulas of an arrow or arc; at prescribed displacements it has no columns to state."""
        pairs = {f"force_{axis}": f"u{axis}" for axis in AXES} | {"moment": "rz"}
        for key, direction in pairs.items():
            if key not in symbol:
                continue
            node = self.degrees.nodes.name(symbol["node"])
            degree = self.degrees.get((node, direction))
            if degree is not None and degree not in self.prescribed:
                formula = _symbol(self.model, f"{node}.{effort(direction)}")
                symbol[key] = Column(symbol[key], formula)


def first_responses(result: StructuralStates) -> list[FirstResponse]:
    """Responses of a page of load cases by default: extreme values."""
    model, degrees = result.model, result.model.degrees
    quantities = {q: unit for block in model.blocks for q, (_, unit) in block.kind.measures.items()}
    squares = [
        ca.sumsqr(ca.vertcat(*(_symbol(model, f"{node}.{d}") for d in directions)))
        for node in degrees.nodes.names
        if (directions := [d for d in degrees.directions_of(node) if d.startswith("u")])
    ]
    rows = [("largest displacement", "m", ca.sqrt(ca.mmax(ca.vertcat(*squares))))]
    for quantity in [q for q in MAIN_FIELDS if q in quantities][:1]:
        values = [
            ca.fabs(_symbol(model, f"{element}.{quantity}"))
            for block in model.blocks
            if quantity in block.kind.measures
            for element in block.names.names
        ]
        label = f"largest |{quantity.replace('_', ' ')}|"
        rows.append((label, quantities[quantity], ca.mmax(ca.vertcat(*values))))
    moments = [
        ca.fabs(_symbol(model, f"{element}.{end}"))
        for block in model.blocks
        for name, diagram in block.kind.cls.diagrams.items()
        if name.startswith("moment")
        for element in block.names.names
        for end in (diagram.start, diagram.end)
    ]
    if moments:
        rows.append(("largest |moment|", "N m", ca.mmax(ca.vertcat(*moments))))
    rows += [(name, unit, _symbol(model, name)) for name, unit in TOTALS.items()]
    return [FirstResponse(label, unit, sx, {"kind": "maximum"}) for label, unit, sx in rows]


def _symbol(model: StructuralModel, name: str) -> ca.SX:
    """Symbol of a measure."""
    expression = model.measures.find(name)
    assert expression is not None, name
    return expression.sx


def _column(entries: np.ndarray) -> ca.SX:
    """(n,) SX of numbers and formulas."""
    return ca.vertcat(*(ca.SX(entry) for entry in entries.ravel()))
