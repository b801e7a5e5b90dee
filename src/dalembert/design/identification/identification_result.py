"""Result of an identification: parameters, their confidence, and residuals."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.decision import Decision
from dalembert.design.identification.information import (
    WEAK,
    Combination,
    Information,
    rank_experiments,
)
from dalembert.design.identification.misfit import Misfit
from dalembert.results.result import Result
from dalembert.text.wording import counted

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure

    from dalembert.design.pages.live import LiveTask

MIN_SAMPLES = 20
"""Lower limit of the samples for testing the autocorrelation of residuals."""
UNFINISHED = "standard deviations and intervals are not meaningful away from the minimum"
ROUNDING = 1e-6
"""Threshold for residuals due to rounding and time steps, relative to the data range [-]."""


@dataclass(eq=False)
class IdentificationResult(Decision):
    """Result of ``identify``.

    Attributes
    ----------
    x : unknown → value
    success, message : status of the least-squares solver
    deviation : unknown → standard deviation, infinite if the data do not determine it
    noise : column → standard deviation of its noise, specified or estimated
    noise_specified : whether all noise was specified
    motions : results at the identified parameters, one per experiment
    predicted : (K, columns) of each experiment, NaN for samples that are not used
    at_bounds : unknowns at one of their bounds; their intervals are not meaningful
    interrupted : ended by Ctrl-C; the unknowns are the best reached
    minima : of several starts, cost and unknowns of the distinct minima, the best first; columns
        without specified noise are weighted by their scatter

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("throw")
    >>> v = system.parameter("v", 1.0, "m/s", bounds=(0, 10))
    >>> stone = system.add(planar.Particle("stone", mass=2.0, velocity=(v, 0)))
    >>> t = np.linspace(0, 2, 21)
    >>> noise = np.random.default_rng(1).normal(0, 0.01, t.size)
    >>> result = da.identify(system.build(), {"time": t, "stone.x": 3 * t + noise}, vary=["v"])
    >>> expected = 0.01 / np.sqrt((t**2).sum())  # of a line through the origin
    >>> type(result) is da.IdentificationResult, bool(abs(result.x["v"] - 3) < 4 * expected)
    (True, True)
    """

    file_suffix = "identification"
    page_functions = "identification:identification"
    x: dict[str, float]
    success: bool
    message: str
    cost: float
    noise: dict[str, float]
    noise_specified: bool
    factor: float
    information: Information
    motions: list[Result]
    predicted: list[np.ndarray]
    misfit: Misfit = field(repr=False)
    at_bounds: list[str] = field(default_factory=list)
    runs: int = 0
    failed_runs: int = 0
    interrupted: bool = False
    minima: list[tuple[float, dict[str, float]]] = field(default_factory=list)

    @property
    def name(self) -> str:  # type: ignore[override]
        """Name of the model."""
        return str(self.misfit.model.name)

    @property
    def samples(self) -> int:
        """Number of samples used."""
        return self.misfit.size

    @property
    def freedom(self) -> int:
        """Degrees of freedom: samples minus unknowns."""
        return self.samples - len(self.x)

    @property
    def covariance(self) -> xr.DataArray:
        """Covariance of the unknowns, ``unknown × other``."""
        return self._square(self.information.covariance(self.factor), "covariance")

    @property
    def correlation(self) -> xr.DataArray:
        """Correlation of the unknowns; NaN if the data do not determine it."""
        covariance = self.information.covariance(self.factor)
        size = np.sqrt(np.diag(covariance))
        with np.errstate(invalid="ignore"):
            return self._square(covariance / np.outer(size, size), "correlation")

    def _square(self, values: np.ndarray, name: str) -> xr.DataArray:
        import xarray as xr

        names = list(self.x)
        return xr.DataArray(values, {"unknown": names, "other": names}, ("unknown", "other"), name)

    @property
    def deviation(self) -> dict[str, float]:
        variance = np.diag(self.information.covariance(self.factor))
        return dict(zip(self.x, map(float, np.sqrt(variance)), strict=True))

    def interval(self, level: float = 0.95) -> dict[str, tuple[float, float]]:
        """Unknown → confidence interval; Student's t if the noise was estimated."""
        from scipy.special import ndtri, stdtrit

        probability = (1 + level) / 2
        is_normal = self.noise_specified or self.freedom < 1
        quantile = float(ndtri(probability) if is_normal else stdtrit(self.freedom, probability))
        return {n: (v - quantile * s, v + quantile * s) for (n, v), s in self._pairs()}

    def _pairs(self) -> Iterator[tuple[tuple[str, float], float]]:
        return zip(self.x.items(), self.deviation.values(), strict=True)

    @property
    def combinations(self) -> list[Combination]:
        """Combinations of the unknowns, the most uncertain first."""
        return self.information.combinations(self.factor)

    @property
    def poorly_determined(self) -> list[Combination]:
        """Combinations that the data determine poorly or not at all."""
        return [c for c in self.combinations if c.deviation > WEAK]

    @property
    def residuals(self) -> list[np.ndarray]:
        """(K, columns) model minus data of each experiment, NaN for samples that are not used."""
        pairs = zip(self.predicted, self.misfit.observations, strict=True)
        return [predicted - o.values for predicted, o in pairs]

    def advise(self, candidates: Mapping[str, Mapping[str, float]]) -> list[dict[str, Any]]:
        """Rank further experiments by D-optimality.

        Each candidate repeats the first experiment with other parameters, such as those of its
        excitation. Its Jacobian at the identified parameters is appended to that of the data.

        Parameters
        ----------
        candidates : name → parameters of the run

        Returns
        -------
        name, ``gain`` of ``log det F`` and expected ``deviation``, the best first
        """
        x = np.array(list(self.x.values()))
        return rank_experiments(self.misfit, self.information, x, self.factor, candidates)

    # for people ----------------------------------------------------------------------------
    @property
    def notes(self) -> list[str]:
        """Reservations about the result."""
        notes = [f"{name} is at a bound; its interval is not meaningful" for name in self.at_bounds]
        notes += [f"poorly determined by the data: {c}" for c in self.poorly_determined]
        notes += [
            f"{column}: neighbouring residuals agree (correlation {correlation:.2f}), unlike "
            "noise: the model is incomplete, or another start fits better; intervals are too small"
            for column, correlation in self._correlated_residuals()
        ]
        if len(self.minima) > 1:
            cost, x = self.minima[1]
            location = ", ".join(f"{name} = {value:.4g}" for name, value in x.items())
            text = f"{len(self.minima)} minima from several starts; the next best is at {location}"
            notes.append(f"{text}, cost {cost:.4g} instead of {self.minima[0][0]:.4g}")
        if not self.success:
            notes.insert(0, f"{self.message}; {UNFINISHED}")
        return notes

    def _correlated_residuals(self) -> Iterator[tuple[str, float]]:
        """Columns with autocorrelated residuals, and the correlation of neighbours."""
        pairs = zip(self.misfit.observations, self.residuals, strict=True)
        for number, (o, residuals) in enumerate(pairs, start=1):
            for k, column in enumerate(o.columns):
                samples, values = residuals[:, k], o.values[:, k]
                samples = samples[np.isfinite(samples)]
                if samples.size < MIN_SAMPLES or not np.std(samples) > ROUNDING * np.ptp(
                    values[np.isfinite(values)]
                ):
                    continue
                correlation = float(samples[1:] @ samples[:-1] / (samples @ samples))
                if correlation > 0.5 and correlation * np.sqrt(samples.size) > 5:
                    suffix = f" of experiment {number}" if len(self.residuals) > 1 else ""
                    yield f"{column}{suffix}", correlation

    def plot(self) -> Figure:
        """Data, model and residuals of every column; returns the figure."""
        figure: Figure = self._page_function("figure")(self)
        return figure

    @property
    def sentence(self) -> str:
        state = "converged" if self.success else self.message
        return f"{counted(len(self.x), 'unknown')} from {counted(self.samples, 'sample')}, {state}"

    def findings(self) -> dict[str, Any]:
        return {
            "x": self.x,
            "deviation": self.deviation,
            "interval": self.interval(),
            "start": dict(zip(self.x, self.misfit.unknowns.start.tolist(), strict=True)),
            "noise": self.noise,
            "noise_specified": self.noise_specified,
            "samples": self.samples,
            "correlation": self.correlation.values.tolist(),
            "notes": self.notes,
            "minima": [{"cost": cost, "x": x} for cost, x in self.minima],
            "runs": self.runs,
            "failed_runs": self.failed_runs,
        }

    @property
    def data(self) -> xr.Dataset:
        """Unknowns and their covariance; data and model of every experiment."""
        import xarray as xr

        dataset = xr.Dataset(
            {
                "value": ("unknown", list(self.x.values())),
                "deviation": ("unknown", list(self.deviation.values())),
                "covariance": self.covariance,
            },
            attrs={"message": self.message, "samples": self.samples},
        )
        pairs = zip(self.misfit.observations, self.predicted, strict=True)
        for k, (o, predicted) in enumerate(pairs, start=1):
            dims, coords = (f"sample_{k}", f"column_{k}"), {f"column_{k}": list(o.columns)}
            parts = {f"data_{k}": (dims, o.values), f"model_{k}": (dims, predicted)}
            times = {f"time_{k}": (dims[:1], o.times, {"units": "s"})}
            dataset = dataset.assign(parts | times).assign_coords(coords)
        return dataset

    def to_dataframe(self) -> pd.DataFrame:
        """One row per unknown."""
        return self.data[["value", "deviation"]].to_dataframe()

    def live_task(self) -> LiveTask | None:
        task: LiveTask | None = self._page_function("task")(self)
        return task

    def write(self, base: Path, live: bool | None = None, **first_view: Any) -> list[Path]:
        """Write data, summary, page, picture (.identified.png) and covariance (.covariance.csv)."""
        import matplotlib as mpl

        from dalembert.files import atomic_path

        mpl.use("Agg")
        paths = [base.with_name(f"{base.name}.{e}") for e in ("identified.png", "covariance.csv")]
        with atomic_path(paths[0]) as temporary:
            self.plot().savefig(temporary, format="png", dpi=110)
        with atomic_path(paths[1]) as temporary:
            self.covariance.to_pandas().to_csv(temporary)
        return [*paths, *super().write(base, live, **first_view)]

    def table_html(self) -> str:
        return str(self._page_function("table")(self))

    def __repr__(self) -> str:
        listed = ", ".join(f"{n} = {v:.6g} ± {s:.2g}" for (n, v), s in self._pairs())
        return f"<IdentificationResult {listed}: {self.samples} samples, {self.message}>"
