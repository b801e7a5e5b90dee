"""CVODES and IDAS of the SUNDIALS suite (Hindmarsh et al. 2005)."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass

import casadi as ca
import numpy as np

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import Integrator, Problem
from dalembert.integrators.error_control import check_tolerances, natural
from dalembert.integrators.sundials_step import MAX_STEPS, Flow, SundialsStep
from dalembert.options import options
from dalembert.symbolic.equations.semi_explicit import SemiExplicit

FINER, FINEST = 1e-2, 1e-13
"""Tolerance of sensitivity equations relative to that of the run, and its lower limit [-]."""
ATOL_SHARE = 1e-12
"""Default absolute tolerance relative to natural sizes [-]."""
FIRST_TIME = 1e-6
"""Output time for the consistent initial values of IDAS, relative to the interval [-]."""


@options
class SundialsIntegrator(Integrator, ABC):
    """Variable steps and orders inside each interval of the run, the interval being its ``step``.

    SUNDIALS continues over several hundred intervals; after these, and for times between their
    ends, it restarts with order 1 and short steps. A stabilisation corrects the states at the ends.
    If SUNDIALS fails, the run ends with the states reached.

    Gradients come from the sensitivity equations, integrated to a hundredth of the tolerances:
    direct and adjoint gradients are accurate to about the tolerances of the run, and agree with
    each other more closely. For exact derivatives of the steps use ``BDF``, ``Radau`` or ``RK4``.

    Parameters
    ----------
    rtol : relative tolerance [-]
    atol : absolute tolerance of all states [m, rad, m/s, rad/s, J]; by default 1e-12 of their
        natural sizes

    Raises
    ------
    UnsupportedError
        A tolerance that is not positive.
    """

    rtol: float = 1e-10
    atol: float | None = None

    def __post_init__(self) -> None:
        check_tolerances(self.name, self.rtol, self.atol)

    @property
    def controls_error(self) -> bool:
        return True

    @property
    def gradient_error(self) -> float:
        return self.rtol

    @property
    def _options(self) -> dict:
        """Options of SUNDIALS."""
        return {
            "reltol": self.rtol,
            "abstol": ATOL_SHARE if self.atol is None else self.atol,
            "max_num_steps": MAX_STEPS,
            "disable_internal_warnings": True,
        }

    def sizes(self, problem: Problem, count: int) -> ca.DM:
        """Scales of the states, since SUNDIALS has a single absolute tolerance."""
        return ca.DM(natural(problem, count) if self.atol is None else np.ones(count))

    def step(self, problem: Problem) -> SundialsStep:
        plain = self._options
        finer = {"reltol": max(FINER * self.rtol, FINEST), "abstol": FINER * plain["abstol"]}
        options = {**plain, **finer, "quad_err_con": True}
        return SundialsStep(problem, self.flow(problem), self._cvodes(problem, options))

    @abstractmethod
    def flow(self, problem: Problem) -> Flow:
        """Integrator of the run."""

    @abstractmethod
    def _rate(self, problem: Problem) -> ca.Function:
        """``(t, x, p) → ẋ``."""

    def _cvodes(self, problem: Problem, options: dict) -> Flow:
        """CVODES on ``ẋ = F(t, x, p)``."""
        rate = self._rate(problem)
        x, p = ca.SX.sym("x", rate.numel_in(1)), ca.SX.sym("p", rate.numel_in(2))
        t, h, number = ca.SX.sym("t"), ca.SX.sym("h"), ca.SX.sym("number")
        sizes = self.sizes(problem, x.numel())
        equations = {
            "t": number,
            "x": x,
            "p": ca.vertcat(t, h, p),
            "ode": h * rate(t + h * number, sizes * x, p) / sizes,
        }
        return lambda count: _flow("cvodes", equations, sizes, count, options)


@dataclass(frozen=True)
class CVODES(SundialsIntegrator):
    """Backward differentiation of ``ẋ = F(t, x, p)`` by CVODES, orders 1 to 5.

    The ``step`` of the run is the spacing of stored states; CVODES chooses its own steps.
    Gradients are accurate to about the tolerances; for exact gradients see ``BDF``.

    Raises
    ------
    UnsupportedError
        A tolerance that is not positive, or a formulation without accelerations.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("drag")
    >>> boat = system.add(planar.Particle("boat", mass=1.0, velocity=(1, 0)))
    >>> water = system.add(planar.Force("water", boat.center, (-boat.vx, 0)))
    >>> model = system.build()
    >>> motion = da.solve_dynamics(model, 2.0, step=0.5, integrator=da.CVODES(rtol=1e-9))
    >>> round(motion["boat.vx"][-1].item(), 6)  # exp(-2)
    0.135335
    """

    def check(self, problem: Problem) -> None:
        if problem.rate is None:
            raise UnsupportedError(
                "CVODES integrates accelerations, which this formulation does not provide; use "
                "integrator=Radau() or BDF(), or formulation=RangeSpace()"
            )

    def flow(self, problem: Problem) -> Flow:
        return self._cvodes(problem, self._options)

    def _rate(self, problem: Problem) -> ca.Function:
        assert problem.rate is not None
        return problem.rate.function


@dataclass(frozen=True)
class IDA(SundialsIntegrator):
    """Backward differentiation of ``ẋ = F(t, x, z, p)``, ``0 = G(t, x, z, p)`` by IDAS.

    The system has index 1: accelerations and multipliers are algebraic and left out of the error
    control. The ``step`` of the run is the spacing of stored states; IDAS chooses its own steps.
    Gradients are accurate to about the tolerances; for exact gradients see ``BDF``.

    Raises
    ------
    UnsupportedError
        A tolerance that is not positive, or a system of index 2 or 3.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("drag")
    >>> boat = system.add(planar.Particle("boat", mass=1.0, velocity=(1, 0)))
    >>> water = system.add(planar.Force("water", boat.center, (-boat.vx, 0)))
    >>> model = system.build()
    >>> index_one = dict(formulation=da.DAE(index=1), integrator=da.IDA(rtol=1e-9))
    >>> motion = da.solve_dynamics(model, 2.0, step=0.5, **index_one)
    >>> round(motion["boat.x"][-1].item(), 6)  # 1 - exp(-2)
    0.864665
    """

    @property
    def implicit(self) -> bool:
        return True

    def check(self, problem: Problem) -> None:
        if problem.system.index > 1:
            raise UnsupportedError(
                f"IDA takes systems of index 1, but this formulation has index "
                f"{problem.system.index}; use integrator=BDF() or Radau(), or "
                "formulation=DAE(index=1)"
            )

    def _rate(self, problem: Problem) -> ca.Function:
        system = problem.system
        z = system.start.function(system.t, system.x, system.p)
        rate = ca.substitute(system.rate, system.z, z)
        return ca.Function("rate", [system.t, system.x, system.p], [rate], {"cse": True})

    def flow(self, problem: Problem) -> Flow:
        system: SemiExplicit = problem.system
        t, h, number = ca.SX.sym("t"), ca.SX.sym("h"), ca.SX.sym("number")
        sizes = self.sizes(problem, system.x.numel())
        rate, algebraic = ca.substitute(
            [system.rate, system.algebraic / system.sizes.rows],
            [system.t, system.x, system.z],
            [t + h * number, sizes * system.x, system.sizes.algebraic * system.z],
        )
        equations = {
            "t": number,
            "x": system.x,
            "z": system.z,
            "p": ca.vertcat(t, h, system.p),
            "ode": h * rate / sizes,
            "alg": algebraic,
        }
        # the line search of IDACalcIC fails for consistent start values if its scale is coarse
        start = {"calc_ic": True, "first_time": FIRST_TIME}
        options = {**self._options, "suppress_algebraic": True, **start}
        begin = algebraic_start(system)
        return lambda count: _flow("idas", equations, sizes, count, options, begin)


def algebraic_start(system: SemiExplicit) -> ca.Function:
    """``(t, x, p) → z`` relative to natural sizes."""
    z = system.start.function(system.t, system.x, system.p) / system.sizes.algebraic
    return ca.Function("start", [system.t, system.x, system.p], [z])


def _flow(
    solver: str,
    equations: dict,
    sizes: ca.DM,
    count: int,
    options: dict,
    start: ca.Function | None = None,
) -> ca.Function:
    """Flow over ``count`` intervals; time counts intervals, so that their length is a parameter.

    Parameters
    ----------
    sizes : scales of the states in the equations
    start : ``(t, x, p) → z`` if there are algebraic variables
    """
    ends = list(range(1, count + 1))
    integrator = ca.integrator(solver, solver, equations, 0, ends, options)
    t, h, x = ca.MX.sym("t"), ca.MX.sym("h"), ca.MX.sym("x", integrator.numel_in("x0"))
    p = ca.MX.sym("p", integrator.numel_in("p") - 2)
    algebraic = {} if start is None else {"z0": start(t, x, p)}
    scaled = integrator(x0=x / sizes, p=ca.vertcat(t, h, p), **algebraic)["xf"]
    return ca.Function("flow", [t, h, x, p], [ca.repmat(sizes, 1, count) * scaled])
