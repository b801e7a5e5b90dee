"""Result of reliability-based design optimisation."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from dalembert.design.decision import Decision
from dalembert.design.optimize.optimization_result import OptimizationResult

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Round:
    """The design after a round.

    Attributes
    ----------
    objective : value at the design
    x : parameter → value
    margin : smallest relative margin of the limits at their worst points; negative if violated
    runs : number of runs of its optimisation
    """

    number: int
    objective: float
    x: dict[str, float]
    margin: float
    runs: int


@dataclass(frozen=True)
class ReliableLimit:
    """A limit at the optimal design.

    Attributes
    ----------
    value : margin at the worst point, positive if safe
    margin : the same, relative to the bound
    point : the worst point, random parameter → value
    beta : reliability index; None if its design point could not be computed
    """

    label: str
    value: float
    margin: float
    point: dict[str, float]
    beta: float | None = None


@dataclass(eq=False)
class ReliableOptimizationResult(Decision):
    """Result of ``optimize_reliable``.

    Attributes
    ----------
    optimum : optimum of the last round, with limits at the worst points of the previous round
    beta : required reliability index
    limits : ReliableLimit of each limit
    rounds : designs of all rounds
    converged : whether design and worst points have converged
    runs : number of runs in all rounds, including the searches for worst points
    stopped : by Ctrl-C; the design is the best so far, limits are those of the last complete round,
        NaN without one

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import structures
    >>> rod = da.Structure("rod")
    >>> load = rod.parameter("load", 1e5, "N")
    >>> area = rod.parameter("area", 1e-3, "m^2", bounds=(1e-4, 1e-2))
    >>> top, end = rod.node("top", 0), rod.node("end", 2)
    >>> part = rod.add(structures.Truss("rod", top, end, area=area, modulus=2e11, density=7850))
    >>> rod.support(top)
    >>> rod.load(end, fx=load)
    >>> stiff = da.Limit(da.final("end.ux"), upper=1e-3)
    >>> task = dict(subject_to=[stiff], random={"load": da.Normal(1e5, 2e4)})
    >>> best = da.optimize_reliable(rod.build(), da.final("mass"), **task, analysis=da.Statics())
    >>> isinstance(best, da.ReliableOptimizationResult), best.converged
    (True, True)
    >>> round(best.x["area"] * 1e4, 6)  # (µ + 3 σ) ℓ/(E u) [cm²]
    16.0
    """

    file_suffix = "optimum"
    page_functions = "reliability:reliable"
    optimum: OptimizationResult
    beta: float
    limits: list[ReliableLimit]
    rounds: list[Round]
    converged: bool
    runs: int
    stopped: bool = False

    @property
    def x(self) -> dict[str, float]:
        return self.optimum.x

    @property
    def fun(self) -> float:
        return self.optimum.fun

    @property
    def success(self) -> bool:  # type: ignore[override]
        return self.optimum.success and self.converged

    @property
    def interrupted(self) -> bool:  # type: ignore[override]
        return self.stopped

    def interrupt(self) -> None:
        self.stopped = True

    @property
    def name(self) -> str:  # type: ignore[override]
        return self.optimum.name

    @property
    def message(self) -> str:  # type: ignore[override]
        if self.stopped:
            count = len(self.rounds)
            return f"interrupted after {count} complete round{'' if count == 1 else 's'}"
        if self.converged:
            return self.optimum.message
        return f"worst points still move after {len(self.rounds)} rounds; give more rounds"

    @property
    def sentence(self) -> str:
        state = "" if self.converged else f" not reached, {self.message}"
        return f"{self.optimum.sentence}, limits at β = {self.beta:g}{state}"

    def findings(self) -> dict[str, Any]:
        return self.optimum.findings() | {
            "beta": self.beta,
            "reliability": [asdict(entry) for entry in self.limits],
            "rounds": [asdict(entry) for entry in self.rounds],
            "runs": self.runs,
        }

    @property
    def data(self) -> xr.Dataset:
        """Data of the optimum, with the limits and their worst points."""
        nan = float("nan")
        limits = [limit.label for limit in self.limits]
        names = list(self.limits[0].point)
        points = [[limit.point[n] for n in names] for limit in self.limits]
        return self.optimum.data.assign(
            limit_beta=(
                "limit",
                [nan if limit.beta is None else limit.beta for limit in self.limits],
            ),
            limit_value=("limit", [limit.value for limit in self.limits]),
            worst_point=(("limit", "random"), points),
        ).assign_coords(limit=limits, random=names)

    def table_html(self) -> str:
        return self.optimum.table_html()

    def __repr__(self) -> str:
        listed = ", ".join(f"{n} = {v:.6g}" for n, v in self.x.items())
        rounds = len(self.rounds)
        return (
            f"<ReliableOptimizationResult {self.fun:.6g} at {listed}, β ≥ {self.beta:g} "
            f"in {rounds} rounds: {self.message}>"
        )
