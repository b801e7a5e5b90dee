"""One step of an integrator: ``(t, h, x, p) → x⁺`` with its exact derivatives."""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.symbolic.implicit import ImplicitFunction


class Step:
    """What marching and gradients need of a step.

    ``x`` may be longer than the state of the system: methods with memory append it.

    Attributes
    ----------
    size, parameter_count : lengths of x and p
    state_size : length of the state of the system, the leading part of x
    corrects : ends with a correction of the state
    """

    size: int
    parameter_count: int
    state_size: int
    corrects: bool

    @property
    def function(self) -> ca.Function:
        """``(t, h, x, p) → x⁺``."""
        raise NotImplementedError

    @property
    def tangent(self) -> ca.Function:
        """``(t, h, x, p, dx, dp) → dx⁺``."""
        raise NotImplementedError

    @property
    def adjoint(self) -> ca.Function:
        """``(t, h, x, p, x̄⁺) → (x̄, p̄)``."""
        raise NotImplementedError

    @property
    def plain(self) -> Step:
        """The same step without its correction."""
        raise NotImplementedError

    @property
    def begin(self) -> ca.Function | None:
        """``(t, x, p) → memory`` at the start, None for methods without."""
        return None

    @property
    def residual(self) -> ca.Function | None:
        """``(t, h, x, p)`` → relative residual of the equations solved in the step, if any."""
        return None


class DifferentiatedStep(Step):
    """A step whose ``function`` CasADi differentiates.

    Solved equations inside (rootfinder nodes) are differentiated by the implicit function
    theorem, so derivatives are exact as far as the equations are solved.
    """

    def _symbols(self) -> list[ca.MX]:
        return [
            ca.MX.sym("t"),
            ca.MX.sym("h"),
            ca.MX.sym("x", self.size),
            ca.MX.sym("p", self.parameter_count),
        ]

    @cached_property
    def tangent(self) -> ca.Function:
        t, h, x, p = self._symbols()
        dx, dp = ca.MX.sym("dx", self.size), ca.MX.sym("dp", self.parameter_count)
        new = self.function(t, h, x, p)
        change = self.function.forward(1)(t, h, x, p, new, 0, 0, dx, dp)
        return ca.Function("step_tangent", [t, h, x, p, dx, dp], [ca.densify(change)])

    @cached_property
    def adjoint(self) -> ca.Function:
        t, h, x, p = self._symbols()
        weight = ca.MX.sym("w", self.size)
        new = self.function(t, h, x, p)
        _, _, x_bar, p_bar = self.function.reverse(1)(t, h, x, p, new, weight)
        out = [ca.densify(x_bar), ca.densify(p_bar)]
        return ca.Function("step_adjoint", [t, h, x, p, weight], out)


class GraphStep(DifferentiatedStep):
    """A step given as a function of the graph, and what is done to the state after it.

    Parameters
    ----------
    function : ``(t, h, x, p) → x⁺`` without correction
    correction : ``(t, x, p) → x`` of the leading ``state_size`` entries, or None
    begin : ``(t, x, p) → memory``, or None
    residual : ``(t, h, x, p)`` → relative residual of the equations solved, or None
    upkeep : like ``correction``, for steps without it, or None
    """

    def __init__(
        self,
        function: ca.Function,
        state_size: int,
        correction: ca.Function | None = None,
        begin: ca.Function | None = None,
        residual: ca.Function | None = None,
        upkeep: ca.Function | None = None,
    ):
        self._bare, self._begin, self._residual, self._upkeep = function, begin, residual, upkeep
        self._finish = upkeep if correction is None else correction
        self.size, self.parameter_count = function.numel_in(2), function.numel_in(3)
        self.state_size = state_size
        self.corrects = correction is not None

    @property
    def begin(self) -> ca.Function | None:
        return self._begin

    @property
    def residual(self) -> ca.Function | None:
        return self._residual

    @property
    def plain(self) -> GraphStep:
        return GraphStep(
            self._bare, self.state_size, None, self._begin, self._residual, self._upkeep
        )

    @cached_property
    def function(self) -> ca.Function:
        t, h, x, p = self._symbols()
        new = self.finished(t + h, self._bare(t, h, x, p), p)
        return ca.Function("step", [t, h, x, p], [ca.densify(new)])

    def finished(self, t: ca.MX, x: ca.MX, p: ca.MX) -> ca.MX:
        """The state, with what is done to it after every step."""
        if self._finish is None:
            return x
        return ca.vertcat(self._finish(t, x[: self.state_size], p), x[self.state_size :])


def graph_of(correction: ImplicitFunction | None) -> ca.Function | None:
    """The function of a correction, if there is one."""
    return None if correction is None else correction.function
