"""Steps and their derivatives in the order of the arguments of marches.

A march carries a column through many steps: the state forwards, its changes forwards along with the
recorded states, or its weights backwards.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import casadi as ca

from dalembert.integrators.prepared_step import PreparedStep, StepForms
from dalembert.integrators.step import Step
from dalembert.symbolic.evaluation.columns import LONG, instructions
from dalembert.symbolic.evaluation.kernel import Kernel
from dalembert.symbolic.evaluation.lane_tangents import LinearStep
from dalembert.symbolic.evaluation.prelude import Prelude, before
from dalembert.symbolic.once import CacheOwner, once


class MarchedStep(CacheOwner):
    """A step in a march that corrects every step, or only some.

    A flag selects the step with or without correction, and only one of them is evaluated. The flag
    is ignored if all steps are corrected, or none.

    Parameters
    ----------
    step : Step
    period : the correction follows every ``period``-th step

    Attributes
    ----------
    branches : whether only some of the steps are corrected
    at_once : whether equal steps are taken as chunks
    """

    def __init__(self, step: Step, period: int):
        self.step = step
        self.branches = period != 1 and step.corrects
        self.at_once = step.chunked and not self.branches

    @cached_property
    def forms(self) -> StepForms:
        """``(x, t, h, flag, q) → x``."""
        if not self.branches:
            f = self.step.prepared.forms
            called, lanes = (form and _in_order(form) for form in (f.called, f.lanes))
            return StepForms(f.values, _in_order(f.function), called, lanes)
        call = self._selected(lambda step: step.function, lambda prepared: prepared.forms.function)
        x, p = ca.MX.sym("x", self.step.size), ca.MX.sym("p", self.step.parameter_count)
        t, h, flag = _times()
        single = ca.Function("single", [x, t, h, flag, p], [call(flag, t, h, x, p)])
        return StepForms(*before(single, 4))

    @property
    def prelude(self) -> Prelude:
        """Terms of the derivatives that depend on parameters alone; two variants share none."""
        if self.branches:
            return Prelude.identity(self.step.parameter_count)
        return self.step.prepared.prelude

    @once
    def tangents(self, count: int) -> ca.Function:
        """``(dx, t, h, flag, x, q, dq) → dx`` for ``count`` columns."""
        call = self._selected(lambda s: s.tangents(count), lambda s: s.tangents(count))
        size, prelude = self.step.size, self.prelude
        dx, dq = ca.MX.sym("dx", size, count), ca.MX.sym("dq", prelude.rate_count, count)
        x, q = ca.MX.sym("x", size), ca.MX.sym("q", prelude.value_count)
        t, h, flag = _times()
        following = ca.densify(call(flag, t, h, x, q, dx, dq))
        return ca.Function("forward_step", [dx, t, h, flag, x, q, dq], [following])

    @once
    def adjoint(self, compiled: bool) -> ca.Function:
        """``([x̄; q̄], t, h, flag, x, injected weights, q) → [x̄; q̄]``.

        ``compiled`` selects the form that is fastest as machine code.
        """

        def form(step: PreparedStep) -> ca.Function:
            return step.compiled_adjoint if compiled else step.adjoint

        call, n, prelude = self._selected(lambda s: s.adjoint, form), self.step.size, self.prelude
        carried = ca.MX.sym("c", n + prelude.rate_count)
        q = ca.MX.sym("q", prelude.value_count)
        x, inject = ca.MX.sym("x", n), ca.MX.sym("i", n)
        t, h, flag = _times()
        x_bar, q_bar = call(flag, t, h, x, q, carried[:n])
        following = ca.vertcat(x_bar + inject, carried[n:] + q_bar)
        return ca.Function("backward_step", [carried, t, h, flag, x, inject, q], [following])

    @cached_property
    def second(self) -> ca.Function:
        """``([x̄; d x̄; d p̄], t, h, flag, x, dx, injected pairs, p, dp) → [x̄; d x̄; d p̄]``."""
        n, m = self.step.size, self.step.parameter_count
        call = self._selected(lambda s: s.second, lambda _: self.step.second)
        symbolic = self.step.second.is_a("SXFunction") and not self.branches
        kind: Any = ca.SX if symbolic else ca.MX
        sizes = {"c": 2 * n + m, "x": n, "dx": n, "i": 2 * n, "p": m, "dp": m}
        c, x, dx, inject, p, dp = (kind.sym(s, k) for s, k in sizes.items())
        t, h, flag = _times(kind)
        x_bar, change, more = call(flag, t, h, x, p, c[:n], dx, dp, c[n : 2 * n])
        following = ca.vertcat(ca.vertcat(x_bar, change) + inject, c[2 * n :] + more)
        return ca.Function("back", [c, t, h, flag, x, dx, inject, p, dp], [following])

    @property
    def linear(self) -> LinearStep | None:
        """``tangents`` in two parts for SIMD lanes; None if not available."""
        return None if self.branches else self.step.prepared.linear

    @once
    def stacked_tangents(self, count: int) -> ca.Function:
        """``(dx, t, h, flag, x, [q; dq]) → dx`` with stacked directions, from ``linear``."""
        linear, prelude, n = self.linear, self.prelude, self.step.size
        assert linear is not None
        m, r = prelude.value_count, prelude.rate_count
        sizes = {"dx": n * count, "x": n, "q": m + r * count}
        dx, x, q = (ca.MX.sym(name, size) for name, size in sizes.items())
        t, h, flag = _times()
        entries = linear.entries(t, h, x, q[:m])
        changes = [
            linear.along(dx[k * n : (k + 1) * n], entries, q[m + k * r : m + (k + 1) * r])
            for k in range(count)
        ]
        function = ca.Function("forward_steps", [dx, t, h, flag, x, q], [ca.vertcat(*changes)])
        if instructions(function) > LONG:
            return function
        scalar = function.expand()
        return function if scalar.n_instructions() > LONG else scalar

    @once
    def chunk(self, count: int) -> Kernel:
        """``(x, t, h, flag, p) → states`` after each of ``count`` equal steps."""
        return Kernel(self.step.chunk(count).function)

    @once
    def chunk_tangents(self, count: int, columns: int) -> Kernel:
        """``(dx, t, h, flag, x, p, dp) → changes`` after each of ``count`` equal steps."""
        return Kernel(self.step.chunk(count).tangents(columns))

    @once
    def chunk_adjoint(self, count: int) -> Kernel:
        """``([x̄; p̄], t, h, flag, x, injected weights, p) → [x̄; p̄]`` through equal steps."""
        return Kernel(self.step.chunk(count).adjoint)

    def _selected(
        self,
        whole: Callable[[Step], ca.Function],
        prepared: Callable[[PreparedStep], ca.Function],
    ) -> Callable[..., Any]:
        """``(flag, …)`` function of the step or of its derivative."""
        if self.branches:
            return ca.Function.if_else("branch", whole(self.step), whole(self.step.plain))
        function = prepared(self.step.prepared)
        return lambda flag, *arguments: function(*arguments)


def _times(kind: Any = ca.MX) -> list[Any]:
    """Symbols of time, length and flag."""
    return [kind.sym(name) for name in ("t", "h", "flag")]


def _in_order(step: ca.Function) -> ca.Function:
    """The step with the argument order of a march, for periods that need no flag."""
    kind: Any = ca.SX if step.is_a("SXFunction") else ca.MX
    t, h, x, q = (kind.sym(name, step.numel_in(i)) for i, name in enumerate("thxq"))
    flag = kind.sym("flag")
    return ca.Function("single", [x, t, h, flag, q], [step(t, h, x, q)])
