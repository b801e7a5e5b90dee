"""Result of an inverse problem: histories, smoothing and misfit."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from dalembert.design.decision import Decision
from dalembert.design.identification.misfit import Misfit
from dalembert.design.inverse.input_history import InputHistory
from dalembert.design.inverse.smoothing import Curve
from dalembert.results.analysis import Analysis
from dalembert.results.result import Result
from dalembert.sensitivity.gradient import history_gradients
from dalembert.symbolic.formulas.expression import Expression

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.figure import Figure


NORMAL_95 = 1.959964
"""Half-width of the 95 % interval of a normal variable, in standard deviations."""


@dataclass(frozen=True, eq=False)
class Band:
    """A measure over time with its uncertainty.

    Attributes
    ----------
    time, value, deviation : (K,)
    """

    time: np.ndarray
    value: np.ndarray
    deviation: np.ndarray

    @property
    def interval(self) -> np.ndarray:
        """(K, 2) bounds of the 95 % interval."""
        return self.value[:, None] + NORMAL_95 * self.deviation[:, None] * np.array([-1, 1])


@dataclass(eq=False)
class InversionResult(Decision):
    """Result of ``invert``.

    Attributes
    ----------
    values : history → values at the knots
    deviation : history → standard deviations, by the noise, given or estimated, and by the bias of
        the smoothing; see ``intervals``
    x : parameter → value, for runs of the model
    smoothing : ``μ`` used
    weights : history → factor of the penalised derivative, relative to the first history
    covariance : (n, n) of ``x``
    curve : misfit and roughness over the smoothing
    misfit_norm, roughness_norm : of the solution
    interrupted : by Ctrl-C; the histories are the best so far

    Examples
    --------
    >>> import numpy as np
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("pushed mass")
    >>> mass = system.add(planar.Particle("mass", mass=2.0))
    >>> push = da.input_history(system, "push", np.linspace(0, 1, 5), unit="N")
    >>> force = system.add(planar.Force("push", mass.center, (push.value, 0)))
    >>> t = np.linspace(0, 1, 21)
    >>> seen = {"time": t, "mass.x": t**3}  # under a force of 12 t
    >>> result = da.invert(system.build(), seen, histories=[push], smoothing=1e-9)
    >>> isinstance(result, da.InversionResult), result.at("push", [0.25, 0.5]).round(2)
    (True, array([3., 6.]))
    """

    file_suffix = "inversion"
    page_functions = "identification:inversion"
    values: dict[str, np.ndarray]
    deviation: dict[str, np.ndarray]
    x: dict[str, float]
    success: bool
    message: str
    smoothing: float
    weights: dict[str, float]
    covariance: np.ndarray = field(repr=False)
    curve: Curve = field(repr=False)
    misfit_norm: float
    roughness_norm: float
    motions: list[Result] = field(repr=False)
    predicted: list[np.ndarray] = field(repr=False)
    histories: list[InputHistory] = field(repr=False)
    misfit: Misfit = field(repr=False)
    interrupted: bool = False

    @property
    def name(self) -> str:  # type: ignore[override]
        """Name of the model."""
        return str(self.misfit.model.name)

    def at(self, name: str, times: ArrayLike) -> np.ndarray:
        """Values of a history at times, by its spline."""
        history = next(h for h in self.histories if h.name == name)
        return history.at(self.values[name], times)

    @property
    def intervals(self) -> dict[str, np.ndarray]:
        """History → (n, 2) bounds of the 95 % interval at each knot.

        The coverage holds on average over the knots, for histories as smooth as ``order`` assumes.
        """
        return {
            name: value[:, None] + NORMAL_95 * self.deviation[name][:, None] * np.array([-1, 1])
            for name, value in self.values.items()
        }

    def band(self, measure: str | Expression, analysis: Analysis | None = None) -> Band:
        """A measure for the identified histories, with its first-order standard deviation.

        Parameters
        ----------
        measure : for example the effort of a drive with an identified history
        analysis : for example ``da.InverseDynamics(...)``; by default that of the data
        """
        model, names = self.misfit.model, list(self.x)
        columns = [k for k, name in enumerate(names) if name in model.parameters]
        parameters = {names[k]: self.x[names[k]] for k in columns}
        run = self.motions[0] if analysis is None else analysis.run(model, parameters)
        (gradient,) = history_gradients(run, [measure], [names[k] for k in columns])
        covariance = self.covariance[np.ix_(columns, columns)]
        deviation = np.sqrt(
            np.maximum(np.einsum("ki,ij,kj->k", gradient, covariance, gradient), 0.0)
        )
        return Band(np.asarray(run.time), np.asarray(run.values(measure)), deviation)

    @property
    def sentence(self) -> str:
        state = "converged" if self.success else self.message
        return f"{', '.join(self.values)} from {self.misfit.size} samples, {state}"

    def findings(self) -> dict[str, Any]:
        return {
            "histories": {
                h.name: {
                    "knots": h.knots.tolist(),
                    "values": self.values[h.name].tolist(),
                    "deviation": self.deviation[h.name].tolist(),
                    "interval": self.intervals[h.name].tolist(),
                    "unit": h.parameters[0].unit,
                }
                for h in self.histories
            },
            "x": self.x,
            "smoothing": self.smoothing,
            "weights": self.weights,
            "misfit": self.misfit_norm,
            "roughness": self.roughness_norm,
            "samples": self.misfit.size,
            "runs": self.misfit.runs,
        }

    @property
    def data(self) -> xr.Dataset:
        """Histories at their knots, data and model, and the L-curve."""
        import xarray as xr

        columns: dict[str, Any] = {}
        for h in self.histories:
            knot = f"{h.name}_time"
            columns[knot] = (knot, h.knots, {"units": "s"})
            columns[h.name] = (knot, self.values[h.name], {"units": h.parameters[0].unit})
            columns[f"{h.name}_deviation"] = (knot, self.deviation[h.name])
        for name in ("smoothing", "misfit", "roughness"):
            columns[f"curve_{name}"] = ("curve", getattr(self.curve, name))
        return xr.Dataset(columns, attrs={"message": self.message, "smoothing": self.smoothing})

    def to_dataframe(self) -> pd.DataFrame:
        """A row per knot of each history."""
        import pandas as pd

        parts = [
            pd.DataFrame(
                {
                    "history": h.name,
                    "time": h.knots,
                    "value": self.values[h.name],
                    "deviation": self.deviation[h.name],
                }
            )
            for h in self.histories
        ]
        return pd.concat(parts, ignore_index=True)

    def plot(self) -> Figure:
        """The histories with their deviation, and the L-curve; returns the figure."""
        import matplotlib.pyplot as plt

        count = len(self.histories)
        figure, axes = plt.subplots(
            1, count + 1, figsize=(4 * (count + 1), 3.4), layout="constrained"
        )
        for ax, history in zip(axes, self.histories, strict=False):
            times = np.linspace(history.knots[0], history.knots[-1], 400)
            ax.plot(times, self.at(history.name, times))
            ax.fill_between(history.knots, *self.intervals[history.name].T, alpha=0.2)
            ax.set(title=history.name, xlabel="time [s]")
        last = axes[-1]
        last.loglog(self.curve.misfit, self.curve.roughness)
        last.loglog(self.misfit_norm, self.roughness_norm, "o")
        last.set(title="L-curve", xlabel="misfit", ylabel="roughness")
        for ax in axes:
            ax.grid(alpha=0.25)
            ax.spines[["top", "right"]].set_visible(False)
        return figure

    def __repr__(self) -> str:
        names = ", ".join(self.values)
        return f"<InversionResult of {names}: smoothing {self.smoothing:.3g}, {self.message}>"
