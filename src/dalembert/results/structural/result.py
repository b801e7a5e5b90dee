"""The result of a structural analysis: states under load cases and any measure of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.results.files.contents import Contents
from dalembert.results.result import Analysis, Instants
from dalembert.results.sampling import checked_numbers
from dalembert.results.status import Status
from dalembert.results.structural.measured_states import MeasuredStates
from dalembert.results.structural.outputs import StructuralOutputs
from dalembert.structures.measuring.measures import State
from dalembert.structures.model import StructuralModel
from dalembert.symbolic.formulas.expression import Expression

if TYPE_CHECKING:
    import pandas as pd


@dataclass(eq=False, repr=False)
class StructuralResult(MeasuredStates, StructuralOutputs):
    """Displacements and external forces of a structure under its load cases.

    Attributes
    ----------
    model : StructuralModel that was solved
    analysis : the analysis that made it
    parameters : (np,) values used
    cases : names of the load cases
    displacements, forces : (n, cases); forces are applied ones and reactions
    status : Status
    record : what a gradient needs of each case (the factorised stiffness)
    warnings : doubts about the choices made, each with the number that shows it
    """

    model: StructuralModel
    analysis: Analysis
    parameters: np.ndarray
    cases: list[str]
    displacements: np.ndarray
    forces: np.ndarray
    status: Status
    statistics: dict[str, Any] = field(default_factory=dict)
    record: Any = None
    warnings: Sequence[str] = ()

    continuous = False
    """There is nothing between two load cases: integrals over them are sums."""
    along = "case"
    """Dimension of the states."""

    @property
    def time(self) -> np.ndarray:  # type: ignore[override]
        """(cases,) numbers of the load cases: what instants are to a motion."""
        return np.arange(len(self.cases), dtype=float)

    def at(self, cases: Instants) -> StructuralResult:
        """The result of some load cases, by number."""
        index = checked_numbers(cases, len(self.cases), "load cases")
        return replace(
            self,
            cases=[self.cases[k] for k in index],
            displacements=self.displacements[:, index],
            forces=self.forces[:, index],
            record=[self.record[k] for k in index],
        )

    def state(self, case: int) -> State:
        """Displacements and forces of one case."""
        temperatures = self.model.loads[self.cases[case]].temperatures
        u, forces = self.displacements[:, case], self.forces[:, case]
        return State(u, forces, self.parameters, temperatures=temperatures)

    def __getitem__(self, measure: str | Expression) -> float | np.ndarray:
        """Value of a measure; an array over the load cases where there are several."""
        found = self.values(measure)
        return float(found[0]) if found.size == 1 else found

    @cached_property
    def contents(self) -> Contents:
        """Displacements and forces of nodes, stresses and forces of elements."""
        from dalembert.results.structural.measure_table import element_variables

        along, coords = self.along, {"degree": self.model.degrees.names, self.along: self._labels}
        found: dict[str, Any] = {
            "displacement": (("degree", along), self.displacements, {"units": "m or rad"}),
            "external_force": (("degree", along), self.forces, {"units": "N or N m"}),
        }
        for name, (elements, rows, unit) in element_variables(self).items():
            coords[f"{name}_of"] = elements
            found[name] = ((f"{name}_of", along), np.array(rows), {"units": unit})
        return Contents.given(found, coords, self.about)

    @property
    def _labels(self) -> Any:
        """Of the states, along their dimension."""
        return self.cases

    def to_dataframe(self) -> pd.DataFrame:
        """One row per measure, by name and with its unit; one column per load case."""
        from dalembert.results.structural.measure_table import measure_table

        return measure_table(self)

    def to_csv(self, path: str | Path, units: Sequence[str] = ()) -> Path:
        """Write ``to_dataframe`` as CSV, in the units wanted, such as ``["mm", "MPa"]``."""
        from dalembert.results.files.store import save_table
        from dalembert.results.structural.measure_table import measure_table

        return save_table(measure_table(self, units), path)

    def __repr__(self) -> str:
        count = len(self.cases)
        return f"<StructuralResult of {self.model.name!r}: {count} load case(s), {self.status}>"
