"""Comparison: cost, violations and errors of many runs of one mechanism, one row per run."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.atomic import atomic_path
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
}
"""Column → unit and meaning."""

TEXTS = (*STRATEGIES, "outcome", "message")


def comparison_of(rows: Sequence[Mapping[str, Any]], attributes: Mapping[str, Any]) -> Comparison:
    """A comparison from its rows; numbers that a row lacks are not a number."""
    import xarray as xr

    data = {}
    for name, (unit, text) in COLUMNS.items():
        if name in TEXTS:
            values = np.array([str(row.get(name, "")) for row in rows], dtype=object)
        elif name == "below_uncertainty":
            values = np.array([bool(row.get(name, False)) for row in rows], dtype=bool)
        else:
            found = (row.get(name) for row in rows)
            values = np.array([math.nan if x is None else x for x in found], dtype=float)
        data[name] = ("run", values, {"units": unit, "long_name": text})
    return Comparison(xr.Dataset(data, {"run": np.arange(len(rows))}, attrs=dict(attributes)))


@dataclass(eq=False, repr=False)
class Comparison:
    """Runs of one mechanism under many choices; made by ``compare``, or from a saved dataset.

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
        return self.data.sizes["run"] == self.data.attrs["asked"] and not bool(
            np.any(self.data["outcome"].values == Outcome.INTERRUPTED.value)
        )

    @property
    def finished(self) -> np.ndarray:
        """Whether each run reached the end as asked."""
        return self.data["outcome"].values == Outcome.COMPLETED.value

    @property
    def uncertainty(self) -> float:
        """Largest difference of the measure between the reference and its check."""
        return float(self.data.attrs["uncertainty_position"])

    def sel(self, **choices: Any) -> Comparison:
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
        part = self.data.isel(run=np.flatnonzero(kept))
        return Comparison(part.assign_attrs(asked=int(kept.sum())))

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
        good = good[(good["error_position"] > 10 * self.uncertainty) & good["step"].notna()]
        made = []
        for names, rows in good.groupby(list(STRATEGIES), sort=False):
            pair = rows.sort_values("step").head(2)
            if len(pair) == 2:
                error, step = np.log(pair["error_position"]), np.log(pair["step"])
                slope = float(np.diff(error)[0] / np.diff(step)[0])
                made.append(dict(zip(STRATEGIES, names, strict=True)) | {"order": slope})
        import pandas as pd

        return pd.DataFrame(made, columns=[*STRATEGIES, "order"])

    def summary(self) -> list[str]:
        """What the table says, in a few sentences."""
        from dalembert.results.comparison_table import summary

        return summary(self)

    # files and pictures --------------------------------------------------------------
    def plot(self, kind: str = "work-precision", ax=None):
        """Draw with Matplotlib: ``"work-precision"``, ``"violations"`` or ``"energy"``.

        Returns the axes (two of them for violations, where ``ax`` is a pair).

        Raises
        ------
        AnalysisError
            Another kind, or nothing to draw.
        """
        from dalembert.results.comparison_plot import plot_comparison

        return plot_comparison(self, kind, ax)

    def to_csv(self, path: str | Path) -> Path:
        """Write the table as CSV, whole or not at all."""
        with atomic_path(path) as temporary:
            self.table().to_csv(temporary, index_label="run")
        return Path(path)

    def save(self, path: str | Path) -> Path:
        """Write a NetCDF file; ``Comparison(load_results(path))`` has it back."""
        from dalembert.results.store import save_dataset

        return save_dataset(self.data, path)

    def __repr__(self) -> str:
        return "\n".join([f"<Comparison of {self.data.sizes['run']} runs>", *self.summary()])

    def _repr_html_(self) -> str:
        from dalembert.results.comparison_table import html_table

        return html_table(self)
