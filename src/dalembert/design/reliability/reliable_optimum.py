"""What an optimisation with a given reliability ends with."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

from dalembert.design.decision import Decision
from dalembert.design.optimize.optimum import Optimum

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Round:
    """A design of the rounds.

    Attributes
    ----------
    objective : there
    x : parameter → value
    margin : least of the limits at their worst points, of their sizes; below zero, broken
    runs : of its optimisation
    """

    number: int
    objective: float
    x: dict[str, float]
    margin: float
    runs: int


@dataclass(frozen=True)
class ReliableLimit:
    """A limit at the best design.

    Attributes
    ----------
    value : how far it is from breaking at its worst point
    margin : the same of its size
    point : the worst point, random parameter → value
    beta : its index, None where its design point is not found
    """

    label: str
    value: float
    margin: float
    point: dict[str, float]
    beta: float | None = None


@dataclass(eq=False)
class ReliableOptimum(Decision):
    """Result of ``optimize_reliable``.

    Attributes
    ----------
    optimum : of all rounds, its limits at the worst points of the last but one
    beta : index that was wanted
    limits : ReliableLimit each
    rounds : designs on the way
    settled : whether design and worst points no longer move
    runs : of the model, of all rounds, the searches for worst points among them
    stopped : by Ctrl-C; the design is the best one reached, limits are of the last whole round, not
        a number where there was none

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
    >>> isinstance(best, da.ReliableOptimum), best.settled
    (True, True)
    >>> round(best.x["area"] * 1e4, 6)  # (µ + 3 σ) ℓ/(E u) [cm²]
    16.0
    """

    word = "optimum"
    page_functions = "reliability:reliable"
    optimum: Optimum
    beta: float
    limits: list[ReliableLimit]
    rounds: list[Round]
    settled: bool
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
        return self.optimum.success and self.settled

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
            whole = len(self.rounds)
            return f"interrupted after {whole} whole round{'' if whole == 1 else 's'}"
        if self.settled:
            return self.optimum.message
        return f"worst points still move after {len(self.rounds)} rounds; give more rounds"

    @property
    def sentence(self) -> str:
        state = "" if self.settled else f" not reached, {self.message}"
        return f"{self.optimum.sentence}, limits at β = {self.beta:g}{state}"

    def findings(self) -> dict[str, Any]:
        return self.optimum.findings() | {
            "beta": self.beta,
            "reliability": [asdict(one) for one in self.limits],
            "rounds": [asdict(one) for one in self.rounds],
            "runs": self.runs,
        }

    @property
    def data(self) -> xr.Dataset:
        """That of the optimum, with the limits and their worst points."""
        nan = float("nan")
        limits = [one.label for one in self.limits]
        names = list(self.limits[0].point)
        points = [[one.point[n] for n in names] for one in self.limits]
        return self.optimum.data.assign(
            limit_beta=("limit", [nan if one.beta is None else one.beta for one in self.limits]),
            limit_value=("limit", [one.value for one in self.limits]),
            worst_point=(("limit", "random"), points),
        ).assign_coords(limit=limits, random=names)

    def table_html(self) -> str:
        return self.optimum.table_html()

    def __repr__(self) -> str:
        listed = ", ".join(f"{n} = {v:.6g}" for n, v in self.x.items())
        rounds = len(self.rounds)
        return (
            f"<ReliableOptimum {self.fun:.6g} at {listed}, β ≥ {self.beta:g} in {rounds} rounds: "
            f"{self.message}>"
        )
