"""Backward Euler and the trapezoidal rule."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.integrators.implicit_runge_kutta import ButcherMatrix, ImplicitRungeKutta

BACKWARD_EULER = ButcherMatrix(((1.0,),), order=1)
TRAPEZOIDAL = ButcherMatrix(((0.0, 0.0), (0.5, 0.5)), order=2)


@dataclass(frozen=True, kw_only=True)
class BackwardEuler(ImplicitRungeKutta):
    """``x⁺ = x + h F(t + h, x⁺, z⁺)`` (5.6): order 1, damps whatever is fast."""

    @property
    def matrix(self) -> ButcherMatrix:
        return BACKWARD_EULER


@dataclass(frozen=True, kw_only=True)
class Trapezoidal(ImplicitRungeKutta):
    """``x⁺ = x + h/2 (F(t, x, z) + F(t + h, x⁺, z⁺))``: order 2, no damping at all.

    The algebraic variables at the beginning of a step are those of the accelerations there.
    """

    @property
    def matrix(self) -> ButcherMatrix:
        return TRAPEZOIDAL
