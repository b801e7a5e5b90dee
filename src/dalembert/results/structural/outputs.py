"""What people take out of a structural result: pictures, the report, files."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from dalembert.results.structural.states import StructuralStates


class StructuralOutputs(StructuralStates):
    """Pictures, report and files of a structure's states."""

    def plot(
        self,
        field: str | None = None,
        case: str | int = 0,
        *,
        scale: float | str = "auto",
        undeformed: bool = True,
        smooth: bool = False,
        mesh: bool | None = None,
        ax: Any = None,
    ) -> Any:
        """Draw the deformed structure with its supports and loads; returns the axes.

        Parameters
        ----------
        field : quantity for the colours: of all elements that have it (``"von_mises"``), of one
            set (``"plate.von_mises"``), or ``"displacement"``
        case : load case, by name or number
        scale : factor of the displacements; a round one that shows well, told in the title
        undeformed : draw the structure at rest behind
        smooth : mean values at the nodes instead of one for each element
        mesh : draw the edges of the elements
        ax : axes of Matplotlib, new ones if None

        Raises
        ------
        AnalysisError
            There is no such quantity or case.
        """
        from dalembert.results.structural.drawing import StructuralDrawing
        from dalembert.results.structural.fields import (
            DISPLACEMENT,
            displacement_field,
            element_field,
            smoothed,
        )
        from dalembert.results.structural.plot import plot_structure

        number = self.case(case)
        drawing, state = StructuralDrawing(self.model, self.parameters), self.state(number)
        moved = drawing.displaced(state.u, self.large)
        colours = None
        if field == DISPLACEMENT:
            colours = displacement_field(drawing, moved)
        elif field is not None:
            colours = element_field(drawing, state, field)
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
        """Status, and the largest displacement and the sum of the reactions of each state."""
        from dalembert.results.structural.summary import structural_summary

        return structural_summary(self)

    def page(self, units: Sequence[str] = ()) -> dict[str, Any]:
        from dalembert.results.structural.payload import structural_payload

        return structural_payload(self, units)
