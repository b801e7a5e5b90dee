"""What an optimisation may not leave, and what it ends with."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.responses.base import Response
from dalembert.results.result import Result


@options
class Limit:
    """``lower ≤ response ≤ upper``; equal limits make an equation.

    Parameters
    ----------
    response : Response
    lower, upper : None leaves a side open
    """

    response: Response
    lower: float | None = None
    upper: float | None = None

    def __post_init__(self) -> None:
        if self.lower is None and self.upper is None:
            raise AnalysisError(f"limit on {self.response.label}: give lower or upper")
        if self.lower is not None and self.upper is not None and self.lower > self.upper:
            raise AnalysisError(
                f"limit on {self.response.label}: lower {self.lower} is above upper {self.upper}"
            )


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
    success, message : how the optimiser ended
    interrupted : by Ctrl-C; the design is the last one reached
    gradient : of the objective
    history : the design after every iteration, the start first
    initial, motion : runs of the first and the best design
    at_bounds : parameters that ended at a bound
    active : limits that hold with equality
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

    def plot(self, ax: Any = None) -> Any:
        """Objective over the iterations; returns the axes."""
        import matplotlib.pyplot as plt

        if ax is None:
            _, ax = plt.subplots(figsize=(6, 3.4), layout="constrained")
        ax.plot([i.objective for i in self.history], marker="o", ms=4)
        ax.set(xlabel="iteration", ylabel="objective")
        ax.grid(alpha=0.25)
        ax.spines[["top", "right"]].set_visible(False)
        return ax

    def __repr__(self) -> str:
        listed = ", ".join(f"{n} = {v:.6g}" for n, v in self.x.items())
        return f"<Optimum {self.fun:.6g} at {listed}: {self.message}>"
