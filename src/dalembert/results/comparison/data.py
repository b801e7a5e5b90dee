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
    "step": ("s", "step length of methods with fixed steps"),
    "tolerance": ("", "relative and absolute tolerance of methods that control their steps"),
    "steps": ("", "steps taken"),
    "rejected": ("", "steps refused by the error control"),
    "time": ("s", "integration alone, the shortest of the repetitions"),
    "time_per_step": ("µs", "integration time per step taken"),
    "preparation": ("s", "from the model to the first step: derivation and compilation"),
    "position_violation": ("m or rad", "largest violation of a constraint"),
    "velocity_violation": ("m/s or rad/s", "largest violation of a velocity constraint"),
    "energy_error": ("", "largest energy balance error / largest kinetic energy"),
    "error_position": ("", "largest difference of the measure from the reference"),
    "error_position_final": ("", "the same at the end"),
    "error_velocity": ("", "largest difference of the rate of the measure"),
    "error_velocity_final": ("", "the same at the end"),
    "error_reaction": ("N", "largest difference of a component of a joint force"),
    "error_reaction_final": ("N", "the same at the end"),
    "below_uncertainty": ("", "the position error is not above the reference's own uncertainty"),
    "outcome": ("", "how the run ended, or the kind of error"),
    "message": ("", "why"),
    "warnings": ("", "what speaks against the choice"),
}
"""Column → unit and meaning."""

TEXTS = (*STRATEGIES, "outcome", "message", "warnings")
BETWEEN = " | "
"""Between the warnings of a run."""


@dataclass(eq=False, repr=False)
class ComparisonData:
    """Runs of one mechanism under many choices.

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
        """All combinations were tried; False after an interruption."""
        return bool(self.data.attrs["complete"])

    @property
    def finished(self) -> np.ndarray:
        """Whether each run reached the end as asked."""
        return self.data["outcome"].values == Outcome.COMPLETED.value

    @property
    def uncertainty(self) -> float:
        """Largest difference of the measure between the reference and its check."""
        return float(self.data.attrs["uncertainty_position"])

    def sel(self, **choices: Any) -> Self:
        """The rows whose columns have these values; a list means any of them.

        Raises
        ------
        AnalysisError
            An unknown column.
        """
        kept = np.ones(self.data.sizes["run"], dtype=bool)
        for name, wanted in choices.items():
            if name not in COLUMNS:
                raise AnalysisError(f"no column {name!r}; known: {', '.join(COLUMNS)}")
            several = isinstance(wanted, (list, tuple, set))
            kept &= np.isin(self.data[name].values, list(wanted) if several else [wanted])
        return type(self)(self.data.isel(run=np.flatnonzero(kept)))

    def fastest(self, error: float) -> dict[str, Any] | None:
        """The row of the fastest run whose position error is at most ``error``, or None."""
        found = self.table()[self.finished]
        found = found[found["error_position"] <= error]
        return found.loc[found["time"].idxmin()].to_dict() if len(found) else None

    def orders(self) -> pd.DataFrame:
        """Observed order ``d ln(error) / d ln(step)`` of every combination with fixed steps.

        From the two shortest steps whose position errors stand ten times above the uncertainty.
        """
        good = self.table()[self.finished]
        good = good[(good["error_position"] > 10 * self.uncertainty) & good["tolerance"].isna()]
        good = good[good["step"].notna()]
        made = []
        for names, rows in good.groupby(list(STRATEGIES), sort=False):
            pair = rows.sort_values("step").head(2)
            if len(pair) == 2:
                error, step = np.log(pair["error_position"]), np.log(pair["step"])
                slope = float(np.diff(error)[0] / np.diff(step)[0])
                made.append(dict(zip(STRATEGIES, names, strict=True)) | {"order": slope})
        import pandas as pd

        return pd.DataFrame(made, columns=[*STRATEGIES, "order"])
