"""Meshes as nodes and elements of a model, with their named selections."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from dalembert.elements.fem.base import StructuralElement
from dalembert.elements.fem.cells import CELLS, oriented
from dalembert.elements.fem.element_set import Elements
from dalembert.elements.fem.node_set import Nodes
from dalembert.elements.fem.registry import element_for
from dalembert.errors import ModelError
from dalembert.model.meshes.mesh_data import MeshData, mesh_data

Classes = type[StructuralElement] | Mapping[str, type[StructuralElement]] | None


class Mesh:
    """Nodes and elements of a mesh, returned by ``system.add_mesh``.

    Attributes
    ----------
    name : str
    elements : name of an element set → Elements; one set with the name of the mesh if all cells
        have the same shape, otherwise one set per shape, ``name_shape``
    selections : names of the groups of the mesh
    """

    def __init__(self, name: str, data: MeshData, nodes: Nodes, elements: dict[str, Elements]):
        self.name, self.elements = name, elements
        self._data, self._nodes = data, nodes
        self._shapes = _labels(name, list(data.cells))

    @property
    def selections(self) -> list[str]:
        """Names of the groups, for ``nodes`` and ``members``."""
        return [*dict.fromkeys([*self._data.point_groups, *self._data.cell_groups])]

    def nodes(self, selection: str | None = None) -> Nodes:
        """All nodes, or those of a point set, or of the cells of a cell set.

        Raises
        ------
        ModelError
            The mesh has no such group.
        """
        if selection is None:
            return self._nodes
        return self._nodes[self._data.nodes_of(self._checked(selection))]

    def members(self, selection: str) -> dict[str, np.ndarray]:
        """Numbers of the elements of a group, by the name of their set.

        Raises
        ------
        ModelError
            The mesh has no such group, or it holds no elements.
        """
        groups = self._data.cell_groups.get(self._checked(selection), {})
        members = {
            label: groups[shape]
            for label, shape in self._shapes.items()
            if groups.get(shape, np.array([])).size
        }
        if not members:
            raise ModelError(f"group {selection!r} holds no elements, only nodes", self.name)
        return members

    def _checked(self, selection: str) -> str:
        if selection not in self.selections:
            known = ", ".join(self.selections) or "none"
            raise ModelError(f"has no group {selection!r}; known: {known}", self.name)
        return selection

    def __repr__(self) -> str:
        sets = ", ".join(f"{len(e)} {e.cls.__name__}" for e in self.elements.values())
        return f"<Mesh {self.name!r}: {len(self._nodes)} nodes, {sets}>"


def add_mesh(system: Any, name: str, mesh: Any, element: Classes, quantities: dict) -> Mesh:
    """Add the nodes and elements of a mesh; see ``System.add_mesh``."""
    data = mesh_data(mesh, name)
    classes = _classes(name, data, element)
    data = data.reduced(list(classes))
    labels = _labels(name, list(classes))
    for set_name in (f"{name}_nodes", *labels):
        system._claim(set_name)  # checked before anything is added
    cells = {shape: oriented(shape, data.points, data.cells[shape]) for shape in classes}
    quantities_of = {
        label: {
            key: _each(name, key, value, data, shape) if isinstance(value, Mapping) else value
            for key, value in quantities.items()
        }
        for label, shape in labels.items()
    }
    trial = Nodes(f"{name}_nodes", data.points)
    for label, shape in labels.items():
        Elements(label, classes[shape], trial, cells[shape], **quantities_of[label])
    nodes = system.add_nodes(f"{name}_nodes", data.points)
    elements = {
        label: system.add_elements(label, classes[s], nodes, cells[s], **quantities_of[label])
        for label, s in labels.items()
    }
    return Mesh(name, data, nodes, elements)


def _labels(name: str, shapes: list[str]) -> dict[str, str]:
    """Name of an element set → the shape of its cells."""
    if len(shapes) == 1:
        return {name: shapes[0]}
    return {f"{name}_{shape}": shape for shape in shapes}


def _classes(name: str, data: MeshData, element: Classes) -> dict[str, type[StructuralElement]]:
    """Shape of cells → class of elements."""
    if isinstance(element, Mapping):
        missing = [shape for shape in element if shape not in data.cells]
        if missing:
            raise ModelError(f"has no cells {missing[0]!r}; it has {_listed(data)}", name)
        return dict(element)
    dimension = max(CELLS[shape].dimension for shape in data.cells)
    classes = {}
    for shape in (s for s in data.cells if CELLS[s].dimension == dimension):
        cls = element or element_for(shape, data.points.shape[1])
        if cls is None:
            raise ModelError(
                f"no element is known for cells {shape!r} in {data.points.shape[1]} dimension(s); "
                "give element = the class they become",
                name,
            )
        if cls.node_count != CELLS[shape].nodes:
            raise ModelError(
                f"{cls.__name__} has {cls.node_count} nodes, cells {shape!r} have "
                f"{CELLS[shape].nodes}; give element = {{shape: class}}",
                name,
            )
        classes[shape] = cls
    return classes


def _each(name: str, key: str, value: Mapping, data: MeshData, shape: str) -> np.ndarray:
    """A quantity by groups, as an array over the elements of one shape."""
    values = np.full(len(data.cells[shape]), None, dtype=object)
    for group, number in value.items():
        if group not in data.cell_groups:
            known = ", ".join(data.cell_groups) or "none"
            raise ModelError(f"{key}: no group of elements {group!r}; known: {known}", name)
        values[data.cell_groups[group].get(shape, np.array([], dtype=int))] = number
    missing = sum(number is None for number in values)
    if missing:
        raise ModelError(
            f"{key}: {missing} element(s) are in none of the groups {', '.join(value)}", name
        )
    return values


def _listed(data: MeshData) -> str:
    return ", ".join(f"{len(c)} {shape!r}" for shape, c in data.cells.items())
