"""Transitions of switching functions, steps of zero length.

The instant ``t*`` of ``g(t*, x, p) = 0`` moves with the parameters, the times of the steps do not.
A change of it by ``δt`` extends the old branch of the motion by ``δt`` and shortens the new one:

    x⁺ = x + (ẋ⁻ − ẋ⁺) δt,      δt = −g/ġ,      ġ = ∂g/∂t + (∂g/∂x) ẋ⁻

(Aizerman and Gantmacher 1958). In the run itself ``δt`` is zero but for rounding.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.analysis.dynamics.variant import Variant
from dalembert.formulations.base import state_sizes, state_symbols
from dalembert.integrators.base import Attempt
from dalembert.integrators.step import GraphStep
from dalembert.model.equations import Equations

SURFACE = 1e-13
"""Rounding of a switching function, relative to the state and its natural sizes."""


class Transition(Variant):
    """Sign change of a switching function: a step of zero length between steps of a variant.

    Parameters
    ----------
    variant : Variant of the steps before and after
    number : number of the switch
    moving : forces change at the switch; otherwise only the stored sign
    """

    def __init__(self, variant: Variant, number: int, moving: bool):
        strategies = variant.formulation, variant.stabilization, variant.integrator
        super().__init__(variant.view, variant.rows, *strategies, variant.phases)
        self.variant, self.number, self.moving = variant, number, moving

    @cached_property
    def step(self) -> GraphStep:
        step = self.variant.step
        t, h = ca.MX.sym("t"), ca.MX.sym("h")
        x, p = ca.MX.sym("x", step.size), ca.MX.sym("p", step.parameter_count)
        state, memory = x[: step.state_size], x[step.state_size :]
        turned, memory = self._turned(state), x[step.state_size :]
        if self.moving:
            rate = self.variant.rate.function
            before, after = rate(t, state, p), rate(t, turned, p)
            turned += (before - after) * self.delay(t, state, p, before)
            memory = step.begin(t, turned, p) if step.begin is not None else memory
        function = ca.Function("transition", [t, h, x, p], [ca.vertcat(turned, memory)])
        return GraphStep(function, step.state_size, begin=step.begin)

    def _turned(self, x: ca.MX) -> ca.MX:
        """The state on the other side of the switch."""
        entry = self.variant.step.state_size - self.variant.equations.switches.count + self.number
        return ca.vertcat(x[:entry], x[entry] < 0.5, x[entry + 1 :])

    def located(self, t: ca.MX, x: ca.MX, p: ca.MX) -> tuple[ca.MX, ca.MX, ca.MX]:
        """``δ``, and the states before and after the switch at ``t + δ``."""
        if not self.moving:
            return ca.MX(0), x, self._turned(x)
        rate = self.variant.rate.function(t, x, p)
        delay = self.delay(t, x, p, rate)
        state = x + rate * delay
        return delay, state, self._turned(state)

    @cached_property
    def delay(self) -> ca.Function:
        """``(t, x, p, ẋ) → δt``; zero where the motion only grazes the switch."""
        e = self.variant.equations
        x, rate = state_symbols(e), ca.SX.sym("rate", state_symbols(e).numel())
        g = e.switches.functions[self.number]
        change = ca.jtimes(g, ca.vertcat(e.t, x), ca.vertcat(1, rate))
        grazed = change == 0
        delay = ca.if_else(grazed, 0, -g / ca.if_else(grazed, 1, change))
        return ca.Function("delay", [e.t, x, e.p, rate], [delay])

    @cached_property
    def instant(self) -> ca.Function:
        """``(t, x, p) → δt`` with the derivative of the instant."""
        t, x, p = self.variant.rate.inputs
        rate = self.variant.rate.function(t, x, p)
        return ca.Function("instant", [t, x, p], [self.delay(t, x, p, rate)])

    @cached_property
    def pace(self) -> ca.Function:
        """``(t, x, p)`` → speed at which the switch is crossed, in natural units."""
        e, x = self.variant.equations, state_symbols(self.variant.equations)
        g, sizes = e.switches.functions[self.number], state_sizes(e)
        rate = self.variant.rate.function(e.t, x, e.p)
        change = ca.jtimes(g, ca.vertcat(e.t, x), ca.vertcat(1, rate))
        slopes = ca.fabs(ca.jacobian(g, ca.vertcat(e.t, x)))
        largest = ca.mtimes(slopes, ca.vertcat(e.scales.time, sizes))
        return ca.Function("pace", [e.t, x, e.p], [change * e.scales.time / largest])

    @property
    def bodies(self) -> ca.Function:  # type: ignore[override]
        """Function of the state before the switch, with the stored sign."""
        return self.held_bodies

    @property
    def attempt(self) -> Attempt | None:
        return self.variant.attempt


def distances(e: Equations) -> ca.Function:
    """``(t, x, p)`` → distance to each switch, negative beyond it."""
    inside = (2 * e.switches.sides - 1) * e.switches.functions
    return ca.Function("distances", [e.t, state_symbols(e), e.p], [ca.densify(inside)])


def crossed(e: Equations) -> ca.Function:
    """``(t, x, p)`` → distance of a state beyond each switch, less rounding."""
    x, g = state_symbols(e), e.switches.functions
    slopes = ca.fabs(ca.jacobian(g, ca.vertcat(e.t, x)))
    near = SURFACE * ca.mtimes(slopes, ca.vertcat(0, state_sizes(e)) + ca.fabs(ca.vertcat(e.t, x)))
    beyond = (1 - 2 * e.switches.sides) * g - near
    return ca.Function("crossed", [e.t, x, e.p], [ca.densify(beyond)], {"cse": True})
