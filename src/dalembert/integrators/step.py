"""One step of an integrator: ``(t, h, x, p) → x⁺`` with its exact derivatives."""

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

WIDTH = 16
"""Directions in which a step is differentiated at once, for the graph grows with them."""


@dataclass(frozen=True)
class Marching:
    """A step as marches take it.

    Attributes
    ----------
    values : ``p → q``, done once for many steps
    function : ``(t, h, x, q) → x⁺``
    called : the same in the form that is fastest compiled, if there is another: parts that occur
        several times are functions, compiled once
    lanes : the same where all lanes go one way, NaN for those that need another
    """

    values: ca.Function
    function: ca.Function
    called: ca.Function | None = None
    lanes: ca.Function | None = None

    @property
    def side_by_side(self) -> ca.Function:
        """The step in the form that is fastest in lanes."""
        if self.lanes is not None or self.called is None:
            return self.lanes or self.function
        return self.called if instructions(self.function) > LONG else self.function


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

    @cached_property
    def marching(self) -> Marching:
        """The step after what depends on the parameters alone."""
        return Marching(*before(self.function, 3))

    @cached_property
    def prelude(self) -> Prelude:
        """What the derivatives need of the parameters alone, ``q`` and ``q̇``: once for a march."""
        return Prelude.identity(self.parameter_count)

    def prepared_tangents(self, count: int) -> ca.Function:
        """``(t, h, x, q, dx, dq) → dx⁺`` for ``count`` directions at once, in columns.

        Direct gradients march with it.
        """
        raise NotImplementedError

    @property
    def linear(self) -> LinearStep | None:
        """The same in two parts, for several directions side by side, if it comes in two parts."""
        return None

    @property
    def prepared_adjoint(self) -> ca.Function:
        """``(t, h, x, q, x̄⁺) → (x̄, q̄)``: adjoint gradients march with it."""
        raise NotImplementedError

    @property
    def compiled_adjoint(self) -> ca.Function:
        """The same in the form that is fastest as C; marches of a backend that compiles take it."""
        return self.prepared_adjoint

    def tangents(self, count: int) -> ca.Function:
        """``(t, h, x, p, dx, dp) → dx⁺`` for ``count`` directions at once, in columns.

        For parts of steps, and marches in which only some steps are corrected.
        """
        t, h, x, p = self._symbols()
        dx = ca.MX.sym("dx", self.size, count)
        dp = ca.MX.sym("dp", self.parameter_count, count)
        rates = self.prelude.tangent.map(count)(ca.repmat(p, 1, count), dp)
        found = self.prepared_tangents(count)(t, h, x, self.prelude.values(p), dx, rates)
        return ca.Function("step_tangent", [t, h, x, p, dx, dp], [found])

    @cached_property
    def tangent(self) -> ca.Function:
        """``(t, h, x, p, dx, dp) → dx⁺``: second derivatives march with it."""
        return self.tangents(1)

    @cached_property
    def adjoint(self) -> ca.Function:
        """``(t, h, x, p, x̄⁺) → (x̄, p̄)``, where ``tangents`` is, and for second derivatives."""
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
    def moving(self) -> Step:
        """The same step, with the derivative of ``function`` by ``h`` right for every ``h``."""
        return self

    @property
    def begin(self) -> ca.Function | None:
        """``(t, x, p) → memory`` at the start, None for methods without."""
        return None

    def explained(self, reason: str) -> str:
        """Why a solver inside gave up and what to do about it, where its word for it is clear."""
        return ""

    @property
    def work(self) -> float:
        """Operations of a step, about."""
        return float(self.function.n_instructions())

    @property
    def even(self) -> bool:
        """Takes chunks of equal steps at once, by the functions below."""
        return False

    def chunk(self, count: int) -> ca.Function:
        """``(x, t, h, flag, p) → states`` after each of ``count`` equal steps."""
        raise NotImplementedError

    def chunk_adjoint(self, count: int) -> ca.Function:
        """``(x, t, h, flag, p, weights of the states) → (x̄, p̄)``."""
        raise NotImplementedError

    def chunk_tangents(self, count: int, columns: int) -> ca.Function:
        """``(x, t, h, flag, p, dx, dp) → changes of the states``, all columns of each in turn."""
        raise NotImplementedError

    @property
    def residual(self) -> ca.Function | None:
        """``(t, h, x, p)`` → relative residual of the equations solved in the step, if any."""
        return None

    @property
    def rate(self) -> ImplicitFunction | None:
        """``(t, x, p) → ẋ``, the right-hand side of an explicit step; None for other steps."""
        return None

    @property
    def stability(self) -> Callable[[np.ndarray], np.ndarray] | None:
        """Stability function ``R(hλ)`` of a step that can amplify decaying modes; else None."""
        return None


class DifferentiatedStep(Step):
    """A step whose ``function`` CasADi differentiates.

    Solved equations inside (rootfinder nodes) are differentiated by the implicit function
    theorem, so derivatives are exact as far as the equations are solved.
    """

    @property
    def parts(self) -> tuple[ca.Function, ImplicitFunction | None]:
        """The step without what follows it, and that: it differentiates itself."""
        return self.function, None

    def _traced(self) -> tuple[list[ca.MX], ca.MX, ca.MX, TriangularMap | None]:
        """Symbols ``t, h`` and ``[x; p]``, the state before what follows, the tangent of that."""
        function, following = self.parts
        t, h = ca.MX.sym("t"), ca.MX.sym("h")
        both = ca.MX.sym("xp", self.size + self.parameter_count)
        x, p = both[: self.size], both[self.size :]
        (new,) = function.call([t, h, x, p], True, False)
        if following is None:
            return [t, h], both, new, None
        return [t, h], both, new, following.at(t + h, new[: self.state_size], p)

    def prepared_tangents(self, count: int) -> ca.Function:
        times, both, new, following = self._traced()
        dx = ca.MX.sym("dx", self.size, count)
        dp = ca.MX.sym("dp", self.parameter_count, count)
        cuts, along = [*range(0, count, WIDTH), count], ca.vertcat(dx, dp)
        few = [ca.jtimes(new, both, along[:, begin:end]) for begin, end in pairwise(cuts)]
        change = ca.densify(ca.horzcat(*few))
        if following is not None:
            n = self.state_size
            change = ca.vertcat(following.tangent([change[:n, :], dp]), change[n:, :])
        inner = ca.Function("tangents", [*times, both, dx, dp], [change])
        return self._split("step_tangent", inner, [dx, dp])

    @cached_property
    def prepared_adjoint(self) -> ca.Function:
        times, both, new, following = self._traced()
        weight, n = ca.MX.sym("w", self.size), self.state_size
        if following is None:
            found = ca.jtimes(new, both, weight, True)
        else:
            back = following.adjoint(weight[:n])
            found = ca.jtimes(new, both, ca.vertcat(back[:n], weight[n:]), True)
            found += ca.vertcat(ca.MX(self.size, 1), back[n:])
        found = ca.densify(found)
        out = [found[: self.size], found[self.size :]]
        inner = ca.Function("adjoint", [*times, both, weight], out)
        return self._split("step_adjoint", inner, [weight])

    def _split(self, name: str, inner: ca.Function, more: list[ca.MX]) -> ca.Function:
        """The same function of x and p apart."""
        t, h, x, p = self._symbols()
        return ca.Function(name, [t, h, x, p, *more], inner.call([t, h, ca.vertcat(x, p), *more]))


class GraphStep(DifferentiatedStep):
    """A step given as a function of the graph, and what is done to the state after it.

    Parameters
    ----------
    function : ``(t, h, x, p) → x⁺`` without correction
    correction : ImplicitFunction ``(t, x, p) → x`` of the leading ``state_size`` entries, or None
    begin : ``(t, x, p) → memory``, or None
    residual : ``(t, h, x, p)`` → relative residual of the equations solved, or None
    upkeep : like ``correction``, for steps without it, or None
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
        new = self.finished(t + h, self._bare(t, h, x, p), p)
        return ca.Function("step", [t, h, x, p], [ca.densify(new)])

    def finished(self, t: ca.MX, x: ca.MX, p: ca.MX) -> ca.MX:
        """The state, with what is done to it after every step."""
        if self._finish is None:
            return x
        done = self._finish.function(t, x[: self.state_size], p)
        return ca.vertcat(done, x[self.state_size :])


def graph_of(correction: ImplicitFunction | None) -> ca.Function | None:
    """The function of a correction, if there is one."""
    return None if correction is None else correction.function
