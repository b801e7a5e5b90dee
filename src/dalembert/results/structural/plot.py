"""Plot of a structure: displacement scale, supports, loads and title."""

from __future__ import annotations

from typing import Any

import numpy as np

from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.fields import Field
from dalembert.results.structural.picture import StructuralPicture
from dalembert.results.structural.symbols import draw_loads, draw_supports

SHARE = 0.08
"""Drawn size of the maximum displacement, relative to the extent."""
LARGE = 0.02
"""Threshold, relative to the extent, for drawing displacements to scale."""


def automatic_scale(drawing: StructuralDrawing, moved: np.ndarray) -> float:
    """Round scale factor (1, 2 or 5 times a power of ten) that makes displacements visible."""
    largest = float(np.linalg.norm(moved, axis=1).max(initial=0.0))
    if not largest > 0 or not np.isfinite(largest):
        return 1.0
    if LARGE * drawing.extent <= largest <= drawing.extent:
        return 1.0
    target = SHARE * drawing.extent / largest
    power = 10.0 ** np.floor(np.log10(target))
    return float(power * max(m for m in (1, 2, 5) if m * power <= target * (1 + 1e-9)))


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
    faces = sum(len(shape.owners) for shape in drawing.faces)
    picture = StructuralPicture(
        drawing, moved, factor, field, undeformed, faces <= 2500 if mesh is None else mesh
    )
    ax = picture.draw(ax)
    draw_supports(ax, drawing, picture.places if not undeformed else drawing.rest)
    if loads is not None:
        draw_loads(ax, drawing, picture.places, loads)
    scale_text = "" if factor == 1 else f"displacements × {factor:g}"
    ax.set_title(", ".join(part for part in (title, scale_text) if part), loc="left", fontsize=10)
    return ax
