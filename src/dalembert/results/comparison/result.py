"""Comparison of strategies, the result of ``compare``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.files import atomic_path
from dalembert.results.comparison.data import COLUMNS, TEXTS, ComparisonData

if TYPE_CHECKING:
    from matplotlib.axes import Axes


@dataclass(eq=False, repr=False)
class Comparison(ComparisonData):
    """Runs of one mechanism with different strategies, from ``compare`` or a saved dataset.

    Attributes
    ----------
    data : xarray.Dataset, one entry of ``run`` per combination

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pendulum", gravity=(0, -10))
    >>> bar = system.add(planar.Bar("bar", length=1.0, mass=2.0))
    >>> hinge = system.add(planar.Revolute("O", system.ground.center, bar.start))
    >>> forms = ["RangeSpace", "KKT"]
    >>> runs = da.compare(system.build(), 0.2, formulations=forms, integrators="RK4", steps=0.01)
    >>> isinstance(runs, da.Comparison), runs.data["outcome"].values.tolist()
    (True, ['completed', 'completed'])
    """

    def summary(self) -> list[str]:
        """The main findings of the table, in a few sentences."""
        from dalembert.results.comparison.table import summary

        return summary(self)

    # files and pictures --------------------------------------------------------------
    def plot(self, kind: str = "work-precision", ax: Axes | None = None) -> Any:
        """Draw with Matplotlib: ``"work-precision"``, ``"violations"`` or ``"energy"``.

        Returns the axes (two of them for violations, where ``ax`` is a pair).

        Raises
        ------
        AnalysisError
            Unknown kind, or nothing to draw.
        """
        from dalembert.results.comparison.plot import plot_comparison

        return plot_comparison(self, kind, ax)

    def save_plot(self, path: str | Path, kind: str = "work-precision") -> Path:
        """Write a picture; the suffix selects the format: .png, .svg or .pdf."""
        import matplotlib.pyplot as plt

        figure = np.atleast_1d(self.plot(kind))[0].figure
        with atomic_path(path) as temporary:
            figure.savefig(temporary, dpi=150)
        plt.close(figure)
        return Path(path)

    def to_csv(self, path: str | Path) -> Path:
        """Write the table as CSV, atomically."""
        with atomic_path(path) as temporary:
            self.table().to_csv(temporary, index_label="run")
        return Path(path)

    def save(self, path: str | Path) -> Path:
        """Write a NetCDF file; ``Comparison(load_results(path))`` reads it back."""
        from dalembert.results.files.store import save_dataset

        return save_dataset(self.data, path)

    def __repr__(self) -> str:
        return "\n".join([f"<Comparison of {self.data.sizes['run']} runs>", *self.summary()])

    def _repr_html_(self) -> str:
        from dalembert.results.comparison.table import html_table

        return html_table(self)


def comparison_of(rows: Sequence[Mapping[str, Any]], attributes: Mapping[str, Any]) -> Comparison:
    """A comparison from its rows; missing numbers are NaN."""
    import xarray as xr

    data = {}
    for name, (unit, text) in COLUMNS.items():
        if name in TEXTS:
            values = np.array([str(row.get(name, "")) for row in rows], dtype=object)
        elif name == "below_uncertainty":
            values = np.array([bool(row.get(name, False)) for row in rows], dtype=bool)
        else:
            numbers = (row.get(name) for row in rows)
            values = np.array([math.nan if x is None else x for x in numbers], dtype=float)
        data[name] = ("run", values, {"units": unit, "long_name": text})
    return Comparison(xr.Dataset(data, {"run": np.arange(len(rows))}, attrs=dict(attributes)))
