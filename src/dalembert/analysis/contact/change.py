"""Changes of contact phases: steps of zero length, with a jump of the speeds at impacts.

The instant ``t* = t + δ`` at which the guard reaches zero moves with the parameters, the times of
the steps do not. The old motion is continued to that instant, the speeds jump there, and the new
motion is followed back:

    x⁺ = φ⁺(−δ, J(φ⁻(δ, x))),      guard(φ⁻(δ, x)) = 0

In the run itself ``δ`` is zero but for rounding; the derivative is the saltation matrix (Aizerman
and Gantmacher 1958).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import casadi as ca

from dalembert.analysis.contact.state_jumps import Headings, Jump
from dalembert.analysis.dynamics.variant import Variant
from dalembert.integrators.base import Attempt
from dalembert.integrators.step import GraphStep
from dalembert.model.graph.contacts import branches_of
from dalembert.symbolic.equations.graph_function import GraphFunction
from dalembert.symbolic.equations.implicit import ImplicitFunction
from dalembert.symbolic.formulas.expression import Expression

CORRECTIONS = 2
"""Newton corrections of the instant: one for its first derivative, one for the second."""


class ContactChange(Variant):
    """A step of zero length between steps of two variants.

    Parameters
    ----------
    before, after : the variants
    guard : number of the guard of ``before`` that reaches zero; None where no instant moves
    state_maps : maps of the state: the jump of an impact, new slip directions
    struck : there is an impact
    closes : gaps that stop bouncing after an accumulation of impacts
    together : gaps that reach zero at the same time
    """

    moving = True

    def __init__(
        self,
        before: Variant,
        after: Variant,
        guard: int | None,
        state_maps: Sequence[Jump | Headings] = (),
        struck: bool = False,
        closes: frozenset[int] = frozenset(),
        together: tuple[int, ...] = (),
    ):
        strategies = before.formulation, before.stabilization, before.integrator
        super().__init__(before.view, before.rows, *strategies, before.phases, before.bare)
        self.before, self.after, self.guard = before, after, guard
        self.state_maps, self.struck = state_maps, struck
        self.closes, self.together = closes, together

    @cached_property
    def step(self) -> GraphStep:
        step, begin = self.before.step, self.after.step.begin
        t, h = ca.MX.sym("t"), ca.MX.sym("h")
        x, p = ca.MX.sym("x", step.size), ca.MX.sym("p", step.parameter_count)
        state = self._state_after(t, x[: step.state_size], p)
        memory = x[step.state_size :] if begin is None else begin.function(t, state, p)
        function = ca.Function("contact_change", [t, h, x, p], [ca.vertcat(state, memory)])
        return GraphStep(function, step.state_size, begin=begin)

    def _state_after(self, t: ca.MX, x: ca.MX, p: ca.MX) -> ca.MX:
        """The state after the change, without memory of the integrator."""
        delay, _, state = self.located(t, x, p)
        if self.guard is not None:
            state = flow(self.after, t + delay, state, p, -delay)
        return state

    def located(self, t: ca.MX, x: ca.MX, p: ca.MX) -> tuple[ca.MX, ca.MX, ca.MX]:
        """``δ``, and the states before and after the jump at ``t + δ``."""
        state, delay = x, ca.MX(0)
        if self.guard is not None:
            for _ in range(CORRECTIONS):
                values, rates = self._guards(t + delay, state, p)
                delay += delay_to_zero(values[self.guard], rates[self.guard])
                state = flow(self.before, t, x, p, delay)
        before = state
        for state_map in self.state_maps:
            state = state_map.function.call([t + delay, state, p])[0]
        return delay, before, state

    @cached_property
    def instant(self) -> GraphFunction:
        """``(t, x, p) → δ`` to first order, with the derivative of the instant."""
        assert self.guard is not None
        t, x, p = self.rate.inputs
        values, rates = self._guards(t, x, p)
        delay = delay_to_zero(values[self.guard], rates[self.guard])
        return GraphFunction(ca.Function("instant", [t, x, p], [delay]))

    @property
    def _guards(self) -> ca.Function:
        assert self.before.guards is not None
        return self.before.guards.function

    @cached_property
    def pace(self) -> ca.Function:
        """``(t, x, p)`` → speed at which the guard reaches zero, in natural units."""
        e = self.before.equations
        t, x, p = self.rate.inputs
        if self.guard is None or self.before.guards is None:
            return ca.Function("pace", [t, x, p], [ca.SX(1)])
        _, rates = self._guards(t, x, p)
        size = self.before.guards.watched[self.guard].size
        return ca.Function("pace", [t, x, p], [rates[self.guard] * e.scales.time / size])

    @property
    def turns(self) -> bool:
        """Whether the branch of a distance changes, and with it the direction of its force."""
        return branches_of(self.before.phases) != branches_of(self.after.phases)

    @property
    def left_branches(self) -> list[int]:
        """Closed gaps that leave the branch of their distance."""
        pairs = zip(branches_of(self.before.phases), branches_of(self.after.phases), strict=True)
        return [k for k, (before, after) in enumerate(pairs) if before and before != after]

    @property
    def gap(self) -> int | None:
        """The gap whose guard reaches zero, None where no instant moves."""
        if self.guard is None or self.before.guards is None:
            return None
        return self.before.guards.watched[self.guard].gap

    # the state before the change belongs to the motion before it
    def measured(self, measure: Expression) -> ImplicitFunction:  # type: ignore[override]
        return self.before.measured(measure)

    @cached_property
    def bodies(self) -> ca.Function:
        return self.before.bodies

    @property
    def attempt(self) -> Attempt | None:
        return self.before.attempt


def delay_to_zero(value: Any, rate: Any) -> Any:
    """``−g/ġ``, time to the zero of a function; zero where the motion only grazes it."""
    grazed = rate == 0
    return ca.if_else(grazed, 0, -value / ca.if_else(grazed, 1, rate))


def flow(variant: Variant, t: ca.MX, x: ca.MX, p: ca.MX, length: ca.MX) -> ca.MX:
    """The motion after ``length``, of second order (explicit midpoint rule)."""
    rate = variant.rate.function
    middle = x + length / 2 * rate(t, x, p)
    return x + length * rate(t + length / 2, middle, p)
