"""Steps of integrators: ``(t, h, x, p) → x⁺`` with exact derivatives."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import cached_property
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from dalembert.integrators.prepared_step import PreparedGraph, PreparedStep, step_symbols
from dalembert.symbolic.equations.graph_function import GraphFunction, tangent_of_adjoint
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.once import CacheOwner, once


class Step(CacheOwner, ABC):
    """One step of an integrator: a function, its tangent and its adjoint.

    An integrator states the function; ``prepared`` are the forms that marches evaluate, and the
    derivatives as functions of the parameters follow from them. ``x`` may be longer than the state
    of the system: multistep methods append their memory.

    Attributes
    ----------
    size, parameter_count : lengths of x and p
    state_size : length of the state of the system, the leading part of x
    corrects : ends with a correction of the state
    chunked : equal steps are taken in chunks
    """

    size: int
    parameter_count: int
    state_size: int
    corrects: bool
    chunked: ClassVar[bool] = False

    @property
    @abstractmethod
    def function(self) -> ca.Function:
        """``(t, h, x, p) → x⁺``."""

    @property
    def parts(self) -> tuple[ca.Function, ImplicitFunction | None]:
        """Uncorrected step and the correction, which provides its own derivatives."""
        return self.function, None

    @cached_property
    def prepared(self) -> PreparedStep:
        """The step and its derivatives with the terms of parameters alone split off."""
        return PreparedGraph(self.function, *self.parts, self.state_size)

    @once
    def tangents(self, count: int) -> ca.Function:
        """``(t, h, x, p, dx, dp) → dx⁺`` for ``count`` directions at once, in columns."""
        t, h, x, p = self._symbols()
        dx = ca.MX.sym("dx", self.size, count)
        dp = ca.MX.sym("dp", self.parameter_count, count)
        prelude = self.prepared.prelude
        rates = prelude.tangent.map(count)(ca.repmat(p, 1, count), dp)
        change = self.prepared.tangents(count)(t, h, x, prelude.values(p), dx, rates)
        return ca.Function("step_tangent", [t, h, x, p, dx, dp], [change])

    @cached_property
    def adjoint(self) -> ca.Function:
        """``(t, h, x, p, x̄⁺) → (x̄, p̄)``."""
        t, h, x, p = self._symbols()
        weight, prelude = ca.MX.sym("w", self.size), self.prepared.prelude
        x_bar, q_bar = self.prepared.adjoint(t, h, x, prelude.values(p), weight)
        out = [x_bar, prelude.adjoint(p, q_bar)]
        return ca.Function("step_adjoint", [t, h, x, p, weight], out)

    @cached_property
    def second(self) -> ca.Function:
        """``(t, h, x, p, x̄⁺, ẋ, ṗ, d x̄⁺) → (x̄, d x̄, d p̄)``, the tangent of the adjoint."""
        return tangent_of_adjoint(self.adjoint)

    @cached_property
    def by_times(self) -> ca.Function:
        """``(t, h, x, p) → ∂x⁺/∂t, ∂x⁺/∂h``."""
        function = self.exact_in_h.function
        t, h, x, p = self._symbols()
        zeros = ca.MX(x.numel(), 2), ca.MX(p.numel(), 2)
        along = ca.DM([[1, 0]]), ca.DM([[0, 1]])
        both = function.forward(2)(t, h, x, p, function(t, h, x, p), *along, *zeros)
        rates = [ca.densify(both[:, 0]), ca.densify(both[:, 1])]
        return ca.Function("by_times", [t, h, x, p], rates)

    def _symbols(self, kind: Any = ca.MX) -> list[Any]:
        return step_symbols(self.size, self.parameter_count, kind)

    @property
    def plain(self) -> Step:
        """The same step without its correction."""
        raise NotImplementedError

    @property
    def exact_in_h(self) -> Step:
        """Step whose ``function`` has the correct derivative by ``h`` at every ``h``."""
        return self

    @property
    def begin(self) -> GraphFunction | None:
        """``(t, x, p) → memory`` at the start, None for one-step methods."""
        return None

    def explain(self, reason: str) -> str:
        """Explanation of a failed inner solver and a remedy; empty if ``reason`` is not known."""
        return ""

    @property
    def work(self) -> float:
        """Approximate number of operations of a step."""
        return float(self.function.n_instructions())

    def chunk(self, count: int) -> StepChunk:
        """``count`` equal steps as one call, if ``chunked``."""
        raise NotImplementedError

    @property
    def residual(self) -> ca.Function | None:
        """``(t, h, x, p)`` → relative residual of the equations solved in the step, if any."""
        return None

    @property
    def rate(self) -> ImplicitFunction | None:
        """``(t, x, p) → ẋ``, the right-hand side of an explicit step; else None."""
        return None

    @property
    def stability(self) -> Callable[[np.ndarray], np.ndarray] | None:
        """Stability function ``R(hλ)`` of a step that can amplify decaying modes; else None."""
        return None


class StepChunk(ABC):
    """Several equal steps in one call: a function, its tangent and its adjoint."""

    @property
    @abstractmethod
    def function(self) -> ca.Function:
        """``(x, t, h, flag, p) → states`` after each step."""

    @abstractmethod
    def tangents(self, columns: int) -> ca.Function:
        """``(dx, t, h, flag, x, p, dp) → changes`` of these states, grouped by state."""

    @property
    @abstractmethod
    def adjoint(self) -> ca.Function:
        """``([x̄; p̄], t, h, flag, x, injected weights, p) → [x̄; p̄]``, the last step first."""


class GraphStep(Step):
    """Step as a CasADi function, followed by a correction of the state.

    Parameters
    ----------
    function : ``(t, h, x, p) → x⁺`` without correction
    correction : ImplicitFunction ``(t, x, p) → x`` of the leading ``state_size`` entries, or None
    begin : ``(t, x, p) → memory``, or None
    residual : ``(t, h, x, p)`` → relative residual of the equations solved, or None
    upkeep : replaces ``correction`` in steps without it (normalisation), or None
    """

    def __init__(
        self,
        function: ca.Function,
        state_size: int,
        correction: ImplicitFunction | None = None,
        begin: GraphFunction | None = None,
        residual: ca.Function | None = None,
        upkeep: ImplicitFunction | None = None,
    ):
        self._bare, self._begin, self._residual, self._upkeep = function, begin, residual, upkeep
        self._finish = upkeep if correction is None else correction
        self.size, self.parameter_count = function.numel_in(2), function.numel_in(3)
        self.state_size = state_size
        self.corrects = correction is not None

    @property
    def begin(self) -> GraphFunction | None:
        return self._begin

    @property
    def residual(self) -> ca.Function | None:
        return self._residual

    @cached_property
    def plain(self) -> GraphStep:
        return GraphStep(
            self._bare, self.state_size, None, self._begin, self._residual, self._upkeep
        )

    @property
    def parts(self) -> tuple[ca.Function, ImplicitFunction | None]:
        return self._bare, self._finish

    @cached_property
    def function(self) -> ca.Function:
        t, h, x, p = self._symbols()
        new = self.corrected(t + h, self._bare(t, h, x, p), p)
        return ca.Function("step", [t, h, x, p], [ca.densify(new)])

    def corrected(self, t: ca.MX, x: ca.MX, p: ca.MX) -> ca.MX:
        """The state after the correction."""
        if self._finish is None:
            return x
        state = self._finish.function(t, x[: self.state_size], p)
        return ca.vertcat(state, x[self.state_size :])
