"""Robust response: mean and standard deviation over random parameters as one quantity.

Univariate dimension reduction (Rahman and Xu 2004): ``r ≈ Σ r_k(u_k) − (n−1) r(0)`` in
independent standard normal variables, each by three Gauss–Hermite points: ``2n + 1`` runs. The mean
is exact for sums of cubics of single variables, the deviation for sums of quadratics.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from dalembert.design.case import Case
from dalembert.design.quantity import AnalysisCase, CaseResponse, Quantity
from dalembert.design.reliability.distribution import Distribution
from dalembert.design.reliability.nataf import Correlation, Nataf
from dalembert.design.reliability.shifted import case_at
from dalembert.errors import AnalysisError
from dalembert.responses.base import Response

POINTS = np.sqrt(3.0)
WEIGHTS = (2 / 3, 1 / 6, 1 / 6)


@dataclass(frozen=True, eq=False)
class Robust(Quantity):
    """``mean + deviations · standard deviation`` of a response.

    Parameters
    ----------
    response : random response
    random : parameter → distribution; of a design variable, the mean is the design
    deviations : number of standard deviations added; negative for a quantity to be maximised
    correlation : as of ``reliability``
    name : label
    case : of the response; set when a design problem is built
    runs : the response at the integration points

    Examples
    --------
    >>> import dalembert as da
    >>> aim = da.robust(da.final("end.ux"), {"load": da.Normal(1e5, 1e4)}, deviations=2)
    >>> isinstance(aim, da.Robust), aim.deviations
    (True, 2)
    """

    response: Response
    random: Mapping[str, Distribution]
    deviations: float = 3.0
    correlation: Correlation = None
    name: str = ""
    case: Case | None = None
    runs: Sequence[CaseResponse] = ()

    def __post_init__(self) -> None:
        if not isinstance(self.response, Response):
            raise AnalysisError(
                f"{self.response!r:.60} is not a response; give a response of one analysis"
            )
        if not self.random:
            raise AnalysisError("nothing is random; give {parameter: distribution}")

    @property
    def label(self) -> str:  # type: ignore[override]
        return self.name or f"robust {self.response.label}"

    @property
    def terms(self) -> list[CaseResponse]:
        return list(self.runs)

    def _graph(self, values: ca.SX) -> ca.SX:
        """Expression of the responses at the centre and on both sides of each variable."""
        centre, mean, variance = values[0], values[0], ca.SX(0)
        for k in range((values.numel() - 1) // 2):
            samples = ca.vertcat(centre, values[1 + 2 * k], values[2 + 2 * k])
            weights = ca.DM(WEIGHTS)
            marginal_mean = ca.dot(weights, samples)
            mean += marginal_mean - centre
            variance += ca.dot(weights, (samples - marginal_mean) ** 2)
        return mean + self.deviations * ca.sqrt(variance + 1e-30)

    def _function(self, size: int) -> ca.Function:
        values = ca.SX.sym("values", size)
        robust_value = self._graph(values)
        return ca.Function("robust", [values], [robust_value, ca.gradient(robust_value, values)])

    def value(self, values: np.ndarray) -> float:
        return float(self._function(values.size)(values)[0])

    def slope(self, values: np.ndarray) -> np.ndarray:
        return np.array(self._function(values.size)(values)[1]).ravel()

    def unit(self, units: Sequence[str]) -> str:
        return units[0]

    def of(self, case: AnalysisCase | None) -> Quantity:
        """Copy with the integration points of a case."""
        if self.case is not None:
            return self
        if not isinstance(case, Case):
            raise AnalysisError(f"{self.label} has no case; give model and analysis=")
        return replace(self, case=case).varying(())

    def varying(self, names: Sequence[str]) -> Robust:
        if self.case is None:
            return self
        nataf = Nataf(self.random, self.correlation)
        offsets = [s * POINTS * row for row in np.eye(nataf.size) for s in (1, -1)]
        points = [nataf.values(u) for u in (np.zeros(nataf.size), *offsets)]
        runs = [case_at(self.case, self.random, x, names)[self.response] for x in points]
        return replace(self, runs=runs)


def robust(
    response: Response,
    random: Mapping[str, Distribution],
    deviations: float = 3.0,
    *,
    correlation: Correlation = None,
    name: str = "",
) -> Robust:
    """Mean of a response over random parameters plus a multiple of its standard deviation.

    An objective or constraint of ``optimize`` and ``pareto`` with exact gradients.

    Parameters
    ----------
    response : random response
    random : parameter → distribution; of a design variable, the mean is the design
    deviations : number of standard deviations added; negative for a quantity to be maximised
    correlation : pair of names → linear correlation, or the whole matrix
    name : label

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
    >>> stress = da.robust(da.final("rod.stress"), {"load": da.Normal(1e5, 1e4)})
    >>> task = dict(subject_to=[da.Limit(stress, upper=2e8)], analysis=da.Statics())
    >>> best = da.optimize(rod.build(), minimize=da.final("mass"), **task)
    >>> round(best.x["area"] * 1e4, 6)  # (µ + 3 σ)/strength [cm²]
    6.5
    """
    return Robust(response, random, deviations, correlation, name)
