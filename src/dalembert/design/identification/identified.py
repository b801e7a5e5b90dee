"""What an identification ends with: parameters, how sure they are, and what is left over."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.decision import Decision
from dalembert.design.identification.information import WEAK, Combination, Information
from dalembert.design.identification.misfit import Misfit
from dalembert.results.result import Result

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

FEW = 20
"""Samples below which nothing is said of how residuals follow each other."""
EXACT = 1e-6
"""Of the range of the data, residuals that are rounding and errors of steps."""


@dataclass(eq=False)
class Identification(Decision):
    """Result of ``identify``.

    Attributes
    ----------
    x : unknown → value
    success, message : how least squares ended
    deviation : unknown → standard deviation, infinite where the data cannot tell
    noise : column → standard deviation of its noise, given or estimated
    noise_given : whether all noise was given
    motions : the runs with the parameters found, one per experiment
    predicted : (K, columns) of each experiment, NaN where no sample is used
    at_bounds : unknowns that ended at a bound; their intervals mean little
    interrupted : by Ctrl-C; the unknowns are the best reached
    minima : of several starts, cost and unknowns of each minimum that was found, the best first;
        columns whose noise is not given are weighed by their scatter

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
    >>> found = da.identify(system.build(), {"time": t, "stone.x": 3 * t + noise}, vary=["v"])
    >>> expected = 0.01 / np.sqrt((t**2).sum())  # of a line through the origin
    >>> type(found) is da.Identification, bool(abs(found.x["v"] - 3) < 4 * expected)
    (True, True)
    """

    word = "identification"
    drawn = "identification:identification"
    x: dict[str, float]
    success: bool
    message: str
    cost: float
    noise: dict[str, float]
    noise_given: bool
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
        """Of the model."""
        return str(self.misfit.model.name)

    @property
    def samples(self) -> int:
        """Number of samples used."""
        return self.misfit.size

    @property
    def freedom(self) -> int:
        """Samples beyond the unknowns."""
        return self.samples - len(self.x)

    @property
    def covariance(self) -> xr.DataArray:
        """Covariance of the unknowns, ``unknown × other``."""
        return self._square(self.information.covariance(self.factor), "covariance")

    @property
    def correlation(self) -> xr.DataArray:
        """Correlation of the unknowns; NaN where the data cannot tell."""
        found = self.information.covariance(self.factor)
        size = np.sqrt(np.diag(found))
        with np.errstate(invalid="ignore"):
            return self._square(found / np.outer(size, size), "correlation")

    def _square(self, values: np.ndarray, name: str) -> xr.DataArray:
        import xarray as xr

        names = list(self.x)
        return xr.DataArray(values, {"unknown": names, "other": names}, ("unknown", "other"), name)

    @property
    def deviation(self) -> dict[str, float]:
        variance = np.diag(self.information.covariance(self.factor))
        return dict(zip(self.x, map(float, np.sqrt(variance)), strict=True))

    def interval(self, level: float = 0.95) -> dict[str, tuple[float, float]]:
        """Unknown → confidence interval; Student's where the noise was estimated."""
        from scipy.special import ndtri, stdtrit

        chance = (1 + level) / 2
        known = self.noise_given or self.freedom < 1
        reach = float(ndtri(chance) if known else stdtrit(self.freedom, chance))
        return {n: (v - reach * s, v + reach * s) for (n, v), s in self._pairs()}

    def _pairs(self) -> Any:
        return zip(self.x.items(), self.deviation.values(), strict=True)

    @property
    def combinations(self) -> list[Combination]:
        """Combinations of the unknowns, the worst known first."""
        return self.information.combinations(self.factor)

    @property
    def poorly_known(self) -> list[Combination]:
        """Combinations that the data cannot tell, or only roughly."""
        return [c for c in self.combinations if c.deviation > WEAK]

    @property
    def residuals(self) -> list[np.ndarray]:
        """(K, columns) of model less data of each experiment, NaN where no sample is used."""
        pairs = zip(self.predicted, self.misfit.observations, strict=True)
        return [found - o.values for found, o in pairs]

    def advise(self, candidates: Mapping[str, Mapping[str, float]]) -> list[dict[str, Any]]:
        """Which further experiment would tell most, by D-optimality.

        Each candidate is a first experiment again with other parameters, of an excitation say. Its
        Jacobian at the parameters found is joined to that of the data.

        Parameters
        ----------
        candidates : name → parameters of the run

        Returns
        -------
        name, ``gain`` of ``log det F`` and the ``deviation`` then expected, the best first
        """
        from dalembert.design.identification.excitation import advise

        x = np.array(list(self.x.values()))
        return advise(self.misfit, self.information, x, self.factor, candidates)

    # for people ----------------------------------------------------------------------------
    @property
    def notes(self) -> list[str]:
        """What is doubtful about it."""
        told = [f"{name} ended at a bound; its interval means little" for name in self.at_bounds]
        told += [f"the data hardly tell {c}" for c in self.poorly_known]
        told += [
            f"{column}: neighbouring residuals agree (correlation {alike:.2f}), which noise does "
            "not: the model lacks something, or another start fits better; intervals mean little"
            for column, alike in self._not_noise()
        ]
        if len(self.minima) > 1:
            cost, other = self.minima[1]
            at = ", ".join(f"{name} = {value:.4g}" for name, value in other.items())
            more = f"{len(self.minima)} minima from several starts; the next is at {at}"
            told.append(f"{more}, cost {cost:.4g} against {self.minima[0][0]:.4g}")
        if not self.success:
            told.insert(0, self.message)
        return told

    def _not_noise(self) -> Iterator[tuple[str, float]]:
        """Columns whose residuals follow each other, with the correlation of neighbours."""
        pairs = zip(self.misfit.observations, self.residuals, strict=True)
        for number, (o, residuals) in enumerate(pairs, start=1):
            for k, column in enumerate(o.columns):
                seen, values = residuals[:, k], o.values[:, k]
                seen = seen[np.isfinite(seen)]
                if seen.size < FEW or not np.std(seen) > EXACT * np.ptp(
                    values[np.isfinite(values)]
                ):
                    continue
                alike = float(seen[1:] @ seen[:-1] / (seen @ seen))
                if alike > 0.5 and alike * np.sqrt(seen.size) > 5:
                    several = f" of experiment {number}" if len(self.residuals) > 1 else ""
                    yield f"{column}{several}", alike

    def plot(self) -> Any:
        """Data, model and residuals of every column; returns the figure."""
        from dalembert.design.identification.pictures import plot_fit

        return plot_fit(self.misfit, self.predicted)

    @property
    def sentence(self) -> str:
        state = "converged" if self.success else self.message
        return f"{len(self.x)} unknowns from {self.samples} samples, {state}"

    def findings(self) -> dict[str, Any]:
        return {
            "x": self.x,
            "deviation": self.deviation,
            "interval": self.interval(),
            "start": dict(zip(self.x, self.misfit.unknowns.start.tolist(), strict=True)),
            "noise": self.noise,
            "noise_given": self.noise_given,
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

        made = xr.Dataset(
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
            made = made.assign(parts | times).assign_coords(coords)
        return made

    def to_dataframe(self) -> pd.DataFrame:
        """One row an unknown."""
        return self.data[["value", "deviation"]].to_dataframe()

    def write(self, base: Path, **first_view: Any) -> list[Path]:
        """Data, numbers and page; a picture (.identified.png), covariance (.covariance.csv)."""
        import matplotlib as mpl

        from dalembert.files import atomic_path

        mpl.use("Agg")
        more = [base.with_name(f"{base.name}.{e}") for e in ("identified.png", "covariance.csv")]
        with atomic_path(more[0]) as temporary:
            self.plot().savefig(temporary, format="png", dpi=110)
        with atomic_path(more[1]) as temporary:
            self.covariance.to_pandas().to_csv(temporary)
        return [*more, *super().write(base, **first_view)]

    def table_html(self) -> str:
        from dalembert.design.identification.pictures import html

        kind = "given" if self.noise_given else "estimated"
        noise = ", ".join(f"{column}: {level:.3g}" for column, level in self.noise.items())
        told = f"{self.samples} samples: {self.message}", f"noise ({kind}): {noise}"
        return html(self._rows(), told, self.notes)

    def _rows(self) -> list[tuple[str, ...]]:
        """Unknown, value, deviation, interval and unit of each, as text."""
        parameters, interval = self.misfit.model.parameters, self.interval()
        rows: list[tuple[str, ...]] = []
        for (name, value), deviation in self._pairs():
            low, high = interval[name]
            unit = parameters[name].unit if name in parameters else ""
            rows.append((name, f"{value:.6g}", f"{deviation:.2g}", f"{low:.6g} … {high:.6g}", unit))
        return rows

    def __repr__(self) -> str:
        listed = ", ".join(f"{n} = {v:.6g} ± {s:.2g}" for (n, v), s in self._pairs())
        return f"<Identification {listed}: {self.samples} samples, {self.message}>"
