"""Result of a reliability analysis: design points, probabilities, importance, sensitivities."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from dalembert.design.decision import Decision
from dalembert.design.reliability.first_order import DesignPoint, Search
from dalembert.design.reliability.nataf import Nataf
from dalembert.design.reliability.sampling import (
    Estimate,
    failure_event,
    importance_sampling,
    intersection_of_half_spaces,
    monte_carlo,
    openturns_subset_sampling,
    subset_simulation,
    union_of_half_spaces,
)
from dalembert.design.reliability.second_order import SecondOrder, second_order
from dalembert.options import RandomSource, random_generator
from dalembert.results.result import Result

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from dalembert.design.pages.live import LiveTask


SAMPLINGS = {
    "monte-carlo": "monte_carlo",
    "importance-sampling": "importance_sampling",
    "subset-simulation": "subset_simulation",
    "openturns-subset": "openturns_subset",
}
"""Name of a sampling → method of ``ReliabilityResult``."""


@dataclass(eq=False)
class ReliabilityResult(Decision):
    """Result of ``reliability``.

    Attributes
    ----------
    points : design points of all limit states, the nearest of each first
    system : ``"series"``, failure of any limit state; ``"parallel"``, failure of all
    sampled : an estimate by samples, if requested
    interrupted : by Ctrl-C; the points computed so far are available
    warnings : searches without a result, and probabilities for which the first order is not
        sufficient, with numbers

    Examples
    --------
    >>> import dalembert as da
    >>> random = {"r": da.Normal(10.0, 2.0), "s": da.Normal(4.0, 1.5)}
    >>> result = da.reliability(None, "r - s", random)
    >>> isinstance(result, da.ReliabilityResult), round(result.probability, 6)  # Φ(-2.4)
    (True, 0.008198)
    >>> {name: round(share, 3) for name, share in result.importance.items()}  # 4 and 2.25 of 6.25
    {'r': 0.64, 's': 0.36}
    """

    file_suffix = "reliability"
    page_functions = "reliability:reliability"
    points: list[DesignPoint]
    system: str
    searches: list[Search] = field(repr=False)
    nataf: Nataf = field(repr=False)
    sampled: Estimate | None = None
    interrupted: bool = False
    warnings: list[str] = field(default_factory=list)

    @property
    def name(self) -> str:  # type: ignore[override]
        """Name of the model, or the formulas."""
        model = self.searches[0].limits.model
        return "; ".join(self.searches[0].limits.labels) if model is None else str(model.name)

    @property
    def message(self) -> str:  # type: ignore[override]
        """Outcome of the searches."""
        if self.interrupted:
            searched, total = len(self._nearest()), len(self.searches)
            if searched < total:
                return f"interrupted; only {searched} of {total} limits searched"
            return "interrupted after the search of the design points"
        state = "converged" if self.success else "not converged"
        note = f", {len(self.warnings)} warning(s)" if self.warnings else ""
        return f"{state}, residual {self.residual:.1e}{note}"

    @property
    def point(self) -> DesignPoint:
        """The governing point: the nearest of a series, the farthest of a parallel system."""
        nearest = self._nearest()
        pick = min if self.system == "series" else max
        return pick(nearest, key=lambda point: point.beta)

    def _nearest(self) -> list[DesignPoint]:
        """The nearest design point of each limit state."""
        nearest: dict[int, DesignPoint] = {}
        for point in self.points:
            if point.row not in nearest or abs(point.beta) < abs(nearest[point.row].beta):
                nearest[point.row] = point
        return list(nearest.values())

    @property
    def success(self) -> bool:  # type: ignore[override]
        """Whether every search converged."""
        return all(point.converged for point in self.points) and not self.interrupted

    @property
    def residual(self) -> float:
        """Largest residual of the limit states at their design points."""
        return max(point.residual for point in self.points)

    @property
    def beta(self) -> float:
        """First-order reliability index; for a system ``−Φ⁻¹`` of its probability."""
        from scipy.special import ndtri

        return self.points[0].beta if len(self.points) == 1 else float(-ndtri(self.probability))

    @cached_property
    def probability(self) -> float:
        """First-order probability of failure; for a system by planes through all design points.

        If the median fails, the planes through the points of one limit state bound the failure
        region; in a system the nearest plane represents it.
        """
        nearest = self._nearest()
        if len(self.points) == 1:
            return self.points[0].probability
        if len(nearest) == 1 and nearest[0].beta < 0:
            return intersection_of_half_spaces(self.points)
        if self.system == "series":
            planes = [p for p in self.points if p.beta >= 0 or any(p is point for point in nearest)]
            return union_of_half_spaces(planes)
        return intersection_of_half_spaces(nearest)

    @property
    def sorm(self) -> SecondOrder:
        """Second-order probabilities of the governing limit state."""
        return second_order(self.searches[self.point.row], self.point)

    # sensitivities --------------------------------------------------------------------------
    @property
    def importance(self) -> dict[str, float]:
        """Random parameter → fraction of the variance at the design point; the sum is one.

        With correlation, fractions of the independent variables in the order of ``random``.
        """
        return dict(zip(self.nataf.random, map(float, self.point.alpha**2), strict=True))

    @property
    def sensitivity(self) -> dict[str, dict[str, float]]:
        """Random parameter → number of its distribution → ``∂β`` by it, at fixed correlation."""
        point = self.point
        z = self.nataf.factor @ point.u
        sensitivities = {}
        for k, (name, distribution) in enumerate(self.nataf.random.items()):
            changes = distribution.changes(float(z[k]))
            factor = point.gradient[k] / point.slope
            sensitivities[name] = {
                number: float(factor * change) for number, change in changes.items()
            }
        return sensitivities

    @property
    def parameter_sensitivity(self) -> dict[str, float]:
        """Parameter that is not random → ``∂β`` by it."""
        names, gradient = self.searches[0].limits.others, self.point.other_gradient
        return dict(zip(names, map(float, gradient / self.point.slope), strict=True))

    # by sampling ----------------------------------------------------------------------------
    def monte_carlo(self, samples: int = 10_000, rng: RandomSource = 0) -> Estimate:
        """Probability of failure by samples of all random parameters."""
        generator = random_generator(rng)
        return monte_carlo(self._system, self.nataf.size, samples, generator)

    def importance_sampling(self, samples: int = 1000, rng: RandomSource = 0) -> Estimate:
        """Probability of failure by samples about the design points."""
        points = self.points if self.system == "series" else self._nearest()
        centres = np.array([point.u for point in points])
        return importance_sampling(self._system, centres, samples, random_generator(rng))

    def subset_simulation(self, samples: int = 1000, rng: RandomSource = 0) -> Estimate:
        """Probability of failure by subset simulation, with ``samples`` on each level."""
        generator = random_generator(rng)
        return subset_simulation(self._system, self.nataf.size, samples, generator)

    def openturns_subset(self, samples: int = 1000, rng: RandomSource = 0) -> Estimate:
        """Subset simulation of OpenTURNS: ``pip install dalembert[reliability]``."""
        return openturns_subset_sampling(self._system, self.nataf.size, samples, rng)

    @property
    def openturns_event(self) -> Any:
        """Failure as an event of OpenTURNS, of independent standard normal variables.

        Raises
        ------
        UnsupportedError
            OpenTURNS is not installed.
        """
        return failure_event(self._system, self.nataf.size)

    def _system(self, u: np.ndarray) -> np.ndarray:
        """(N,) ``G`` of the system."""
        values = self.searches[0].limits.values_at(self.nataf.values(u))
        return values.min(axis=1) if self.system == "series" else values.max(axis=1)

    def sample(self, method: str, samples: int, rng: RandomSource = 0) -> Estimate:
        """Probability of failure by a method of ``SAMPLINGS``."""
        return getattr(self, SAMPLINGS[method])(samples, rng)  # type: ignore[no-any-return]

    # presentation ---------------------------------------------------------------------------
    def result(self) -> Result | None:
        """The run at the design point; None without a model."""
        x = np.array(list(self.point.x.values()))
        return self.searches[0].limits.result(x)

    @property
    def sentence(self) -> str:
        sampled = "" if self.sampled is None else f", {self.sampled.sentence}"
        return f"β = {self.beta:.4g}, failure {self.probability:.3g}{sampled}; {self.message}"

    def findings(self) -> dict[str, Any]:
        return {
            "beta": self.beta,
            "probability": self.probability,
            "system": self.system,
            "residual": self.residual,
            "points": [
                {
                    "limit": p.limit,
                    "beta": p.beta,
                    "probability": p.probability,
                    "x": p.x,
                    "u": p.u.tolist(),
                    "alpha": p.alpha.tolist(),
                    "residual": p.residual,
                    "converged": p.converged,
                }
                for p in self.points
            ],
            "importance": self.importance,
            "sensitivity": self.sensitivity,
            "parameter_sensitivity": self.parameter_sensitivity,
            "sampled": None if self.sampled is None else asdict(self.sampled),
            "calls": self.searches[0].limits.calls,
        }

    @property
    def data(self) -> xr.Dataset:
        """Design points, indices and importance."""
        import xarray as xr

        names, points = list(self.nataf.random), self.points
        dimensions = ("point", "variable")
        return xr.Dataset(
            {
                "x": (dimensions, [list(p.x.values()) for p in points]),
                "u": (dimensions, [p.u for p in points]),
                "alpha": (dimensions, [p.alpha for p in points]),
                "beta": ("point", [p.beta for p in points]),
                "limit": ("point", [p.limit for p in points]),
                "importance": ("variable", list(self.importance.values())),
            },
            {"point": range(len(points)), "variable": names},
            {"beta": self.beta, "probability": self.probability, "system": self.system},
        )

    def live_task(self) -> LiveTask | None:
        task: LiveTask | None = self._page_function("task")(self)
        return task

    def plot(self, ax: Axes | None = None) -> Axes:
        """Importance of the random parameters; returns the axes."""
        import matplotlib.pyplot as plt

        if ax is None:
            _, ax = plt.subplots(figsize=(5, 3), layout="constrained")
        shares = sorted(self.importance.items(), key=lambda item: item[1])
        ax.barh([n for n, _ in shares], [100 * s for _, s in shares], height=0.6)
        ax.set(xlabel="share of the variance at the design point [%]")
        ax.spines[["top", "right"]].set_visible(False)
        return ax

    def table_html(self) -> str:
        from html import escape

        head = "<th>limit</th><th>β</th><th>Φ(−β)</th><th>residual</th><th>at</th>"
        rows = "".join(
            f"<tr><td>{escape(p.limit)}</td><td>{p.beta:.6g}</td><td>{p.probability:.4g}</td>"
            f"<td>{p.residual:.1e}</td><td>{escape(_point_text(p))}</td></tr>"
            for p in self.points
        )
        heading = f"<p>{escape(repr(self))}</p>{self.warnings_html()}"
        return f"{heading}<table><tr>{head}</tr>{rows}</table>"

    def __repr__(self) -> str:
        state = "converged" if self.success else "not converged"
        note = f", {len(self.warnings)} warning(s)" if self.warnings else ""
        return (
            f"<ReliabilityResult β = {self.beta:.6g}, p = {self.probability:.4g}: {state}, "
            f"residual {self.residual:.1e}, {_point_text(self.point)}{note}>"
        )


def _point_text(point: DesignPoint) -> str:
    return ", ".join(f"{n} = {v:.6g}" for n, v in point.x.items())
