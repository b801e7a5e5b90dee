"""VTK series for ParaView: a collection (.pvd) of unstructured grids (.vtu), one per state."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree as xml

from dalembert.io.exports.exported import Files
from dalembert.io.exports.vtk.grid import grid_file
from dalembert.io.exports.vtk.mechanism import mechanism_states
from dalembert.io.exports.vtk.structure import structure_states
from dalembert.results.structural.states import StructuralStates


def vtk_series(source: Any, name: str, frames: int | None = None) -> Files:
    """A collection for ParaView, with a grid for each instant, load case or mode.

    Structures have displacements, velocities and forces at nodes and all quantities of their
    elements; mechanisms the shapes of the bodies with velocities, and the joints with reactions.

    Parameters
    ----------
    frames : upper limit of the instants
    """
    is_structure = isinstance(source, StructuralStates)
    states = structure_states(source, frames) if is_structure else mechanism_states(source, frames)
    root = xml.Element("VTKFile", type="Collection", version="0.1", byte_order="LittleEndian")
    collection, files = xml.SubElement(root, "Collection"), {}
    for k, state in enumerate(states):
        for part, (label, grid) in enumerate(state.parts.items()):
            file = f"{name}_{label}_{k:04d}.vtu"
            files[file] = grid_file(grid)
            attributes = {"timestep": repr(float(state.time)), "part": str(part), "file": file}
            xml.SubElement(collection, "DataSet", attributes | {"name": label})
    xml.indent(root)
    index = xml.tostring(root, encoding="utf-8", xml_declaration=True)
    return Files({f"{name}.pvd": index, **files})
