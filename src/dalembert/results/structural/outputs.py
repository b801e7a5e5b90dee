"""Pictures, summary and report of a structural result."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.results.structural.drawing import StructuralDrawing
from dalembert.results.structural.states import (
    DISPLACEMENT,
    Field,
    StructuralStates,
    displacement_field,
    element_field,
    smoothed,
)

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

    from dalembert.results.files.live_responses import FirstResponse
    from dalembert.results.live import PageResponse


class StructuralOutputs(StructuralStates):
    """Pictures, summary and report of the states of a structure."""

    def draw(
        self,
        field: str | None = None,
        case: str | int = 0,
        *,
        scale: float | str = "auto",
        undeformed: bool = True,
        smooth: bool = False,
        mesh: bool | None = None,
        ax: Axes | None = None,
    ) -> Axes:
        """Draw the deformed structure with its supports and loads; returns the axes.

        Parameters
        ----------
        field : quantity for the colours: of all elements that have it (``"von_mises"``), of one
            set (``"plate.von_mises"``), or ``"displacement"``
        case : load case, by name or number
        scale : factor of the displacements; by default a round one, given in the title
        undeformed : draw the undeformed structure behind
        smooth : mean values at the nodes instead of one per element
        mesh : draw the edges of the elements
        ax : axes of Matplotlib, new ones if None

        Raises
        ------
        AnalysisError
            Unknown quantity or case.
        """
        number = self.case(case)
        drawing, state = StructuralDrawing(self.model, self.parameters), self.state(number)
        moved = drawing.displaced(state.u, self.large)
        colours = None
        if field == DISPLACEMENT:
            colours = displacement_field(drawing, moved)
        elif field is not None:
            colours = element_field(drawing, state, field, self.strained)
            colours = smoothed(drawing, colours) if smooth else colours
        label = self.state_names[number] if len(self.cases) > 1 else str(self.cases[number])
        return plot_structure(
            drawing,
            moved,
            field=colours,
            scale=scale,
            undeformed=undeformed,
            loads=self.applied(number),
            title=f"{self.model.name}: {label}" if label else self.model.name,
            mesh=mesh,
            ax=ax,
        )

    def summary(self) -> dict[str, Any]:
        """Status, and maximum displacement and sum of the reactions of each state."""
        return structural_summary(self)

    def report(  # type: ignore[override]
        self,
        path: str | Path,
        units: Sequence[str] = (),
        views: Sequence[Mapping[str, Any]] = (),
        live: bool | None = None,
        responses: Sequence[PageResponse] = (),
    ) -> Path:
        """Write the interactive report, one self-contained HTML file.

        In the live page of a small structure every parameter is a slider: the page solves linear
        statics, or the eigenvalue problem of vibration, again while it moves.

        Parameters
        ----------
        units : units of the page, such as ``["mm", "MPa"]``; each applies to its dimension
        views : further cards, from functions of ``dalembert.report.views``
        live : whether the page is live; by default if the model has parameters with bounds, at most
            150 free displacements, and compiled functions of at most 300 kB. A page that is not
            live states the reason
        responses : responses that a live page lists with their slopes, such as
            ``[da.maximum("bar.stress")]``; by default the largest displacement and quantity of the
            elements, mass and compliance, or the frequencies of modes

        Raises
        ------
        UnsupportedError
            A page does not compute one of the responses.
        """
        from dalembert.report.page import write_page

        page = self.page(units=units, views=views)
        return write_page(self.live_page(page, live, responses, units=units), path)

    def first_responses(self) -> list[FirstResponse]:
        from dalembert.results.structural.formulas import first_responses

        return first_responses(self)

    def page(
        self, units: Sequence[str] = (), views: Sequence[Mapping[str, Any]] = ()
    ) -> dict[str, Any]:
        from dalembert.results.structural.payload import structural_payload

        return structural_payload(self, units) | {"views": list(views)}


def structural_summary(result: StructuralStates) -> dict[str, Any]:
    """Status, and maximum displacement and sum of the reactions of each state."""
    summary: dict[str, Any] = {
        "status": str(result.status),
        "residual": result.status.residual,
        "statistics": result.statistics,
        "warnings": list(result.warnings),
    }
    summary["states"] = rows = [
        {
            result.kind_of_state: label,
            "largest displacement": _largest(result, k),
            "sum of reactions": _reactions(result, k),
        }
        for k, label in enumerate(result.state_names)
    ]
    if len(rows) == 1:
        totals = {name: result.values(name) for name in result.totals}
        summary["totals"] = {name: float(value[0]) for name, value in totals.items()}
    return summary


def _largest(result: StructuralStates, k: int) -> dict[str, Any]:
    """Magnitude and node of the maximum displacement."""
    degrees = result.model.degrees
    table = degrees.table[:, : degrees.dimension]
    size = np.linalg.norm(np.where(table >= 0, result.displacements[table, k], 0.0), axis=1)
    node = int(np.argmax(size))
    return {"value": float(size[node]), "unit": "m", "node": degrees.nodes.name(node)}


def _reactions(result: StructuralStates, k: int) -> dict[str, float]:
    """Sum of the forces of the supports along each direction [N]."""
    degrees, prescribed = result.model.degrees, result.model.assembly.prescribed
    sums = {}
    for axis, direction in enumerate(degrees.directions[: degrees.dimension]):
        numbers = np.intersect1d(degrees.table[:, axis], prescribed)
        sums[direction.replace("u", "f", 1)] = float(result.forces[numbers, k].sum())
    return sums


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
    ax: Axes | None = None,
) -> Axes:
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
    from dalembert.results.pictures.mesh_picture import MeshPicture
    from dalembert.results.structural.scene import automatic_scale, structural_scene

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
