"""Steps of integrators: ``(t, h, x, p) → x⁺`` with exact derivatives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np

from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.equations.linear_map import TriangularMap
from dalembert.symbolic.evaluation.columns import LONG, instructions
from dalembert.symbolic.evaluation.lane_tangents import LinearStep
from dalembert.symbolic.evaluation.prelude import Prelude, before
from dalembert.symbolic.once import CacheOwner

WIDTH = 16
"""Maximum number of directions differentiated at once, which limits the size of the graph."""


@dataclass(frozen=True)
class Marching:
    """Functions of a step for marching.

    Attributes
    ----------
    values : ``p → q``, evaluated once for many steps
    function : ``(t, h, x, q) → x⁺``
    called : equivalent function, fastest when compiled, if there is such a form: repeated parts
        are functions that are compiled once
    lanes : equivalent function for SIMD lanes, without branches: NaN in lanes that would branch
    """

    values: ca.Function
    function: ca.Function
    called: ca.Function | None = None
    lanes: ca.Function | None = None

    @property
    def side_by_side(self) -> ca.Function:
        """Function of the step that is fastest in SIMD lanes."""
        if self.lanes is not None or self.called is None:
            return self.lanes or self.function
        return self.called if instructions(self.function) > LONG else self.function


class Step(CacheOwner):
    """One step of an integrator, as marches and gradients use it.

    ``x`` may be longer than the state of the system: multistep methods append their memory.

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

    @cached_property
    def marching(self) -> Marching:
        """Functions of the step, with the terms that depend on parameters alone split off."""
        return Marching(*before(self.function, 3))

    @cached_property
    def prelude(self) -> Prelude:
        """Terms of the derivatives that depend on parameters alone, ``q`` and ``q̇``."""
        return Prelude.identity(self.parameter_count)

    def prepared_tangents(self, count: int) -> ca.Function:
        """``(t, h, x, q, dx, dq) → dx⁺`` for ``count`` directions at once, in columns.

        Used by direct gradients.
        """
        raise NotImplementedError

    @property
    def linear(self) -> LinearStep | None:
        """``prepared_tangents`` in two parts for SIMD lanes; None if not available."""
        return None

    @property
    def prepared_adjoint(self) -> ca.Function:
        """``(t, h, x, q, x̄⁺) → (x̄, q̄)``, used by adjoint gradients."""
        raise NotImplementedError

    @property
    def compiled_adjoint(self) -> ca.Function:
        """``prepared_adjoint`` in the form that is fastest when compiled."""
        return self.prepared_adjoint

    def tangents(self, count: int) -> ca.Function:
        """``(t, h, x, p, dx, dp) → dx⁺`` for ``count`` directions at once, in columns.

        Used for partial steps and for marches that correct only some steps.
        """
        t, h, x, p = self._symbols()
        dx = ca.MX.sym("dx", self.size, count)
        dp = ca.MX.sym("dp", self.parameter_count, count)
        rates = self.prelude.tangent.map(count)(ca.repmat(p, 1, count), dp)
        change = self.prepared_tangents(count)(t, h, x, self.prelude.values(p), dx, rates)
        return ca.Function("step_tangent", [t, h, x, p, dx, dp], [change])

    @cached_property
    def tangent(self) -> ca.Function:
        """``(t, h, x, p, dx, dp) → dx⁺``, used by second derivatives."""
        return self.tangents(1)

    @cached_property
    def adjoint(self) -> ca.Function:
        """``(t, h, x, p, x̄⁺) → (x̄, p̄)``, used like ``tangents`` and by second derivatives."""
        t, h, x, p = self._symbols()
        weight = ca.MX.sym("w", self.size)
        x_bar, q_bar = self.prepared_adjoint(t, h, x, self.prelude.values(p), weight)
        out = [x_bar, self.prelude.adjoint(p, q_bar)]
        return ca.Function("step_adjoint", [t, h, x, p, weight], out)

    def _symbols(self, kind: Any = ca.MX) -> list[Any]:
        sizes = {"t": 1, "h": 1, "x": self.size, "p": self.parameter_count}
        return [kind.sym(name, size) for name, size in sizes.items()]

    @property
    def plain(self) -> Step:
        """The same step without its correction."""
        raise NotImplementedError

    @property
    def exact_in_h(self) -> Step:
        """Step whose ``function`` has the correct derivative by ``h`` at every ``h``."""
        return self

    @property
    def begin(self) -> ca.Function | None:
        """``(t, x, p) → memory`` at the start, None for one-step methods."""
        return None

    def explain(self, reason: str) -> str:
        """Explanation of a failed inner solver and a remedy; empty if ``reason`` is not known."""
        return ""

    @property
    def work(self) -> float:
        """Approximate number of operations of a step."""
        return float(self.function.n_instructions())

    @property
    def chunked(self) -> bool:
        """True if equal steps are taken in chunks, by the functions below."""
        return False

    def chunk(self, count: int) -> ca.Function:
        """``(x, t, h, flag, p) → states`` after each of ``count`` equal steps."""
        raise NotImplementedError

    def chunk_adjoint(self, count: int) -> ca.Function:
        """``(x, t, h, flag, p, weights of the states) → (x̄, p̄)``."""
        raise NotImplementedError

    def chunk_tangents(self, count: int, columns: int) -> ca.Function:
        """``(x, t, h, flag, p, dx, dp) → changes of the states``, grouped by state."""
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


class DifferentiatedStep(Step):
    """Step whose ``function`` is differentiated by CasADi.

    Solved equations inside (rootfinder nodes) are differentiated by the implicit function
    theorem, so derivatives are exact as far as the equations are solved.
    """

    @property
    def parts(self) -> tuple[ca.Function, ImplicitFunction | None]:
        """Uncorrected step and the correction, which provides its own derivatives."""
        return self.function, None

    def _trace(self) -> tuple[list[ca.MX], ca.MX, ca.MX, TriangularMap | None]:
        """Symbols ``t, h`` and ``[x; p]``, the uncorrected state, tangent of the correction."""
        function, correction = self.parts
        t, h = ca.MX.sym("t"), ca.MX.sym("h")
        both = ca.MX.sym("xp", self.size + self.parameter_count)
        x, p = both[: self.size], both[self.size :]
        (new,) = function.call([t, h, x, p], True, False)
        if correction is None:
            return [t, h], both, new, None
        return [t, h], both, new, correction.at(t + h, new[: self.state_size], p)

    def prepared_tangents(self, count: int) -> ca.Function:
        times, both, new, correction = self._trace()
        dx = ca.MX.sym("dx", self.size, count)
        dp = ca.MX.sym("dp", self.parameter_count, count)
        cuts, along = [*range(0, count, WIDTH), count], ca.vertcat(dx, dp)
        columns = [ca.jtimes(new, both, along[:, begin:end]) for begin, end in pairwise(cuts)]
        change = ca.densify(ca.horzcat(*columns))
        if correction is not None:
            n = self.state_size
            change = ca.vertcat(correction.tangent([change[:n, :], dp]), change[n:, :])
        inner = ca.Function("tangents", [*times, both, dx, dp], [change])
        return self._split("step_tangent", inner, [dx, dp])

    @cached_property
    def prepared_adjoint(self) -> ca.Function:
        times, both, new, correction = self._trace()
        weight, n = ca.MX.sym("w", self.size), self.state_size
        if correction is None:
            weights = ca.jtimes(new, both, weight, True)
        else:
            back = correction.adjoint(weight[:n])
            weights = ca.jtimes(new, both, ca.vertcat(back[:n], weight[n:]), True)
            weights += ca.vertcat(ca.MX(self.size, 1), back[n:])
        weights = ca.densify(weights)
        out = [weights[: self.size], weights[self.size :]]
        inner = ca.Function("adjoint", [*times, both, weight], out)
        return self._split("step_adjoint", inner, [weight])

    def _split(self, name: str, inner: ca.Function, more: list[ca.MX]) -> ca.Function:
        """The function of separate x and p."""
        t, h, x, p = self._symbols()
        return ca.Function(name, [t, h, x, p, *more], inner.call([t, h, ca.vertcat(x, p), *more]))


class GraphStep(DifferentiatedStep):
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
        begin: ca.Function | None = None,
        residual: ca.Function | None = None,
        upkeep: ImplicitFunction | None = None,
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


def graph_of(correction: ImplicitFunction | None) -> ca.Function | None:
    """Function of a correction, None without one."""
    return None if correction is None else correction.function
