"""Explicit Runge–Kutta integrators, as users choose them."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.errors import UnsupportedError
from dalembert.integrators.tableau import CLASSICAL, DORMAND_PRINCE, GILL, ButcherTableau


@dataclass(frozen=True)
class ExplicitRungeKutta:
    """Explicit method given by its tableau."""

    @property
    def tableau(self) -> ButcherTableau:
        raise NotImplementedError

    @property
    def adaptive(self) -> bool:
        return False

    @property
    def name(self) -> str:
        return type(self).__name__


@dataclass(frozen=True)
class RK4(ExplicitRungeKutta):
    """Classical method of order 4 with fixed steps (Kutta 1901)."""

    @property
    def tableau(self) -> ButcherTableau:
        return CLASSICAL


@dataclass(frozen=True)
class RKGill(ExplicitRungeKutta):
    """Gill's method of order 4 with fixed steps (Gill 1951)."""

    @property
    def tableau(self) -> ButcherTableau:
        return GILL


@dataclass(frozen=True)
class DormandPrince(ExplicitRungeKutta):
    """Dormand–Prince 5(4) with step size control.

    A step is accepted when ``max |e_i| / (atol + rtol |x_i|) ≤ 1`` over coordinates and speeds.

    Parameters
    ----------
    rtol : relative tolerance
    atol : absolute tolerance [m, rad, m/s, rad/s]
    max_step : longest step [s]; a quarter of the run if None

    Raises
    ------
    UnsupportedError
        A tolerance or ``max_step`` that is not positive.
    """

    rtol: float = 1e-8
    atol: float = 1e-10
    max_step: float | None = None

    def __post_init__(self) -> None:
        if not (self.rtol > 0 and self.atol > 0):
            raise UnsupportedError(
                f"DormandPrince(rtol={self.rtol}, atol={self.atol}): tolerances must be positive"
            )
        if self.max_step is not None and not self.max_step > 0:
            raise UnsupportedError(f"DormandPrince(max_step={self.max_step}): must be positive")

    @property
    def tableau(self) -> ButcherTableau:
        return DORMAND_PRINCE

    @property
    def adaptive(self) -> bool:
        return True
