"""Pictures of structures: the scale of the displacements, supports and loads, the title."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.fields import Field
from dalembert.results.structural.picture import StructuralPicture
from dalembert.results.structural.symbols import draw_loads, draw_supports

SHARE = 0.08
"""Part of the extent that the largest displacement is drawn as."""
LARGE = 0.02
"""Share of the extent from which displacements are drawn as they are."""


def automatic_scale(drawing: StructuralDrawing, moved: np.ndarray) -> float:
    """Round factor (1, 2 or 5 times a power of ten) by which displacements show well."""
    largest = float(np.linalg.norm(moved, axis=1).max(initial=0.0))
    if not largest > 0 or not np.isfinite(largest):
        return 1.0
    if LARGE * drawing.extent <= largest <= drawing.extent:
        return 1.0
    wanted = SHARE * drawing.extent / largest
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(power * max(m for m in (1, 2, 5) if m * power <= wanted * (1 + 1e-9)))


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
    """Draw a structure displaced by ``moved``; used for loads, modes and buckling alike.

    Parameters
    ----------
    drawing : StructuralDrawing
    moved : (vertices, 3) displacements, from ``drawing.displaced`` [m]
    field : colours
    scale : factor of the displacements; ``"auto"`` takes a round one that shows well
    undeformed : draw the structure at rest behind
    loads : (n,) forces on the displacements, drawn as arrows
    title : the scale is told after it
    mesh : draw the edges of the elements; up to 2500 faces if None
    ax : axes to draw into, new ones if None
    """
    factor = automatic_scale(drawing, moved) if scale == "auto" else float(scale)
    faces = sum(len(shape.owners) for shape in drawing.faces)
    picture = StructuralPicture(
        drawing, moved, factor, field, undeformed, faces <= 2500 if mesh is None else mesh
    )
    ax = picture.draw(ax)
    draw_supports(ax, drawing, picture.places if not undeformed else drawing.rest)
    if loads is not None:
        draw_loads(ax, drawing, picture.places, loads)
    told = "" if factor == 1 else f"displacements × {factor:g}"
    ax.set_title(", ".join(part for part in (title, told) if part), loc="left", fontsize=10)
    return ax
