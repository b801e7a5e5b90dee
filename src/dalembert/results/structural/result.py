"""Result of a structural analysis: states under load cases and their measures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.elements.fem.nodal import ROTATIONS
from dalembert.errors import DalembertError
from dalembert.model.assembled.measures import State
from dalembert.model.assembled.model import StructuralModel
from dalembert.results.analysis import Analysis
from dalembert.results.files.contents import Contents
from dalembert.results.files.tables import checked_units
from dalembert.results.result import Instants
from dalembert.results.sampling import checked_numbers
from dalembert.results.status import Status
from dalembert.results.structural.measured_states import MeasuredStates
from dalembert.results.structural.outputs import StructuralOutputs
from dalembert.symbolic.formulas.expression import Expression
from dalembert.units.unit import shown_in

if TYPE_CHECKING:
    import pandas as pd


@dataclass(eq=False, repr=False)
class StructuralResult(MeasuredStates, StructuralOutputs):
    """Displacements and external forces of a structure under its load cases.

    Attributes
    ----------
    model : StructuralModel that was solved
    analysis : analysis that computed it
    parameters : (np,) values used
    cases : names of the load cases
    displacements, forces : (n, cases); forces are applied ones and reactions
    status : Status
    record : data of each case for gradients (the factorised stiffness)
    warnings : reservations about the chosen methods, each with the number that shows it
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
    """Load cases are discrete: integrals over them are sums."""
    along = "case"
    """Dimension of the states."""

    @property
    def time(self) -> np.ndarray:  # type: ignore[override]
        """(cases,) numbers of the load cases, in the role of the instants of a motion."""
        return np.arange(len(self.cases), dtype=float)

    def at(self, cases: Instants) -> StructuralResult:
        """The result for some load cases, by number."""
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
        """Value of a measure; an array for several load cases."""
        values = self.values(measure)
        return float(values[0]) if values.size == 1 else values

    @cached_property
    def contents(self) -> Contents:
        """Displacements and forces of nodes, stresses and forces of elements."""
        along, coords = self.along, {"degree": self.model.degrees.names, self.along: self._labels}
        variables: dict[str, Any] = {
            "displacement": (("degree", along), self.displacements, {"units": "m or rad"}),
            "external_force": (("degree", along), self.forces, {"units": "N or N m"}),
        }
        for name, (elements, rows, unit) in element_variables(self).items():
            coords[f"{name}_of"] = elements
            variables[name] = ((f"{name}_of", along), np.array(rows), {"units": unit})
        return Contents.from_arrays(variables, coords, self.attributes)

    @property
    def _labels(self) -> Any:
        """Labels of the states along their dimension."""
        return self.cases

    def to_dataframe(self) -> pd.DataFrame:
        """One row per measure, with name and unit; one column per load case."""
        return measure_table(self)

    def to_csv(self, path: str | Path, units: Sequence[str] = ()) -> Path:
        """Write ``to_dataframe`` as CSV, in preferred units such as ``["mm", "MPa"]``."""
        from dalembert.results.files.store import save_table

        return save_table(measure_table(self, units), path)

    def __repr__(self) -> str:
        count = len(self.cases)
        return f"<StructuralResult of {self.model.name!r}: {count} load case(s), {self.status}>"


def measure_table(result: Any, units: Sequence[str] = ()) -> pd.DataFrame:
    """One row per measure with its unit, one column per load case.

    Displacements and forces of all nodes, and stresses, forces and energies of the elements;
    extremes and sums for sets with many members.

    Parameters
    ----------
    units : preferred units, one per dimension; SI units by default
    """
    import pandas as pd

    preferred, model = checked_units(units), result.model
    rows: dict[str, tuple[str, np.ndarray]] = {}
    for name, displacement, force in zip(
        model.degrees.names, result.displacements, result.forces, strict=True
    ):
        node, _, direction = name.rpartition(".")
        turns = direction in ROTATIONS[3]
        dual = direction.replace("u", "f").replace("r", "m")
        rows[name] = ("rad" if turns else "m", displacement)
        rows[f"{node}.{dual}"] = ("N m" if turns else "N", force)
    for name in model.names.known():
        if name in rows:
            continue
        try:
            values = result.values(name)
        except DalembertError:  # parameters, and measures that this analysis does not have
            continue
        if np.ndim(values) == 1 and not np.all(np.isnan(values)):
            rows[name] = (model[name].unit, values)
    conversions = [shown_in(unit, preferred) for unit, _ in rows.values()]
    table = np.array([v for _, v in rows.values()]) / np.array([[f] for f, _ in conversions])
    cases = [str(case) or "value" for case in result.cases]
    frame = pd.DataFrame(table, index=pd.Index(rows, name="measure"), columns=cases)
    frame.insert(0, "unit", ["" if label == "1" else label for _, label in conversions])
    return frame


def element_variables(result: Any) -> dict[str, Any]:
    """Measures of single elements: ``element_stress`` over ``element_stress_of``, …"""
    variables: dict[str, Any] = {}
    for block in result.model.blocks:
        names = [name for name in block.names.owners if name in block.names]
        for quantity in block.kind.measures if names else ():
            try:
                rows = [result.values(f"{name}.{quantity}") for name in names]
            except DalembertError:
                continue
            unit = result.model[f"{names[0]}.{quantity}"].unit
            entry = variables.setdefault(f"element_{quantity}", ([], [], unit))
            entry[0].extend(names)
            entry[1].extend(rows)
    return variables
