"""Pareto front: a set of nondominated designs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.decision import Decision, axis_label, plot_axes
from dalembert.results.result import Result

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes

    from dalembert.design.ecosystem.functions import DesignFunctions
    from dalembert.design.pages.live import LiveTask
    from dalembert.design.quantity import Quantity


REPEATED = 1e-6
"""Difference of two designs of a front that is round-off of the searches [range of each aim]."""


def nondominated(values: np.ndarray) -> np.ndarray:
    """Indices of the rows that no other row dominates; repeated rows count once."""
    indices = []
    for k, row in enumerate(values):
        dominated = np.all(values <= row, axis=1) & np.any(values < row, axis=1)
        repeated = np.all(values[:k] == row, axis=1)
        if not dominated.any() and not repeated.any():
            indices.append(k)
    return np.array(indices, dtype=int)


def distinct(values: np.ndarray) -> np.ndarray:
    """Indices of the rows that differ from all rows before by more than ``REPEATED``."""
    span = np.ptp(values, axis=0)
    indices: list[int] = []
    for k, row in enumerate(values):
        differences = np.abs(values[indices] - row) > REPEATED * span
        if np.all(differences.any(axis=1)):
            indices.append(k)
    return np.array(indices, dtype=int)


@dataclass(eq=False)
class ParetoResult(Decision):
    """Result of ``pareto``.

    Attributes
    ----------
    labels, units : of the aims
    names : of the parameters
    values : (points, aims), sorted by the first aim
    designs : (points, parameters)
    message : method and remarks
    runs : number of runs of the analysis
    interrupted : ended by Ctrl-C, with the points so far
    quantities : the aims, then limited quantities

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> rod = da.Structure("spring")
    >>> k = rod.parameter("k", 5.0, bounds=(1, 10))
    >>> end = rod.node("end", 0)
    >>> part = rod.add(structures.GroundSpring("spring", end, stiffness_x=k))
    >>> rod.load(end, fx=20.0)
    >>> aims = [da.final("k", name="effort"), da.final("end.ux", name="give")]
    >>> front = da.pareto(rod.build(), aims, analysis=da.Statics(), points=4)
    >>> isinstance(front, da.ParetoResult), front.labels
    (True, ['effort', 'give'])
    >>> front.values[[0, -1]].round(6).tolist()  # the ends
    [[1.0, 20.0], [10.0, 2.0]]
    """

    file_suffix = "pareto"
    page_functions = "front:front"
    labels: list[str]
    units: list[str]
    names: list[str]
    values: np.ndarray
    designs: np.ndarray
    senses: list[float]
    message: str
    runs: int = 0
    gradients: int = 0
    failed: list[str] = field(default_factory=list)
    name: str = ""
    parameter_units: list[str] = field(default_factory=list)
    interrupted: bool = False
    rerun: Callable[[int], Result | None] | None = field(default=None, repr=False)
    quantities: Sequence[Quantity] = field(default=(), repr=False)

    @property
    def success(self) -> bool:  # type: ignore[override]
        """Whether the search was completed; a single design is best in all aims."""
        return len(self) > 0 and not self.interrupted

    def __len__(self) -> int:
        return len(self.values)

    def design(self, k: int) -> dict[str, float]:
        """Parameter values of a point."""
        return dict(zip(self.names, map(float, self.designs[k]), strict=True))

    def hypervolume(self, reference: Sequence[float]) -> float:
        """Area dominated by the front up to a reference point, for two aims: larger is better.

        Raises
        ------
        ValueError
            The number of aims is not two.
        """
        if self.values.shape[1] != 2:
            raise ValueError("the hypervolume is implemented for two aims")
        points = self.values * self.senses
        limit = np.asarray(reference, dtype=float) * self.senses
        points = points[np.all(points < limit, axis=1)]
        points = points[np.argsort(points[:, 0])]
        edges = np.append(points[1:, 0], limit[0])
        return float(np.sum((edges - points[:, 0]) * (limit[1] - points[:, 1])))

    def result(self, k: int) -> Result | None:
        """Result at a point; None if it cannot be run again."""
        return None if self.rerun is None else self.rerun(k)

    @property
    def sentence(self) -> str:
        if len(self) == 1 and self.interrupted:
            return f"one design so far ({self.message})"
        if len(self) == 1:
            return f"one design, best in all aims ({self.message})"
        return f"{len(self)} designs, none better in all aims ({self.message})"

    def findings(self) -> dict[str, Any]:
        return {
            "aims": self.labels,
            "units": self.units,
            "senses": ["minimize" if s > 0 else "maximize" for s in self.senses],
            "points": [
                {"aims": dict(zip(self.labels, row, strict=True)), "parameters": self.design(k)}
                for k, row in enumerate(self.values.tolist())
            ],
            "runs": self.runs,
            "gradients": self.gradients,
            "failed": self.failed,
        }

    @property
    def data(self) -> xr.Dataset:
        """Aims and parameters of all points."""
        import xarray as xr

        return xr.Dataset(
            {
                "aims": (("point", "aim"), self.values),
                "parameters": (("point", "parameter"), self.designs),
                "aim_unit": ("aim", self.units),
            },
            {"point": range(len(self)), "aim": self.labels, "parameter": self.names},
            {"message": self.message, "runs": self.runs},
        )

    def table_of_designs(self) -> dict[str, Any]:
        """Table of aims and parameters for the page."""
        designs: dict[str, Any] = self._page_function("designs")(self)
        return designs

    def live_task(self) -> LiveTask | None:
        task: LiveTask | None = self._page_function("task")(self)
        return task

    def to_dataframe(self) -> pd.DataFrame:
        """One row per point: aims, then parameters."""
        import pandas as pd

        return pd.DataFrame(
            np.hstack([self.values, self.designs]), columns=[*self.labels, *self.names]
        )

    def plot(self, ax: Axes | None = None) -> Axes:
        """Plot the first two aims; returns the axes."""
        ax = plot_axes(ax, (5, 3.8))
        ax.plot(self.values[:, 0], self.values[:, 1], marker="o", ms=4, lw=1)
        labels = list(map(axis_label, self.labels, self.units))
        ax.set(xlabel=labels[0], ylabel=labels[1])
        return ax

    def __repr__(self) -> str:
        return f"<ParetoResult of {len(self)} designs: {', '.join(self.labels)}; {self.message}>"


def make_front(
    functions: DesignFunctions,
    senses: Sequence[float] | np.ndarray,
    values: np.ndarray,
    designs: np.ndarray,
    message: str,
    failed: list[str],
) -> ParetoResult:
    """Front of the nondominated designs, sorted by the first aim."""
    indices = nondominated(values)
    indices = indices[np.argsort(values[indices, 0])]
    problem, points = functions.problem, designs[indices]
    results = problem.results(points[0])
    parameters = [problem.variables.parameters(x) for x in points]
    case = problem.quantities[0].terms[0].case
    units = dict(zip(problem.variables.names, problem.variables.units, strict=True))
    return ParetoResult(
        functions.labels,
        [problem.unit(k, results) for k in range(functions.count)],
        list(parameters[0]),
        values[indices] * np.asarray(senses),
        np.array([list(row.values()) for row in parameters]),
        list(map(float, senses)),
        message,
        problem.runs,
        problem.gradients,
        failed,
        name=case.model.name,
        parameter_units=[units.get(n, case.model.parameters[n].unit) for n in parameters[0]],
        rerun=lambda k: problem.results(points[k]).get(case),
        quantities=problem.quantities,
    )
