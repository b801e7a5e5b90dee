"""One step of an integrator: ``(t, h, x, p) → x⁺`` with its exact derivatives."""

from __future__ import annotations

from functools import cached_property

import casadi as ca


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


class GraphStep(Step):
    """A step given as a function of the graph; CasADi differentiates it.

    Solved equations inside (rootfinder nodes) are differentiated by the implicit function
    theorem, so derivatives are exact as far as the equations are solved.

    Parameters
    ----------
    function : ``(t, h, x, p) → x⁺`` without correction
    correction : ``(t, x, p) → x`` of the leading ``state_size`` entries, or None
    begin : ``(t, x, p) → memory``, or None
    """

    def __init__(
        self,
        function: ca.Function,
        state_size: int,
        correction: ca.Function | None = None,
        begin: ca.Function | None = None,
    ):
        self._bare, self._correction, self._begin = function, correction, begin
        self.size, self.parameter_count = function.numel_in(2), function.numel_in(3)
        self.state_size = state_size
        self.corrects = correction is not None

    @property
    def begin(self) -> ca.Function | None:
        return self._begin

    @property
    def plain(self) -> GraphStep:
        return GraphStep(self._bare, self.state_size, None, self._begin)

    def _symbols(self) -> list[ca.MX]:
        return [
            ca.MX.sym("t"),
            ca.MX.sym("h"),
            ca.MX.sym("x", self.size),
            ca.MX.sym("p", self.parameter_count),
        ]

    @cached_property
    def function(self) -> ca.Function:
        t, h, x, p = self._symbols()
        new = self._bare(t, h, x, p)
        if self._correction is not None:
            state = self._correction(t + h, new[: self.state_size], p)
            new = ca.vertcat(state, new[self.state_size :])
        return ca.Function("step", [t, h, x, p], [ca.densify(new)])

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
