"""Backward Euler and the trapezoidal rule."""

from __future__ import annotations

from dataclasses import dataclass

from dalembert.integrators.runge_kutta.implicit_step import ButcherMatrix, ImplicitRungeKutta

BACKWARD_EULER = ButcherMatrix(((1.0,),), order=1)
TRAPEZOIDAL = ButcherMatrix(((0.0, 0.0), (0.5, 0.5)), order=2)


@dataclass(frozen=True, kw_only=True)
class BackwardEuler(ImplicitRungeKutta):
    """``x⁺ = x + h F(t + h, x⁺, z⁺)`` (5.6): order 1, L-stable: damps all fast modes.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("drag")
    >>> boat = system.add(planar.Particle("boat", mass=1.0, velocity=(1, 0)))
    >>> water = system.add(planar.Force("water", boat.center, (-boat.vx, 0)))
    >>> model = system.build()
    >>> implicit = dict(formulation=da.Dae(index=1), integrator=da.BackwardEuler())
    >>> motion = da.solve_dynamics(model, 0.5, step=0.5, **implicit)
    >>> round(motion["boat.vx"][-1].item(), 9)  # 1/(1 + h), where exp(-h) is right
    0.666666667
    """

    @property
    def matrix(self) -> ButcherMatrix:
        return BACKWARD_EULER


@dataclass(frozen=True, kw_only=True)
class Trapezoidal(ImplicitRungeKutta):
    """``x⁺ = x + h/2 (F(t, x, z) + F(t + h, x⁺, z⁺))``: order 2, A-stable, no damping.

    The algebraic variables at the start of a step follow from the accelerations there.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("drag")
    >>> boat = system.add(planar.Particle("boat", mass=1.0, velocity=(1, 0)))
    >>> water = system.add(planar.Force("water", boat.center, (-boat.vx, 0)))
    >>> model = system.build()
    >>> implicit = dict(formulation=da.Dae(index=1), integrator=da.Trapezoidal())
    >>> motion = da.solve_dynamics(model, 0.5, step=0.5, **implicit)
    >>> round(motion["boat.vx"][-1].item(), 9)  # (1 - h/2)/(1 + h/2)
    0.6
    """

    @property
    def matrix(self) -> ButcherMatrix:
        return TRAPEZOIDAL
