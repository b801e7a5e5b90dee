"""Implicit Runge–Kutta integrators: backward Euler, trapezoidal rule, Radau IIA."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt

import casadi as ca
import numpy as np

from dalembert.integrators.base import Attempt, ImplicitIntegrator, Problem
from dalembert.integrators.error_control import (
    ErrorControlled,
    absolute,
    decide,
    impulsive,
    largest,
    relative_error,
    share,
)
from dalembert.integrators.runge_kutta.implicit_step import (
    ButcherMatrix,
    CollocationStep,
    stages,
)
from dalembert.integrators.step import Step
from dalembert.options import options

BACKWARD_EULER = ButcherMatrix(((1.0,),), order=1)
TRAPEZOIDAL = ButcherMatrix(((0.0, 0.0), (0.5, 0.5)), order=2)


@dataclass(frozen=True, kw_only=True)
class ImplicitRungeKutta(ImplicitIntegrator, ABC):
    """Implicit method defined by its Butcher matrix: ``x⁺ = X_s`` of the stage equations."""

    @property
    @abstractmethod
    def matrix(self) -> ButcherMatrix:
        """Coefficients of the method."""

    @property
    def convergence_order(self) -> int:
        return self.matrix.order

    @property
    def stability(self) -> Callable[[np.ndarray], np.ndarray]:
        return self.matrix.stability

    def step(self, problem: Problem) -> CollocationStep:
        return CollocationStep(self.matrix, problem, self)


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
    >>> implicit = dict(formulation=da.DAE(index=1), integrator=da.BackwardEuler())
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
    >>> implicit = dict(formulation=da.DAE(index=1), integrator=da.Trapezoidal())
    >>> motion = da.solve_dynamics(model, 0.5, step=0.5, **implicit)
    >>> round(motion["boat.vx"][-1].item(), 9)  # (1 - h/2)/(1 + h/2)
    0.6
    """

    @property
    def matrix(self) -> ButcherMatrix:
        return TRAPEZOIDAL


_R = sqrt(6)
RADAU_IIA = ButcherMatrix(
    (
        ((88 - 7 * _R) / 360, (296 - 169 * _R) / 1800, (-2 + 3 * _R) / 225),
        ((296 + 169 * _R) / 1800, (88 + 7 * _R) / 360, (-2 - 3 * _R) / 225),
        ((16 - _R) / 36, (16 + _R) / 36, 1 / 9),
    ),
    order=5,
)
"""Hairer and Wanner (1996), IV.5."""
FILTER = (6 - 9 ** (1 / 3) + 81 ** (1 / 3)) / 30
"""``γ₀``: real eigenvalue of the Butcher matrix."""
ESTIMATE = FILTER / 3 * np.array([-13 - 7 * _R, -13 + 7 * _R, -1]) @ np.array(RADAU_IIA.a)
"""Weights of the stage rates in the error estimate; the rate at the old state has ``γ₀``."""
ERROR_ORDER = 3


@options
class Radau(ErrorControlled, ImplicitRungeKutta):
    """Radau IIA, three stages, order 5: for stiff systems and for every index.

    Positions and speeds have order 5 with ``DAE(index=1)``, ``DAE(index=2)`` and its stabilised
    form; with index 3 positions have order 5 and speeds order 3, unless a ``Projection`` follows.
    Without it errors of speeds count h times there, as their part off the constraints remains.
    A step is accepted when ``max |e_i| / (atol + rtol |x_i|) ≤ 1`` over coordinates and speeds,
    with ``e = (I − hγ₀J)⁻¹ h (γ₀ F₀ + Σ w_i F_i)`` (Hairer and Wanner 1996, IV.8).

    Parameters
    ----------
    fixed : take steps of the given length without error control

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("hard buffer")
    >>> mass = system.add(planar.Particle("mass", mass=1.0, velocity=(1, 0)))
    >>> stiff = planar.Force("buffer", mass.center, (-1e6 * mass.x - 1e6 * mass.vx, 0))
    >>> force = system.add(stiff)
    >>> motion = da.solve_dynamics(system.build(), 1.0, integrator=da.Radau(rtol=1e-6))
    >>> int(motion.statistics["steps"]) < 200  # its fastest time is a microsecond
    True
    """

    fixed: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        ImplicitRungeKutta.__post_init__(self)

    @property
    def matrix(self) -> ButcherMatrix:
        return RADAU_IIA

    @property
    def adaptive(self) -> bool:
        return not self.fixed

    @property
    def order(self) -> int:
        return self.matrix.order

    def attempt(self, problem: Problem, step: Step) -> Attempt | None:
        if self.fixed:
            return None
        assert isinstance(step, CollocationStep)
        state = ca.MX.sym("s", 3 + step.size)
        fixed = ca.MX.sym("f", 2 + step.parameter_count)
        t, proposed, x = state[0], state[1], state[3:]
        end, longest, p = fixed[0], fixed[1], fixed[2:]
        h = ca.fmin(ca.fmin(proposed, longest), end - t)
        new, rates, _ = step.solve(t, h, x, p)
        corrected = step.corrected(t + h, new, p)
        error = _estimate(step, t, h, x, p, rates)
        atol = ca.DM(absolute(self.atol, share(self.rtol), problem, step.size))
        allowed = atol + self.rtol * ca.fmax(ca.fabs(x), ca.fabs(corrected))
        if problem.tangential is None and problem.system.index == 3:
            allowed = impulsive(problem, h, allowed)
        ratio = largest(relative_error(problem, t + h, new, p, error, allowed))
        ratio = ca.if_else(ca.sumsqr(corrected) < np.inf, ratio, np.inf)
        following, record = decide(state, end, h, corrected, ratio, ERROR_ORDER)
        function = ca.Function("attempt", [state, fixed], [following, record])
        return Attempt(function, (1.0,), work=step.work)


def _estimate(step: CollocationStep, t, h, x, p, rates: ca.MX) -> ca.MX:
    """Error of the new state, filtered of stiff components and of those off the constraints."""
    u, begin = step.begin_rates(t, h, x, p)
    raw = h * (FILTER * begin + ca.mtimes(rates, ca.DM(ESTIMATE)))
    matrix, rhs, change = _linearise(step)
    base = x - h * FILTER * begin
    solution = ca.solve(matrix(t, h, base, u, p), rhs(t, h, base, u, p, raw), "qr")
    return change(t, h, base, u, p, raw, solution)


def _linearise(step: CollocationStep) -> tuple[ca.Function, ca.Function, ca.Function]:
    """Linearisation of one implicit stage of length γ₀h by a disturbance of the old state."""
    e, s = step.equations, step.equations.system
    at = (s.t, ca.SX.sym("h"), s.x, ca.SX.sym("u", e.count), s.p)
    (state,), _, (rows,) = stages(e, ((FILTER,),), (0.0,), at, None)
    h, u = at[1], at[3]
    rows = rows / ca.vertcat(*(h**k for k in s.depth), *(1 for _ in e.coupled))
    disturbance, solution = ca.SX.sym("d", e.size), ca.SX.sym("w", e.count)
    sizes = e.unknown_sizes
    rows = rows / (e.row_sizes / s.sizes.time ** np.array([*s.depth, *(0 for _ in e.coupled)]))
    slopes = ca.mtimes(ca.jacobian(rows, u), ca.diag(ca.DM(sizes)))
    matrix = ca.Function("matrix", list(at), [slopes], {"cse": True})
    change = -ca.densify(ca.jtimes(rows, s.x, disturbance))
    rhs = ca.Function("rhs", [*at, disturbance], [change], {"cse": True})
    total = ca.jtimes(state, s.x, disturbance) + ca.jtimes(state, u, sizes * solution)
    inputs = [*at, disturbance, solution]
    return matrix, rhs, ca.Function("change", inputs, [ca.densify(total)], {"cse": True})
