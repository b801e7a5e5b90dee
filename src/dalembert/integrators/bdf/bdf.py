"""Backward differentiation formulas of variable order with error control."""

from __future__ import annotations

import casadi as ca

from dalembert.errors import UnsupportedError
from dalembert.integrators.base import Attempt, Problem
from dalembert.integrators.bdf.control import Accuracy
from dalembert.integrators.bdf.step import BDFStep
from dalembert.integrators.error_control import ErrorControlled, absolute, arrival
from dalembert.integrators.step import Step
from dalembert.options import options

ATOL_SHARE = 1e-12
"""Default absolute tolerance relative to natural sizes [-]."""
SOLVED = 1e-2
"""Upper limit of the Newton residual of an accepted step, relative to the tolerance [-]."""
UNSOLVED, NOT_FINITE, REPEATED = 0.25, 0.2, 0.5
"""Factors of the step length after failure of Newton's method, after a NaN error, and the upper
limit after a second rejection in a row [-]."""


@options
class BDF(ErrorControlled):
    """Backward differentiation of orders 1 to 5 with variable steps, for stiff and DAE systems.

    ``Σ_{j≤k} ∇ʲx⁺/j − κ_k γ_k ∇^{k+1}x⁺ = h F(t + h, x⁺, z, p)`` with ``0 = G(t + h, x⁺, z, p)``
    in backward differences of quasi-constant step (Shampine and Reichelt 1997), for systems of
    index 1, 2 and 3. The run starts with order 1 and a short step. Outputs between two steps are
    partial steps of the same order from the earlier one, as accurate as steps.

    Coordinates and speeds are controlled, algebraic variables follow from them. A step is accepted
    when ``max |e_i| / (atol + rtol |x_i|) ≤ 1``. With index 3, speeds across the constraints are
    an order less accurate than positions: with a projection errors are taken along the
    constraints; without, the tolerance of speeds is ``1/h`` times wider. Steps in which Newton's
    method fails are repeated with a shorter length.

    Gradients are the exact derivatives of the steps taken with their orders. Orders are chosen
    anew if the steps are repeated with other parameters.

    Parameters
    ----------
    atol : absolute tolerance [m, rad, m/s, rad/s]; by default 1e-12 of the natural sizes
    max_order : maximum order, 1 to 5; orders 1 and 2 are A-stable

    Raises
    ------
    UnsupportedError
        A tolerance or ``max_step`` that is not positive, or another order.

    Examples
    --------
    >>> import dalembert as da
    >>> from dalembert import planar
    >>> system = da.System("drag")
    >>> boat = system.add(planar.Particle("boat", mass=1.0, velocity=(1, 0)))
    >>> water = system.add(planar.Force("water", boat.center, (-boat.vx, 0)))
    >>> model = system.build()
    >>> precise = dict(formulation=da.DAE(index=1), integrator=da.BDF(rtol=1e-8))
    >>> motion = da.solve_dynamics(model, 2.0, **precise)
    >>> round(motion["boat.vx"][-1].item(), 6)  # exp(-2)
    0.135335
    """

    rtol: float = 1e-10
    max_order: int = 5

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.max_order not in range(1, 6):
            raise UnsupportedError(f"BDF(max_order={self.max_order}): must be 1, 2, 3, 4 or 5")

    @property
    def implicit(self) -> bool:
        return True

    @property
    def order(self) -> int:
        return self.max_order

    def step(self, problem: Problem) -> BDFStep:
        atol = absolute(self.atol, ATOL_SHARE, problem, problem.system.x.numel())
        return BDFStep(problem, Accuracy(self.rtol, atol, self.max_order))

    def attempt(self, problem: Problem, step: Step) -> Attempt:
        assert isinstance(step, BDFStep)
        state = ca.MX.sym("s", 3 + step.size)
        fixed = ca.MX.sym("f", 2 + step.parameter_count)
        out = _attempt(step, state, fixed)
        return Attempt(ca.Function("attempt", [state, fixed], out), (0.0,))


def _attempt(step: BDFStep, state: ca.MX, fixed: ca.MX) -> list[ca.MX]:
    """Attempted step with acceptance test and next length."""
    t, proposed, rejected, x = state[0], state[1], state[2], state[3:]
    end, longest, p = fixed[0], fixed[1], fixed[2:]
    limit, rest = ca.fmin(proposed, longest), end - t
    # two equal steps to the end, since a very short last one degrades speeds with index 3
    h = ca.if_else(rest <= limit, rest, ca.fmin(limit, rest / 2))
    new, record = step.trial(t, h, x, p)
    error, growth, residual = record[0], record[1], record[2]
    solved = residual <= SOLVED  # false for NaN as well
    finite = ca.logic_and(solved, error <= 1e30)
    accepted = ca.logic_and(finite, error <= 1)
    factor = ca.if_else(finite, growth, ca.if_else(solved, NOT_FINITE, UNSOLVED))
    repeated = ca.logic_and(ca.logic_not(accepted), rejected)
    factor = ca.if_else(repeated, ca.fmin(factor, REPEATED), factor)
    shortened = ca.logic_and(accepted, h < limit)  # by the end of the run, not by its error
    following = ca.vertcat(
        ca.if_else(accepted, arrival(t, h, end), t),
        ca.if_else(shortened, limit, h * factor),
        ca.logic_not(accepted),
        ca.if_else(accepted, new, x),
    )
    return [following, ca.vertcat(t, h, ca.if_else(finite, error, 1e30), accepted)]
