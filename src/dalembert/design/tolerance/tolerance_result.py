"""Result of a tolerance analysis, and optimal tolerance allocation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.decision import Decision, plot_axes
from dalembert.errors import AnalysisError
from dalembert.results.result import Result

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes

    from dalembert.design.pages.live import LiveTask
    from dalembert.responses.base import Response


@dataclass(eq=False)
class ToleranceResult(Decision):
    """Result of ``tolerance``.

    Attributes
    ----------
    nominal : response without deviations
    effects : parameter → change of the response for its full tolerance, to first order
    hessian : (n, n) second derivatives, scaled by the tolerances, or None
    worst : minimum and maximum response within all tolerances, or None
    sampled : responses of the Monte Carlo samples, or None
    samples : (samples, parameters) toleranced parameters of these samples, or None
    response : the toleranced response
    interrupted : ended by Ctrl-C, with the results so far

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> stack = da.Structure("two plates")
    >>> a, b = stack.parameter("a", 20.0, "mm"), stack.parameter("b", 30.0, "mm")
    >>> end = stack.node("end", a + b)
    >>> part = stack.add(structures.GroundSpring("spring", end, stiffness_x=1.0))
    >>> limits = {"a": 0.3e-3, "b": 0.4e-3}
    >>> result = da.tolerance(stack.build(), da.final("a - b"), limits, analysis=da.Statics())
    >>> isinstance(result, da.ToleranceResult)
    True
    >>> {name: round(effect * 1e3, 6) for name, effect in result.effects.items()}
    {'a': 0.3, 'b': -0.4}
    >>> {name: round(share, 6) for name, share in result.contributions.items()}  # 9 and 16 of 25
    {'a': 0.36, 'b': 0.64}
    """

    file_suffix = "tolerance"
    page_functions = "tolerance:tolerance"
    label: str
    nominal: float
    tolerances: dict[str, float]
    effects: dict[str, float]
    sigmas: float
    hessian: np.ndarray | None = field(default=None, repr=False)
    worst: tuple[float, float] | None = None
    sampled: np.ndarray | None = field(default=None, repr=False)
    samples: np.ndarray | None = field(default=None, repr=False)
    response: Response | None = field(default=None, repr=False)
    name: str = ""
    unit: str = ""
    units: dict[str, str] = field(default_factory=dict)
    allocated: dict[str, float] | None = None
    interrupted: bool = False
    run: Result | None = field(default=None, repr=False)

    @property
    def success(self) -> bool:  # type: ignore[override]
        """Whether the analysis was completed."""
        return not self.interrupted

    @property
    def message(self) -> str:  # type: ignore[override]
        """Nominal response and its scatter."""
        text = (
            f"{self.label} {self.nominal:.6g} ± {self.sigmas * self.std:.3g} {self.unit}".rstrip()
        )
        return f"{text}; interrupted" if self.interrupted else text

    @property
    def std(self) -> float:
        """Standard deviation to first order."""
        return float(np.linalg.norm(list(self.effects.values())) / self.sigmas)

    @property
    def first_order_worst(self) -> float:
        """Largest deviation to first order, ``Σ|∂f/∂p_i t_i|``."""
        return float(np.sum(np.abs(list(self.effects.values()))))

    @property
    def second_order(self) -> tuple[float, float]:
        """Mean and standard deviation to second order.

        Raises
        ------
        AnalysisError
            It was not computed.
        """
        if self.hessian is None:
            raise AnalysisError("the second order was not computed; give second_order=True")
        h = self.hessian / self.sigmas**2
        mean = self.nominal + 0.5 * float(np.trace(h))
        return mean, float(np.sqrt(self.std**2 + 0.5 * np.sum(h**2)))

    @property
    def contributions(self) -> dict[str, float]:
        """Parameter → share of the variance to first order."""
        squares = np.square(list(self.effects.values()))
        total = float(squares.sum()) or 1.0
        return dict(zip(self.effects, map(float, squares / total), strict=True))

    def allocate(
        self,
        limit: float,
        costs: Mapping[str, float],
        *,
        exponent: float = 1.0,
        bounds: tuple[float, float] | Mapping[str, tuple[float, float]] = (0.0, np.inf),
        worst_case: bool = False,
    ) -> dict[str, float]:
        """Cheapest tolerances for which the response stays within ``±limit``.

        ``min Σ c_i/t_i^k`` subject to ``Σ (g_i t_i)² ≤ limit²``, or ``Σ |g_i| t_i ≤ limit`` in the
        worst case, to first order. Without active bounds, ``t_i ∝ (c_i/|g_i|^m)^(1/(k + m))``,
        m = 2 or 1 (Chase and Greenwood 1988).

        Parameters
        ----------
        limit : of the deviation of the response, at the number of standard deviations ``sigmas``
        costs : parameter → ``c``
        exponent : ``k``
        bounds : minimum and maximum tolerance, of all or by parameter

        Raises
        ------
        AnalysisError
            Costs are missing, or the minimum tolerances already exceed the limit.
        """
        names = list(self.effects)
        missing = [n for n in names if not costs.get(n, 0) > 0]
        if missing:
            raise AnalysisError(f"allocate: give a cost above zero for {', '.join(missing)}")
        if not (limit > 0 and exponent > 0):
            raise AnalysisError("allocate: limit and exponent must be above zero")
        ranges = {n: bounds[n] if isinstance(bounds, Mapping) else bounds for n in names}
        low, high = np.array(list(ranges.values()), dtype=float).T
        g = np.abs([self.effects[n] / self.tolerances[n] for n in names])
        c, power = np.array([costs[n] for n in names]), 1.0 if worst_case else 2.0
        if not np.any(g > 0):
            raise AnalysisError("allocate: the response does not depend on any of the tolerances")

        def deviation(t: np.ndarray) -> float:
            return float(np.sum(np.where(g > 0, g * t, 0.0) ** power) ** (1 / power))

        if deviation(low) > limit:
            raise AnalysisError(
                f"allocate: the minimum tolerances already deviate by {deviation(low):.6g}, above "
                f"the limit {limit:.6g}"
            )

        def allocated(logarithm: float) -> np.ndarray:
            with np.errstate(divide="ignore", over="ignore"):
                free = np.exp(logarithm) * np.where(g > 0, c / g**power, np.inf)
            return np.clip(free ** (1 / (exponent + power)), low, high)

        optimal = allocated(_multiplier(allocated, deviation, limit))
        return dict(zip(names, map(float, optimal), strict=True))

    def findings(self) -> dict[str, Any]:
        second = None if self.hessian is None else self.second_order
        return {
            "response": self.label,
            "unit": self.unit,
            "nominal": self.nominal,
            "std": self.std,
            "sigmas": self.sigmas,
            "second_order": second and {"mean": second[0], "std": second[1]},
            "worst_case": self.worst,
            "first_order_worst": self.first_order_worst,
            "tolerances": self.tolerances,
            "effects": self.effects,
            "contributions": self.contributions,
            "allocated": self.allocated,
            "samples": None if self.sampled is None else int(self.sampled.size),
            "sampled": None if self.sampled is None else self._of_samples(self.sampled),
        }

    @staticmethod
    def _of_samples(values: np.ndarray) -> dict[str, float]:
        return {
            "mean": float(np.mean(values)),
            "std": float(np.std(values, ddof=1)) if values.size > 1 else float("nan"),
            "minimum": float(np.min(values)),
            "maximum": float(np.max(values)),
        }

    @property
    def data(self) -> xr.Dataset:
        """Tolerances, effects, contributions, second derivatives and samples."""
        import xarray as xr

        names = list(self.tolerances)
        columns: dict[str, Any] = {
            "tolerance": ("parameter", list(self.tolerances.values())),
            "effect": ("parameter", list(self.effects.values())),
            "contribution": ("parameter", list(self.contributions.values())),
        }
        if self.hessian is not None:
            columns["hessian"] = (("parameter", "other"), self.hessian)
        if self.sampled is not None:
            columns["sampled"] = ("sample", self.sampled)
        if self.samples is not None:
            columns["samples"] = (("sample", "parameter"), self.samples)
        attributes = {"response": self.label, "units": self.unit, "nominal": self.nominal}
        return xr.Dataset(columns, {"parameter": names}, attributes | {"std": self.std})

    def live_task(self) -> LiveTask | None:
        task: LiveTask | None = self._page_function("task")(self)
        return task

    def to_dataframe(self) -> pd.DataFrame:
        """One row per tolerance."""
        return self.data[["tolerance", "effect", "contribution"]].to_dataframe()

    # for people ----------------------------------------------------------------------------
    def plot(self, ax: Axes | None = None) -> Axes:
        """Plot the effect of each tolerance; returns the axes."""
        ax = plot_axes(ax, (5.5, 3.2))
        rows = sorted(self.effects.items(), key=lambda item: abs(item[1]))
        ax.barh([n for n, _ in rows], [abs(v) for _, v in rows], height=0.6)
        ax.set(xlabel=f"change of {self.label} for the full tolerance")
        return ax

    def table_html(self) -> str:
        from html import escape

        head = "<th>parameter</th><th>±</th><th>effect</th><th>share</th>"
        rows = "".join(
            f"<tr><td>{escape(n)}</td><td>{self.tolerances[n]:.4g}</td><td>{v:.4g}</td>"
            f"<td>{self.contributions[n]:.1%}</td></tr>"
            for n, v in self.effects.items()
        )
        return f"<p>{escape(repr(self))}</p><table><tr>{head}</tr>{rows}</table>"

    def __repr__(self) -> str:
        worst = "" if self.worst is None else f", worst {self.worst[0]:.6g} … {self.worst[1]:.6g}"
        spread = self.sigmas * self.std
        return f"<ToleranceResult {self.label} {self.nominal:.6g} ± {spread:.3g}{worst}>"


def _multiplier(
    allocated: Callable[[float], np.ndarray], deviation: Callable[[np.ndarray], float], limit: float
) -> float:
    """Logarithm of the multiplier for which the limit is reached, by bisection."""
    low, high = -700.0, 700.0
    if deviation(allocated(high)) <= limit:
        return high
    for _ in range(200):
        midpoint = (low + high) / 2
        low, high = (midpoint, high) if deviation(allocated(midpoint)) <= limit else (low, midpoint)
    return low
