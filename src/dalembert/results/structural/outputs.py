"""What people take out of a structural result: pictures, the report, files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dalembert.results.structural.states import StructuralStates

if TYPE_CHECKING:
    import pandas as pd


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

    def report(self, path: str | Path) -> Path:
        """Write the interactive report, one self-contained HTML file."""
        from dalembert.report.page import write_page
        from dalembert.results.structural.payload import structural_payload

        return write_page(structural_payload(self), path)

    def save(self, path: str | Path) -> Path:
        """Write all results to a NetCDF file; ``load_results`` reads it back."""
        from dalembert.results.store import save_with_report
        from dalembert.results.structural.payload import structural_payload

        return save_with_report(self.data, structural_payload(self), path)

    def to_dataframe(self) -> pd.DataFrame:
        """One row per case and displacement."""
        return self.data.to_dataframe()

    def to_csv(self, path: str | Path) -> Path:
        """Write ``to_dataframe`` as CSV."""
        from dalembert.results.store import save_table

        return save_table(self.to_dataframe(), path)
