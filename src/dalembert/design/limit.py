"""Limits on the responses of a design."""

from __future__ import annotations

from typing import Any

from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.responses.base import Response
from dalembert.units.measured import check_measured


@options
class Limit:
    """``lower ≤ response ≤ upper``; equal limits state an equation.

    Parameters
    ----------
    response : Response, a response of a case, or a combination of such
    lower, upper : numbers, or texts with units such as ``"200 MPa"``; None for no bound

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
    >>> strong = da.Limit(da.final("rod.stress"), upper=1e8)
    >>> task = dict(minimize=da.final("mass"), subject_to=[strong], analysis=da.Statics())
    >>> best = da.optimize(rod.build(), **task)
    >>> round(best.x["area"] * 1e4, 6), best.active  # F/σ [cm²]
    (5.0, ['final(rod.stress)'])
    """

    response: Any
    lower: float | None = None
    upper: float | None = None

    def __post_init__(self) -> None:
        label = getattr(self.response, "label", repr(self.response))
        if self.lower is None and self.upper is None:
            raise AnalysisError(f"limit on {label}: give lower or upper")
        if self.lower is not None and self.upper is not None and self.lower > self.upper:
            raise AnalysisError(f"limit on {label}: lower {self.lower} is above upper {self.upper}")
        unit = self.response.known_unit if isinstance(self.response, Response) else ""
        check_measured((self.lower, self.upper), unit, f"limit on {label}")

    @classmethod
    def all_of(cls, limits: Any) -> list[Limit]:
        """List of limits from the argument ``subject_to``.

        Raises
        ------
        AnalysisError
            An entry is no limit, such as a response without bounds.
        """
        listed = list(limits) if isinstance(limits, (list, tuple)) else [limits]
        for limit in listed:
            if not isinstance(limit, cls):
                label = getattr(limit, "label", repr(limit))
                raise AnalysisError(
                    f"subject_to takes limits, got {label}; give its bounds, "
                    "da.Limit(response, lower=…, upper=…)"
                )
        return listed

    @property
    def is_equation(self) -> bool:
        """Whether both bounds are the same number."""
        return self.lower is not None and self.lower == self.upper
