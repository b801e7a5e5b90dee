"""Everything scalar that a structure does under its load cases, by the names of measures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.errors import DalembertError

if TYPE_CHECKING:
    import pandas as pd


def measure_table(result: Any) -> pd.DataFrame:
    """One row per load case, one column per measure; units in ``attrs``.

    Displacements, forces on nodes, and stresses, forces and energies of the elements; of sets with
    many members what reduces them.
    """
    import pandas as pd

    model, columns, units = result.model, {}, {}
    known = dict(zip(model.degrees.names, result.displacements, strict=True))
    for name in model.names.known():
        try:
            measure = model[name]
            values = known[name] if name in known else result.values(name)
        except DalembertError:  # parameters, and what this analysis does not have
            continue
        if np.ndim(values) == 1 and not np.all(np.isnan(values)):
            columns[name], units[name] = values, measure.unit
    table = pd.DataFrame(columns, index=pd.Index(result.cases, name="case"))
    table.attrs["units"] = units
    return table


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
