"""Result of an optimisation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

from dalembert.design.decision import Decision, axis_label, plot_axes
from dalembert.design.limit import Bounded
from dalembert.results.result import Result

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

    from dalembert.design.pages.live import LiveTask
    from dalembert.design.quantity import Quantity


@dataclass(frozen=True)
class Iterate:
    """The design after one iteration."""

    parameters: dict[str, float]
    objective: float
    violation: float


@dataclass(eq=False)
class OptimizationResult(Decision):
    """Optimal design with its verification.

    Attributes
    ----------
    x : parameter → value
    fun : objective at ``x``
    success : feasible, and first-order optimality is verified
    message : message of the optimiser and findings of the verification
    interrupted : ended by Ctrl-C; the design is the best one reached
    gradient : of the objective by the variables
    history : iterates, the start first
    initial, motion : results of the start and of the best design, in the case of the objective
    results : results of the best design in all cases
    quantities : objective and limited quantities
    at_bounds : parameters at one of their bounds
    active : active limits
    stationarity : relative residual of the stationarity condition: zero at an optimum
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
    >>> isinstance(best, da.OptimizationResult), best.active, round(best.fun, 6)  # ρ L F/σ
    (True, ['stress'], 7.85)
    """

    file_suffix = "optimum"
    page_functions = "optimum:optimum"
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
    quantities: Sequence[Quantity] = field(default=(), repr=False)

    @property
    def prices(self) -> list[str]:
        """Price of each active limit and bound, as text."""
        texts = (bounded.cost(self.unit) for bounded in (*self.limits, *self.variables))
        return [text for text in texts if text]

    @property
    def name(self) -> str:  # type: ignore[override]
        """Name of the model of the objective."""
        return str(self.motion.model.name)

    @property
    def sentence(self) -> str:
        first, unit = self.history[0].objective, f" {self.unit}" if self.unit else ""
        return f"{self.label} {first:.4g} → {self.fun:.4g}{unit}, {self.state}"

    @property
    def state(self) -> str:
        """Whether the design is optimal, or the search was interrupted."""
        if self.interrupted:
            return "interrupted before the optimum"
        return "optimal" if self.success else "not optimal"

    def findings(self) -> dict[str, Any]:
        return {
            "x": self.x,
            "variables": [
                asdict(variable.shown_in((), (1.0, self.unit))) for variable in self.variables
            ],
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
            "history": [asdict(iterate) for iterate in self.history],
        }

    def live_task(self) -> LiveTask | None:
        task: LiveTask | None = self._page_function("task")(self)
        return task

    @property
    def data(self) -> xr.Dataset:
        """Result of the best design, and the iterates."""
        names = list(self.history[0].parameters)
        designs = [[iterate.parameters[n] for n in names] for iterate in self.history]
        return self.motion.data.assign(
            optimum_way=(("iteration", "variable"), designs),
            optimum_objective=("iteration", [iterate.objective for iterate in self.history]),
            optimum_violation=("iteration", [iterate.violation for iterate in self.history]),
        ).assign_coords(variable=names)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Objective over the iterations; returns the axes."""
        ax = plot_axes(ax, (6, 3.4))
        ax.plot([i.objective for i in self.history], marker="o", ms=4)
        ax.set(xlabel="iteration", ylabel=axis_label(self.label, self.unit))
        return ax

    def _repr_html_(self) -> str:
        from dalembert.report.page import InlinePage

        return self.table_html() + InlinePage(self.page())._repr_html_()

    def table_html(self) -> str:
        return str(self._page_function("table")(self))

    def __repr__(self) -> str:
        listed = ", ".join(f"{n} = {v:.6g}" for n, v in self.x.items())
        unit = f" {self.unit}" if self.unit else ""
        return f"<OptimizationResult {self.fun:.6g}{unit} at {listed}: {self.message}>"
