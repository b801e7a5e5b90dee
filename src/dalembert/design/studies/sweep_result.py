"""Result of a study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.decision import Decision, plot_axes
from dalembert.design.studies.design_table import DesignTable
from dalembert.errors import AnalysisError

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes

    from dalembert.design.pages.live import LiveTask
    from dalembert.design.studies.task import StudyTask

CSV_NOTE = "the table is CSV, because pyarrow is not installed: pip install 'dalembert[study]'"


@dataclass(frozen=True, eq=False)
class SweepResult(Decision):
    """Designs and their responses.

    Attributes
    ----------
    name : of the model
    design : the n designs
    responses : labels
    values : (n, responses); NaN for failed designs
    reasons : (n,) reason of failure; empty for successful designs
    folder : folder of the stored answers
    reused_count : number of answers that were already stored
    units : of parameters and responses, by name
    table_path : file of the whole table in the folder
    warnings : warnings of the designs with the smallest and largest responses, which run again on
        their own when the warnings are first read
    task : model, analysis and responses
    interrupted : ended by Ctrl-C; the reason of the designs that did not run is ``interrupted``

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> spring = da.Structure("spring")
    >>> k = spring.parameter("k", 50.0)
    >>> end = spring.node("end", 0)
    >>> part = spring.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> spring.load(end, fx=100.0)
    >>> designs = da.DesignTable.table({"k": [10.0, 0.0]})
    >>> give = da.final("end.ux")
    >>> study = da.sweep(spring.build(), designs, analysis=da.Statics(), responses=give)
    >>> isinstance(study, da.SweepResult), study.success.tolist(), study.values[0].round(6)
    (True, [True, False], array([10.]))
    """

    file_suffix = "study"
    page_functions = "study:study"
    name: str
    design: DesignTable
    responses: tuple[str, ...]
    values: np.ndarray
    reasons: tuple[str, ...]
    folder: Path | None = None
    reused_count: int = 0
    units: Mapping[str, str] = field(default_factory=dict)
    table_path: Path | None = None
    warnings: Sequence[str] = ()
    task: StudyTask | None = field(default=None, repr=False)
    interrupted: bool = False

    @property
    def message(self) -> str:  # type: ignore[override]
        """Number of successful designs, and whether the study was interrupted."""
        text = f"{int(self.success.sum())} of {len(self.design)} designs"
        return f"{text}; interrupted" if self.interrupted else text

    @property
    def success(self) -> np.ndarray:  # type: ignore[override]
        """(n,) whether the design succeeded."""
        return np.array([not reason for reason in self.reasons], dtype=bool)

    @property
    def failures(self) -> dict[int, str]:
        """Number of a failed design → reason."""
        return {k: reason for k, reason in enumerate(self.reasons) if reason}

    def column(self, response: str | None = None) -> np.ndarray:
        """(n,) values of one response; the name may be omitted if there is only one.

        Raises
        ------
        AnalysisError
            The name is unknown, or missing among several responses.
        """
        if response is None and len(self.responses) == 1:
            return self.values[:, 0]
        if response not in self.responses:
            listed = ", ".join(self.responses)
            raise AnalysisError(f"name one response of the study: {listed}; got {response!r}")
        return self.values[:, self.responses.index(response)]

    @property
    def columns(self) -> dict[str, Any]:
        """Number, parameters, responses and reasons, by name."""
        return {
            "design": np.arange(len(self.design)),
            **dict(zip(self.design.names, self.design.values.T, strict=True)),
            **dict(zip(self.responses, self.values.T, strict=True)),
            "reason": list(self.reasons),
        }

    @property
    def table(self) -> pd.DataFrame:
        """One row per design."""
        import pandas as pd

        return pd.DataFrame(self.columns).set_index("design")

    def findings(self) -> dict[str, Any]:
        return {
            "designs": len(self.design),
            "reused_count": self.reused_count,
            "failed": self.failures,
            "responses": {
                name: {
                    "unit": self.units.get(name, ""),
                    "minimum": column.min(),
                    "mean": column.mean(),
                    "maximum": column.max(),
                    "deviation": column.std(),
                }
                for name in self.responses
                if (column := self.column(name)[self.success]).size
            },
            "folder": str(self.folder),
            "table": None if self.table_path is None else str(self.table_path),
            "note": CSV_NOTE
            if self.table_path is not None and self.table_path.suffix == ".csv"
            else "",
        }

    @property
    def data(self) -> xr.Dataset:
        """Parameters, responses and reasons of all designs."""
        import xarray as xr

        dataset = xr.Dataset({n: ("design", c) for n, c in self.columns.items() if n != "design"})
        for name, unit in self.units.items():
            if name in dataset:
                dataset[name].attrs["units"] = unit
        return dataset.assign_coords(design=range(len(self.design)))

    def to_dataframe(self) -> pd.DataFrame:
        """One row per design."""
        return self.table

    def table_of_designs(self) -> dict[str, Any]:
        designs: dict[str, Any] = self._page_function("designs")(self)
        return designs

    def live_task(self) -> LiveTask | None:
        task: LiveTask | None = self._page_function("task")(self)
        return task

    def plot(self, x: str, response: str | None = None, ax: Axes | None = None) -> Axes:
        """Plot a response over a parameter; returns the axes."""
        ax = plot_axes(ax, (5, 3.6))
        if x not in self.design.names:
            raise AnalysisError(
                f"{x!r} does not vary; the study varies {', '.join(self.design.names)}"
            )
        ax.plot(self.design.values[:, self.design.names.index(x)], self.column(response), ".", ms=4)
        ax.set(xlabel=x, ylabel=response or self.responses[0])
        return ax

    def __repr__(self) -> str:
        failed = f", {len(self.failures)} failed" if self.failures else ""
        return f"<SweepResult of {self.name}: {len(self.design)} designs{failed}>"
