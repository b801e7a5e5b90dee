"""Plot of one state of a structure, with its displacement scale in the title."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.results.pictures.mesh_picture import MeshPicture
from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.fields import Field
from dalembert.results.structural.scene import automatic_scale, structural_scene

MOST_EDGES = 2500
"""Upper limit of faces whose edges are drawn by default."""


def plot_structure(
    drawing: StructuralDrawing,
    moved: np.ndarray,
    *,
    field: Field | None = None,
    scale: float | str = "auto",
    undeformed: bool = True,
    loads: np.ndarray | None = None,
    title: str = "",
    mesh: bool | None = None,
    ax: Any = None,
) -> Any:
    """Draw a structure displaced by ``moved``; used for load cases, modes and buckling.

    Parameters
    ----------
    drawing : StructuralDrawing
    moved : (vertices, 3) displacements, from ``drawing.displaced`` [m]
    field : colours
    scale : factor of the displacements; ``"auto"`` selects a round one
    undeformed : draw the undeformed structure behind
    loads : (n,) forces on the displacements, drawn as arrows
    title : title, followed by the scale
    mesh : draw the edges of the elements; up to 2500 faces if None
    ax : axes to draw into, new ones if None
    """
    factor = automatic_scale(drawing, moved) if scale == "auto" else float(scale)
    applied = np.zeros(len(drawing.model.degrees)) if loads is None else loads
    scene = structural_scene(drawing, [moved], [factor], applied[:, None])
    faces = sum(len(cells.elements) for cells in drawing.faces)
    edges = faces <= MOST_EDGES if mesh is None else mesh
    frames = [(0, factor)]
    picture = MeshPicture(scene, frames, field=field, undeformed=undeformed, mesh=edges, ax=ax)
    scale_text = "" if factor == 1 else f"displacements × {factor:g}"
    text = ", ".join(part for part in (title, scale_text) if part)
    picture.ax.set_title(text, loc="left", fontsize=10)
    return picture.ax
