"""What an optimisation ends with."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from dalembert.design.bounded import Bounded
from dalembert.results.result import Result


@dataclass(frozen=True)
class Iterate:
    """The design after one iteration."""

    parameters: dict[str, float]
    objective: float
    violation: float


@dataclass(eq=False)
class Optimum:
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
    """

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

    def report(self, path: Any, **first_view: Any) -> Any:
        """Write the interactive report of the best design, the first one as a ghost beside it."""
        from dalembert.design.optimum_page import optimum_page
        from dalembert.report.page import write_page

        return write_page(optimum_page(self, **first_view), path)

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
        from dalembert.design.optimum_table import optimum_table

        return optimum_table(self)

    def __repr__(self) -> str:
        listed = ", ".join(f"{n} = {v:.6g}" for n, v in self.x.items())
        unit = f" {self.unit}" if self.unit else ""
        return f"<Optimum {self.fun:.6g}{unit} at {listed}: {self.message}>"
