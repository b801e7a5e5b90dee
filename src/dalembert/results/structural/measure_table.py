"""Everything scalar that a structure does under its load cases, by the names of measures."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.elements.fem.node import ROTATIONS
from dalembert.errors import DalembertError
from dalembert.results.files.headings import checked_units
from dalembert.units.unit import shown_in

if TYPE_CHECKING:
    import pandas as pd


def measure_table(result: Any, units: Sequence[str] = ()) -> pd.DataFrame:
    """One row per measure with its unit, one column per load case.

    Displacements and forces of all nodes, and stresses, forces and energies of the elements; of
    sets with many members what reduces them.

    Parameters
    ----------
    units : wanted, each for what has its dimension; SI units by default
    """
    import pandas as pd

    wanted, model = checked_units(units), result.model
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
        except DalembertError:  # parameters, and what this analysis does not have
            continue
        if np.ndim(values) == 1 and not np.all(np.isnan(values)):
            rows[name] = (model[name].unit, values)
    shown = [shown_in(unit, wanted) for unit, _ in rows.values()]
    table = np.array([v for _, v in rows.values()]) / np.array([[f] for f, _ in shown])
    cases = [str(case) or "value" for case in result.cases]
    made = pd.DataFrame(table, index=pd.Index(rows, name="measure"), columns=cases)
    made.insert(0, "unit", ["" if label == "1" else label for _, label in shown])
    return made


def element_variables(result: Any) -> dict[str, Any]:
    """``element_stress`` over ``element_stress_of``, …: what single elements are measured by."""
    found: dict[str, Any] = {}
    for block in result.model.blocks:
        names = [name for name in block.names.owners if name in block.names]
        for quantity in block.kind.measures if names else ():
            try:
                rows = [result.values(f"{name}.{quantity}") for name in names]
            except DalembertError:
                continue
            unit = result.model[f"{names[0]}.{quantity}"].unit
            old = found.setdefault(f"element_{quantity}", ([], [], unit))
            old[0].extend(names)
            old[1].extend(rows)
    return found
