"""Rows of a comparison: cost, violations and errors of many runs of one mechanism."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from dalembert.errors import AnalysisError
from dalembert.results.status import Outcome

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

STRATEGIES = ("formulation", "coordinates", "stabilization", "integrator")

COLUMNS = {
    "formulation": ("", ""),
    "coordinates": ("", ""),
    "stabilization": ("", ""),
    "integrator": ("", ""),
    "step": ("s", "step size of methods with fixed steps"),
    "tolerance": ("", "relative and absolute tolerance of methods that control their steps"),
    "steps": ("", "steps taken"),
    "rejected": ("", "steps rejected by the error control"),
    "time": ("s", "integration only, minimum of the repetitions"),
    "time_per_step": ("µs", "integration time per accepted step"),
    "preparation": ("s", "from the model to the first step: derivation and compilation"),
    "position_violation": ("m or rad", "maximum violation of a constraint"),
    "velocity_violation": ("m/s or rad/s", "maximum violation of a velocity constraint"),
    "energy_error": ("", "maximum energy balance error / maximum kinetic energy"),
    "error_position": ("", "maximum difference of the measure from the reference"),
    "error_position_final": ("", "the same at the final time"),
    "error_velocity": ("", "maximum difference of the rate of the measure"),
    "error_velocity_final": ("", "the same at the final time"),
    "error_reaction": ("N", "maximum difference of a component of a joint force"),
    "error_reaction_final": ("N", "the same at the final time"),
    "below_uncertainty": ("", "the position error is within the uncertainty of the reference"),
    "outcome": ("", "outcome of the run, or the kind of error"),
    "message": ("", "reason"),
    "warnings": ("", "reservations about the choice"),
}
"""Column → unit and meaning."""

TEXTS = (*STRATEGIES, "outcome", "message", "warnings")
BETWEEN = " | "
"""Separator of the warnings of a run."""


@dataclass(eq=False, repr=False)
class ComparisonData:
    """Runs of one mechanism with different strategies.

    Attributes
    ----------
    data : xarray.Dataset, one entry of ``run`` per combination
    """

    data: xr.Dataset

    def table(self) -> pd.DataFrame:
        """One row per combination, in the order in which they ran."""
        return self.data.to_dataframe()[list(COLUMNS)]

    @property
    def complete(self) -> bool:
        """Whether all combinations were run; False after an interruption."""
        return bool(self.data.attrs["complete"])

    @property
    def finished(self) -> np.ndarray:
        """Whether each run was completed."""
        return self.data["outcome"].values == Outcome.COMPLETED.value

    @property
    def uncertainty(self) -> float:
        """Maximum difference of the measure between the reference and its check."""
        return float(self.data.attrs["uncertainty_position"])

    def sel(self, **choices: Any) -> Self:
        """The rows whose columns have these values; a list selects any of its values.

        Raises
        ------
        AnalysisError
            An unknown column.
        """
        mask = np.ones(self.data.sizes["run"], dtype=bool)
        for name, value in choices.items():
            if name not in COLUMNS:
                raise AnalysisError(f"no column {name!r}; known: {', '.join(COLUMNS)}")
            several = isinstance(value, (list, tuple, set))
            mask &= np.isin(self.data[name].values, list(value) if several else [value])
        return type(self)(self.data.isel(run=np.flatnonzero(mask)))

    def fastest(self, error: float) -> dict[str, Any] | None:
        """The row of the fastest run whose position error is at most ``error``, or None."""
        rows = self.table()[self.finished]
        rows = rows[rows["error_position"] <= error]
        return rows.loc[rows["time"].idxmin()].to_dict() if len(rows) else None

    def orders(self) -> pd.DataFrame:
        """Observed order ``d ln(error) / d ln(step)`` of every combination with fixed steps.

        From the two smallest steps whose position errors exceed ten times the uncertainty.
        """
        accurate = self.table()[self.finished]
        accurate = accurate[
            (accurate["error_position"] > 10 * self.uncertainty) & accurate["tolerance"].isna()
        ]
        accurate = accurate[accurate["step"].notna()]
        orders = []
        for names, rows in accurate.groupby(list(STRATEGIES), sort=False):
            pair = rows.sort_values("step").head(2)
            if len(pair) == 2:
                error, step = np.log(pair["error_position"]), np.log(pair["step"])
                slope = float(np.diff(error)[0] / np.diff(step)[0])
                orders.append(dict(zip(STRATEGIES, names, strict=True)) | {"order": slope})
        import pandas as pd

        return pd.DataFrame(orders, columns=[*STRATEGIES, "order"])
