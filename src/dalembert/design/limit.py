"""Limits on the responses of a design, and bounded values at an optimum."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from dalembert.errors import AnalysisError
from dalembert.options import options
from dalembert.responses.base import Response
from dalembert.units.measured import check_measured
from dalembert.units.unit import shown_in


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
        unit = self.response.declared_unit if isinstance(self.response, Response) else ""
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


STEPS = {"m": ("mm", 1e-3), "m^2": ("mm^2", 1e-6), "Pa": ("MPa", 1e6)}
"""Unit → increment of a bound for which its price is quoted, and its size in that unit."""


@dataclass(frozen=True)
class Bounded:
    """A parameter or a limited response at the optimum.

    Attributes
    ----------
    name, unit
    start, value : at the start and at the optimum
    lower, upper : bounds
    active : active side, ``"lower"``, ``"upper"`` or empty
    price : improvement of the objective per unit by which the active side is relaxed, ≥ 0
    declared_unit : unit in which a parameter was declared, such as ``mm``
    """

    name: str
    unit: str
    start: float
    value: float
    lower: float | None
    upper: float | None
    active: str = ""
    price: float = 0.0
    declared_unit: str = ""

    def shown_in(self, units: Sequence[str], objective: tuple[float, str]) -> Bounded:
        """Copy in the first of ``units`` with its dimension, else in the unit of its declaration.

        ``objective`` is the factor and the unit of the objective.
        """
        declared = (self.declared_unit,) if self.declared_unit else ()
        factor, unit = shown_in(self.unit, (*units, *declared))

        def converted(number: float | None) -> float | None:
            return None if number is None else number / factor

        return replace(
            self,
            unit=unit,
            start=self.start / factor,
            value=self.value / factor,
            lower=converted(self.lower),
            upper=converted(self.upper),
            price=self.price * factor / objective[0],
        )

    def cost(self, unit: str) -> str:
        """``this bound costs 3.1 N per mm`` for an objective in ``unit``."""
        if not self.active or self.price == 0:
            return ""
        per, size = STEPS.get(self.unit, (self.unit or "unit", 1.0))
        price = f"{self.price * size:.4g} {unit}".rstrip()
        return f"{self.name} at its {self.active} bound costs {price} per {per}"
