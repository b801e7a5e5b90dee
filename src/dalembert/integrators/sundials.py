"""CVODES and IDAS of the SUNDIALS suite (Hindmarsh et al. 2005), one interval after another."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import Integrator, Problem
from dalembert.integrators.step import GraphStep
from dalembert.integrators.tolerances import check_tolerances
from dalembert.options import options
from dalembert.symbolic.semi_explicit import SemiExplicit

MOST_STEPS = 50_000
"""Steps that SUNDIALS may take within one interval."""
SHORT = 1e-6
"""Share of the interval for which IDAS looks when it makes its start values consistent."""


@options
class SundialsIntegrator(Integrator, ABC):
    """Variable steps and orders inside each interval of the run, the interval being its ``step``.

    SUNDIALS starts anew, with order 1 and short steps, in every interval: a run is fastest with
    few long ones. A stabilisation corrects at their ends. Where SUNDIALS gives up, the run ends as
    ``DIVERGED`` with what was reached.

    Gradients come from the sensitivity equations that CasADi integrates along: direct and adjoint
    gradients are right to about the tolerances, and agree with each other to as much only. For
    exact derivatives of the steps use ``Bdf``, ``Radau`` or ``RK4``.

    Parameters
    ----------
    rtol : relative tolerance [-]
    atol : absolute tolerance of all states [m, rad, m/s, rad/s, J]

    Raises
    ------
    UnsupportedError
        A tolerance that is not positive.
    """

    rtol: float = 1e-8
    atol: float = 1e-10

    def __post_init__(self) -> None:
        check_tolerances(self.name, self.rtol, self.atol)

    @property
    def controls_error(self) -> bool:
        return True

    @property
    def options(self) -> dict:
        """What SUNDIALS is told."""
        return {
            "reltol": self.rtol,
            "abstol": self.atol,
            "max_num_steps": MOST_STEPS,
            "disable_internal_warnings": True,
        }

    def step(self, problem: Problem) -> GraphStep:
        """One interval; time runs from 0 to 1 in it, so that its length is a number like others."""
        return GraphStep(
            self.interval(problem),
            self.state_size(problem),
            correction=problem.correction,
            upkeep=problem.upkeep,
        )

    @abstractmethod
    def state_size(self, problem: Problem) -> int:
        """Length of the state."""

    @abstractmethod
    def interval(self, problem: Problem) -> ca.Function:
        """``(t, h, x, p) → x`` at ``t + h``."""


@dataclass(frozen=True)
class Cvodes(SundialsIntegrator):
    """Backward differentiation of ``ẋ = F(t, x, p)`` by CVODES, orders 1 to 5.

    The run's ``step`` is the interval after which CVODES starts anew: few long ones are best, and
    outputs between them are integrated from their beginnings. Gradients are right to about the
    tolerances, see ``Bdf`` for exact ones.

    Parameters
    ----------
    rtol : relative tolerance [-]
    atol : absolute tolerance of all states [m, rad, m/s, rad/s, J]

    Raises
    ------
    UnsupportedError
        A tolerance that is not positive, or a formulation without accelerations.
    """

    def state_size(self, problem: Problem) -> int:
        return self._rate(problem).numel_out(0)

    def _rate(self, problem: Problem) -> ca.Function:
        if problem.rate is None:
            raise UnsupportedError(
                "Cvodes integrates accelerations, which this formulation does not give; use "
                "integrator=Radau() or Bdf(), or formulation=RangeSpace()"
            )
        return problem.rate.function

    def interval(self, problem: Problem) -> ca.Function:
        rate = self._rate(problem)
        x, p = ca.SX.sym("x", rate.numel_in(1)), ca.SX.sym("p", rate.numel_in(2))
        t, h, fraction = ca.SX.sym("t"), ca.SX.sym("h"), ca.SX.sym("fraction")
        equations = {
            "t": fraction,
            "x": x,
            "p": ca.vertcat(t, h, p),
            "ode": h * rate(t + h * fraction, x, p),
        }
        solver = ca.integrator("cvodes", "cvodes", equations, 0, 1, self.options)
        return _interval(solver, x.numel(), p.numel())


@dataclass(frozen=True)
class Ida(SundialsIntegrator):
    """Backward differentiation of ``ẋ = F(t, x, z, p)``, ``0 = G(t, x, z, p)`` by IDAS.

    The system has index 1: accelerations and multipliers are algebraic and left out of the error
    control. The run's ``step`` is the interval after which IDAS starts anew: few long ones are
    best, and outputs between them are integrated from their beginnings. Gradients are right to
    about the tolerances, see ``Bdf`` for exact ones.

    Parameters
    ----------
    rtol : relative tolerance [-]
    atol : absolute tolerance of all states [m, rad, m/s, rad/s, J]

    Raises
    ------
    UnsupportedError
        A tolerance that is not positive, or a system of index 2 or 3.
    """

    @property
    def implicit(self) -> bool:
        return True

    @property
    def options(self) -> dict:
        # the line search of IDACalcIC fails where start values are right and its scale is coarse
        start = {"calc_ic": True, "first_time": SHORT}
        return {**super().options, "suppress_algebraic": True, **start}

    def state_size(self, problem: Problem) -> int:
        return problem.system.x.numel()

    def interval(self, problem: Problem) -> ca.Function:
        system: SemiExplicit = problem.system
        if system.index > 1:
            raise UnsupportedError(
                f"Ida takes systems of index 1, this formulation makes one of index "
                f"{system.index}; use integrator=Bdf() or Radau(), or formulation=Dae(index=1)"
            )
        t, h, fraction = ca.SX.sym("t"), ca.SX.sym("h"), ca.SX.sym("fraction")
        rate, algebraic = ca.substitute(
            [system.rate, system.algebraic], [system.t], [t + h * fraction]
        )
        equations = {
            "t": fraction,
            "x": system.x,
            "z": system.z,
            "p": ca.vertcat(t, h, system.p),
            "ode": h * rate,
            "alg": algebraic,
        }
        solver = ca.integrator("idas", "idas", equations, 0, 1, self.options)
        return _interval(solver, system.x.numel(), system.p.numel(), system.start.function)


def _interval(
    solver: ca.Function, states: int, parameters: int, start: ca.Function | None = None
) -> ca.Function:
    """``(t, h, x, p) → x`` by a solver, with its algebraic variables at the start if it has any."""
    t, h, x = ca.MX.sym("t"), ca.MX.sym("h"), ca.MX.sym("x", states)
    p = ca.MX.sym("p", parameters)
    algebraic = {} if start is None else {"z0": start(t, x, p)}
    end = solver(x0=x, p=ca.vertcat(t, h, p), **algebraic)["xf"]
    return ca.Function("interval", [t, h, x, p], [end])
