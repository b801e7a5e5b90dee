"""Motion: the result of an analysis over time."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np

from dalembert.model.model import Model
from dalembert.results.status import Status
from dalembert.symbolic.expression import Expression

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


@dataclass(frozen=True)
class Trajectory:
    """States at the output times, columns by time.

    Attributes
    ----------
    t : (K,) ; y, v, a : (n, K) ; multiplier : (m, K) ; work : (2, K) dissipated energy and input
    """

    t: np.ndarray
    y: np.ndarray
    v: np.ndarray
    a: np.ndarray
    multiplier: np.ndarray
    work: np.ndarray


@dataclass(frozen=True)
class EventRecord:
    """An event that happened."""

    name: str
    time: float


@dataclass(eq=False)
class Motion:
    """Motion of a mechanism with everything that can be measured on it.

    Attributes
    ----------
    model : Model the motion belongs to
    analysis : the analysis that made it, e.g. ``Dynamics(...)``
    parameters : (np,) parameter values used
    trajectory : Trajectory
    status : Status
    statistics : name → number or text, for people
    events : what happened when
    record : what a gradient needs of the run (steps taken, branches to the outputs)
    """

    model: Model
    analysis: Any
    parameters: np.ndarray
    trajectory: Trajectory
    status: Status
    statistics: dict[str, Any] = field(default_factory=dict)
    events: list[EventRecord] = field(default_factory=list)
    record: Any = None

    @property
    def time(self) -> np.ndarray:
        """(K,) output times [s]."""
        return self.trajectory.t

    def values(self, measure: str | Expression) -> np.ndarray:
        """(K,) or (K, size) values of a measure, a formula or an expression."""
        expression = self.expression(measure)
        e, s = self.model.equations, self.trajectory
        function = ca.Function(
            "measure",
            [e.t, e.y, e.v, e.a, e.multiplier, e.p],
            [ca.densify(self.model.measurable(expression.sx))],
        )
        if not s.t.size:
            return np.zeros((0,))
        table = function.map(s.t.size)(
            s.t, s.y, s.v, s.a, s.multiplier, np.tile(self.parameters[:, None], s.t.size)
        ).full()
        return table[0] if table.shape[0] == 1 else table.T

    def expression(self, measure: str | Expression) -> Expression:
        if isinstance(measure, Expression):
            return measure
        written = any(c in measure for c in "+-*/( ")
        return self.model.formula(measure) if written else self.model[measure]

    def __getitem__(self, measure: str | Expression) -> xr.DataArray:
        """A measure by name, or a formula of measures, as a labelled array over time.

        Raises
        ------
        KeyError
            Unknown name, with the nearest known ones.
        """
        import xarray as xr

        if isinstance(measure, str) and measure in DATA_ONLY:
            return self.data[measure]
        expression = self.expression(measure)
        values = self.values(expression)
        dims = ["time"] if values.ndim == 1 else ["time", "axis"]
        name = expression.name or (measure if isinstance(measure, str) else "measure")
        coords: dict[str, Any] = {"time": ("time", self.time, {"units": "s"})}
        if values.ndim == 2:
            coords["axis"] = list("xy")
        return xr.DataArray(
            values,
            dims=dims,
            coords=coords,
            name=name,
            attrs={"units": expression.unit, "long_name": name},
        )

    def at(self, times: np.ndarray) -> Motion:
        """The same motion sampled at other times, by the steps that were taken."""
        return self.analysis.resample(self, np.asarray(times, dtype=float))

    @cached_property
    def data(self) -> xr.Dataset:
        """Everything, labelled: poses, speeds, reactions, efforts, energies, violations."""
        from dalembert.results.dataset import motion_dataset

        return motion_dataset(self)

    # files and pictures ------------------------------------------------------------
    def save(self, path: str | Path, plots=None, trace=None) -> Path:
        """Write all results to a NetCDF file; ``load_results`` reads it back.

        ``plots`` and ``trace`` are kept for its report, as in ``report``.
        """
        from dalembert.results.store import save_motion

        return save_motion(self, path, plots, trace)

    def to_dataframe(self) -> pd.DataFrame:
        """One row per time, one column per scalar quantity."""
        from dalembert.results.store import flat_table

        return flat_table(self.data)

    def to_csv(self, path: str | Path) -> Path:
        """Write ``to_dataframe`` as CSV."""
        from dalembert.results.store import save_csv

        return save_csv(self.data, path)

    def plot(self, *measures: str | Expression, ax=None):
        """Draw measures over time with Matplotlib; returns the axes."""
        from dalembert.results.plot import plot_measures

        return plot_measures(self, measures, ax)

    def animate(self, **options):
        """Animation of the mechanism (Matplotlib); shown by notebooks."""
        from dalembert.results.animation import animate

        return animate(self, **options)

    def report(self, path: str | Path, plots=None, trace=None) -> Path:
        """Write the interactive report, one self-contained HTML file."""
        from dalembert.report.page import write_page
        from dalembert.results.payload import report_payload

        return write_page(report_payload(self, plots, trace), path)

    def _repr_html_(self) -> str:
        return self.data._repr_html_()

    def __repr__(self) -> str:
        span = f"{self.time[0]:g}…{self.time[-1]:g} s" if self.time.size else "no times"
        return f"<Motion of {self.model.name!r}: {self.time.size} times, {span}, {self.status}>"


DATA_ONLY = {
    "energy",
    "dissipated_energy",
    "input_energy",
    "balance_error",
    "position_violation",
    "velocity_violation",
}
