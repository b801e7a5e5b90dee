"""Explicit Runge–Kutta integrators."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import Attempt, Integrator, Problem
from dalembert.integrators.error_control import ErrorControlled, absolute, share
from dalembert.integrators.runge_kutta.explicit_step import ExplicitStep, embedded_attempt
from dalembert.integrators.runge_kutta.tableau import (
    CLASSICAL,
    DORMAND_PRINCE,
    DORMAND_PRINCE_853,
    EXPLICIT_EULER,
    GILL,
    HEUN,
    ButcherTableau,
)
from dalembert.integrators.step import Step
from dalembert.options import options


@dataclass(frozen=True)
class ExplicitRungeKutta(Integrator, ABC):
    """Explicit method defined by its tableau: ``x⁺ = x + h Σ b_i k_i``.

    Raises
    ------
    UnsupportedError
        On use: a formulation that provides no accelerations.
    """

    @property
    @abstractmethod
    def tableau(self) -> ButcherTableau:
        """Coefficients of the method."""

    @property
    def convergence_order(self) -> int:
        return self.tableau.order

    @property
    def evaluations(self) -> int:
        return self.tableau.stages

    @property
    def stability(self) -> Callable[[np.ndarray], np.ndarray]:
        return self.tableau.stability

    def check(self, problem: Problem) -> None:
        if problem.rate is None:
            raise UnsupportedError(
                f"{self.name} is explicit and needs accelerations; with this formulation use an "
                "implicit integrator such as Radau() or BDF(), or use formulation=RangeSpace()"
            )

    def step(self, problem: Problem) -> ExplicitStep:
        assert problem.rate is not None
        return ExplicitStep(self.tableau, problem.rate, problem.correction, problem.upkeep)


@dataclass(frozen=True)
class Euler(ExplicitRungeKutta):
    """Explicit method of order 1 with fixed steps (Euler 1768).

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("fall", gravity=(0, -10))
    >>> stone = system.add(planar.Particle("stone", mass=1.0))
    >>> motion = da.solve_dynamics(system.build(), 1.0, step=0.1, integrator=da.Euler())
    >>> round(motion["stone.y"][-1].item(), 6)  # -5 (1 - h), from speeds before
    -4.5
    """

    @property
    def tableau(self) -> ButcherTableau:
        return EXPLICIT_EULER


@dataclass(frozen=True)
class Heun(ExplicitRungeKutta):
    """Explicit trapezoidal rule of order 2 with fixed steps (Heun 1900).

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("drag")
    >>> boat = system.add(planar.Particle("boat", mass=1.0, velocity=(1, 0)))
    >>> water = system.add(planar.Force("water", boat.center, (-boat.vx, 0)))
    >>> model = system.build()
    >>> motion = da.solve_dynamics(model, 0.5, step=0.5, integrator=da.Heun())
    >>> round(motion["boat.vx"][-1].item(), 9)  # 1 - h + h²/2
    0.625
    """

    @property
    def tableau(self) -> ButcherTableau:
        return HEUN


@dataclass(frozen=True)
class RK4(ExplicitRungeKutta):
    """Classical method of order 4 with fixed steps (Kutta 1901).

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("drag")
    >>> boat = system.add(planar.Particle("boat", mass=1.0, velocity=(1, 0)))
    >>> water = system.add(planar.Force("water", boat.center, (-boat.vx, 0)))
    >>> model = system.build()
    >>> motion = da.solve_dynamics(model, 0.5, step=0.5, integrator=da.RK4())
    >>> round(motion["boat.vx"][-1].item(), 9)  # 1 - h + h²/2 - h³/6 + h⁴/24
    0.606770833
    """

    @property
    def tableau(self) -> ButcherTableau:
        return CLASSICAL


@dataclass(frozen=True)
class RKGill(ExplicitRungeKutta):
    """Gill's method of order 4 with fixed steps (Gill 1951).

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("drag")
    >>> boat = system.add(planar.Particle("boat", mass=1.0, velocity=(1, 0)))
    >>> water = system.add(planar.Force("water", boat.center, (-boat.vx, 0)))
    >>> model = system.build()
    >>> errors = []
    >>> for step in (0.5, 0.25):
    ...     motion = da.solve_dynamics(model, 1.0, step=step, integrator=da.RKGill())
    ...     errors.append(abs(motion["boat.vx"][-1].item() - 0.36787944117144233))
    >>> errors[0] / errors[1] > 2**4  # order 4
    True
    """

    @property
    def tableau(self) -> ButcherTableau:
        return GILL


@options
class AdaptiveRungeKutta(ErrorControlled, ExplicitRungeKutta):
    """Embedded method whose step length follows the estimated error of coordinates and speeds.

    Lengths follow a PI controller (Gustafsson 1991).
    """

    @property
    def order(self) -> int:
        return self.tableau.order

    def attempt(self, problem: Problem, step: Step) -> Attempt:
        assert isinstance(step, ExplicitStep)
        atol = absolute(self.atol, share(self.rtol), problem, step.size)
        return embedded_attempt(problem, step, self.rtol, atol)


@dataclass(frozen=True)
class DormandPrince(AdaptiveRungeKutta):
    """Dormand–Prince 5(4) with step size control (Dormand and Prince 1980).

    A step is accepted when ``max |e_i| / (atol + rtol |x_i|) ≤ 1`` over coordinates and speeds.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("drag")
    >>> boat = system.add(planar.Particle("boat", mass=1.0, velocity=(1, 0)))
    >>> water = system.add(planar.Force("water", boat.center, (-boat.vx, 0)))
    >>> model = system.build()
    >>> careful = da.DormandPrince(rtol=1e-9, atol=1e-9)
    >>> motion = da.solve_dynamics(model, 2.0, integrator=careful)
    >>> round(motion["boat.vx"][-1].item(), 8)  # exp(-2)
    0.13533528
    """

    @property
    def tableau(self) -> ButcherTableau:
        return DORMAND_PRINCE


@dataclass(frozen=True)
class DormandPrince853(AdaptiveRungeKutta):
    """Dormand–Prince 8(5,3) with step size control, for tolerances below about 1e-7.

    A step is accepted when ``‖e₅‖² / √(‖e₅‖² + 0.01 ‖e₃‖²) ≤ 1``, with the norms of the estimates
    of orders 5 and 3 over coordinates and speeds as in ``ButcherTableau`` (Hairer, Nørsett and
    Wanner 1993, II.10).

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("drag")
    >>> boat = system.add(planar.Particle("boat", mass=1.0, velocity=(1, 0)))
    >>> water = system.add(planar.Force("water", boat.center, (-boat.vx, 0)))
    >>> model = system.build()
    >>> steps = {}
    >>> for integrator in (da.DormandPrince(1e-12, 1e-12), da.DormandPrince853(1e-12, 1e-12)):
    ...     motion = da.solve_dynamics(model, 5.0, integrator=integrator)
    ...     steps[type(integrator).__name__] = motion.statistics["steps"]
    >>> steps["DormandPrince853"] < 0.5 * steps["DormandPrince"]  # worth it at such tolerances
    True
    """

    @property
    def tableau(self) -> ButcherTableau:
        return DORMAND_PRINCE_853
