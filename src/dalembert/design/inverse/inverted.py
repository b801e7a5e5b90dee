"""What an inverse problem ends with: histories, how smooth, and how well the data are met."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from dalembert.design.identification.misfit import Misfit
from dalembert.design.inverse.history import History
from dalembert.design.inverse.smoothing import Curve
from dalembert.results.result import Result


@dataclass(eq=False)
class Inversion:
    """Result of ``invert``.

    Attributes
    ----------
    values : history → its values at the knots
    deviation : history → their standard deviations by the noise, given or estimated; what the
        smoothing takes away is not in them
    x : parameter → value, to run the model with
    smoothing : ``μ`` used
    curve : misfit and roughness over the smoothing
    misfit_norm, roughness_norm : of the solution
    """

    values: dict[str, np.ndarray]
    deviation: dict[str, np.ndarray]
    x: dict[str, float]
    success: bool
    message: str
    smoothing: float
    curve: Curve = field(repr=False)
    misfit_norm: float
    roughness_norm: float
    motions: list[Result] = field(repr=False)
    predicted: list[np.ndarray] = field(repr=False)
    histories: list[History] = field(repr=False)
    misfit: Misfit = field(repr=False)

    def at(self, name: str, times: Any) -> np.ndarray:
        """A history at times: the natural spline through its values."""
        from scipy.interpolate import CubicSpline

        knots = next(h.knots for h in self.histories if h.name == name)
        return CubicSpline(knots, self.values[name], bc_type="natural")(times)

    def plot(self) -> Any:
        """The histories with their deviation, and the L-curve; returns the figure."""
        import matplotlib.pyplot as plt

        count = len(self.histories)
        figure, axes = plt.subplots(
            1, count + 1, figsize=(4 * (count + 1), 3.4), layout="constrained"
        )
        for ax, history in zip(axes, self.histories, strict=False):
            times = np.linspace(history.knots[0], history.knots[-1], 400)
            ax.plot(times, self.at(history.name, times))
            value, spread = self.values[history.name], 2 * self.deviation[history.name]
            ax.fill_between(history.knots, value - spread, value + spread, alpha=0.2)
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
        return f"<Inversion of {names}: smoothing {self.smoothing:.3g}, {self.message}>"
