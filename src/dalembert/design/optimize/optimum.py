"""What an optimisation ends with."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from dalembert.design.bounded import Bounded
from dalembert.design.decision import Decision
from dalembert.results.result import Result

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Iterate:
    """The design after one iteration."""

    parameters: dict[str, float]
    objective: float
    violation: float


@dataclass(eq=False)
class Optimum(Decision):
    """Result of an optimisation.

    Attributes
    ----------
    x : parameter → value
    fun : objective there
    success : limits are kept, and the gradient is that of an optimum
    message : how the optimiser ended, and what contradicts it
    interrupted : by Ctrl-C; the design is the best one reached
    gradient : of the objective, by what varied
    history : the designs on the way, the start first
    initial, motion : runs of the first and the best design, of the objective's case
    results : runs of the best design, of all cases
    at_bounds : parameters that ended at a bound
    active : limits that hold with equality
    stationarity : what multipliers leave of the gradient, relative: zero at an optimum
    variables, limits : names, values, bounds and prices
    optima : distinct optima of ``Multistart``, the best first

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> rod = da.Structure("rod")
    >>> area = rod.parameter("area", 1e-3, "m^2", bounds=(1e-5, 1e-2))
    >>> top, end = rod.node("top", 0), rod.node("end", 2)
    >>> part = rod.add(structures.Truss("rod", top, end, area=area, modulus=2e11, density=7850))
    >>> rod.support(top)
    >>> rod.load(end, fx=5e4)
    >>> strong = da.Limit(da.final("rod.stress", name="stress"), upper=1e8)
    >>> task = dict(minimize=da.final("mass"), subject_to=[strong], analysis=da.Statics())
    >>> best = da.optimize(rod.build(), **task)
    >>> isinstance(best, da.Optimum), best.active, round(best.fun, 6)  # ρ L F/σ
    (True, ['stress'], 7.85)
    """

    word = "optimum"
    drawn = "optimum:optimum"
    x: dict[str, float]
    fun: float
    success: bool
    message: str
    gradient: dict[str, float]
    history: list[Iterate]
    initial: Result
    motion: Result
    at_bounds: list[str] = field(default_factory=list)
    active: list[str] = field(default_factory=list)
    runs: int = 0
    failed_runs: int = 0
    violation: float = 0.0
    interrupted: bool = False
    label: str = "objective"
    unit: str = ""
    sense: str = "minimize"
    stationarity: float = 0.0
    gradients: int = 0
    variables: list[Bounded] = field(default_factory=list)
    limits: list[Bounded] = field(default_factory=list)
    optima: list[Iterate] = field(default_factory=list)
    results: list[Result] = field(default_factory=list)

    @property
    def prices(self) -> list[str]:
        """What each active limit and bound costs, in words."""
        told = (one.cost(self.unit) for one in (*self.limits, *self.variables))
        return [text for text in told if text]

    @property
    def name(self) -> str:  # type: ignore[override]
        """Of the model of the objective."""
        return str(self.motion.model.name)

    @property
    def sentence(self) -> str:
        first, unit = self.history[0].objective, f" {self.unit}" if self.unit else ""
        state = "optimal" if self.success else "not optimal"
        return f"{self.label} {first:.4g} → {self.fun:.4g}{unit}, {state}"

    def findings(self) -> dict[str, Any]:
        return {
            "x": self.x,
            "variables": [asdict(one.shown_in((), (1.0, self.unit))) for one in self.variables],
            "fun": self.fun,
            "objective": self.label,
            "unit": self.unit,
            "start": self.history[0].parameters,
            "start_fun": self.history[0].objective,
            "gradient": self.gradient,
            "violation": self.violation,
            "at_bounds": self.at_bounds,
            "active": self.active,
            "prices": self.prices,
            "stationarity": self.stationarity,
            "iterations": len(self.history) - 1,
            "runs": self.runs,
            "gradients": self.gradients,
            "failed_runs": self.failed_runs,
            "history": [asdict(i) for i in self.history],
        }

    @property
    def data(self) -> xr.Dataset:
        """The best run, and beside it the designs on the way."""
        names = list(self.history[0].parameters)
        way = [[i.parameters[n] for n in names] for i in self.history]
        return self.motion.data.assign(
            optimum_way=(("iteration", "variable"), way),
            optimum_objective=("iteration", [i.objective for i in self.history]),
            optimum_violation=("iteration", [i.violation for i in self.history]),
        ).assign_coords(variable=names)

    def plot(self, ax: Any = None) -> Any:
        """Objective over the iterations; returns the axes."""
        import matplotlib.pyplot as plt

        if ax is None:
            _, ax = plt.subplots(figsize=(6, 3.4), layout="constrained")
        ax.plot([i.objective for i in self.history], marker="o", ms=4)
        unit = f" [{self.unit}]" if self.unit else ""
        ax.set(xlabel="iteration", ylabel=f"{self.label}{unit}")
        ax.grid(alpha=0.25)
        ax.spines[["top", "right"]].set_visible(False)
        return ax

    def _repr_html_(self) -> str:
        from dalembert.report.page import InlinePage

        return self.table_html() + InlinePage(self.page())._repr_html_()

    def table_html(self) -> str:
        from dalembert.design.optimize.optimum_table import optimum_table

        return optimum_table(self)

    def __repr__(self) -> str:
        listed = ", ".join(f"{n} = {v:.6g}" for n, v in self.x.items())
        unit = f" {self.unit}" if self.unit else ""
        return f"<Optimum {self.fun:.6g}{unit} at {listed}: {self.message}>"
