"""Transitions at switching functions, and both sides of changes of forces or contacts.

The instant ``t*`` of ``g(t*, x, p) = 0`` moves with the parameters, the times of the steps do not.
A change of it by ``δt`` extends the old branch of the motion by ``δt`` and shortens the new one:

    x⁺ = x + (ẋ⁻ − ẋ⁺) δt,      δt = −g/ġ,      ġ = ∂g/∂t + (∂g/∂x) ẋ⁻

(Aizerman and Gantmacher 1958). In the run itself ``δt`` is zero but for rounding. With the state
``x`` at the end of the step before the change, a measure before the change is ``m⁻(t + δ, φ⁻(δ,
x))``, and after it ``m⁺(t + δ, J(φ⁻(δ, x)))``.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np

from dalembert.analysis.contact.change import ContactChange, delay_to_zero
from dalembert.analysis.dynamics.variant import Variant
from dalembert.formulations.base import state_sizes, state_symbols
from dalembert.integrators.base import Attempt
from dalembert.integrators.marching.steps import Crossing
from dalembert.integrators.step import GraphStep, Step
from dalembert.model.graph.equations import Equations
from dalembert.symbolic.equations.graph_function import GraphFunction
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once

SURFACE = 1e-13
"""Rounding of a switching function, relative to the state and its natural sizes."""
SIMULTANEOUS = 1e-13
"""Difference of times, relative to the run, below which events are simultaneous."""


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
            memory = memory if step.begin is None else step.begin.function(t, turned, p)
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
        return ca.Function("delay", [e.t, x, e.p, rate], [delay_to_zero(g, change)])

    @cached_property
    def instant(self) -> GraphFunction:
        """``(t, x, p) → δt`` with the derivative of the instant."""
        t, x, p = self.variant.rate.inputs
        rate = self.variant.rate.function(t, x, p)
        return GraphFunction(ca.Function("instant", [t, x, p], [self.delay(t, x, p, rate)]))

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


Change = Transition | ContactChange


class MovingSide(Variant):
    """The motion just before or just after a change as a function of the state before it.

    Parameters
    ----------
    change : a step of zero length
    after : the side after the change
    """

    def __init__(self, change: Change, after: bool):
        before = change.before if isinstance(change, ContactChange) else change.variant
        behind = change.after if isinstance(change, ContactChange) else change.variant
        self.change, self.variant_at_side = change, behind if after else before
        strategies = before.formulation, before.stabilization, before.integrator
        super().__init__(before.view, before.rows, *strategies, before.phases)
        self.after = after

    @property
    def step(self) -> Step:  # type: ignore[override]
        return self.change.step

    @cached_property
    def location(self) -> ca.Function:
        """``(t, x, p) → δ, x`` on this side of the change."""
        size = self.change.step.state_size
        t, x = ca.MX.sym("t"), ca.MX.sym("x", size)
        p = ca.MX.sym("p", self.change.step.parameter_count)
        delay, before, after = self.change.located(t, x, p)
        state = after if self.after else before
        return ca.Function("location", [t, x, p], [ca.densify(delay), ca.densify(state)])

    @once
    def measured(self, measure: Expression) -> GraphFunction:  # type: ignore[override]
        return GraphFunction(self._at_change(self.variant_at_side.measured(measure).function))

    @cached_property
    def bodies(self) -> ca.Function:
        return self._at_change(self.variant_at_side.held_bodies)

    def _at_change(self, function: ca.Function) -> ca.Function:
        """A ``(t, x, p)`` function on this side as a function of the state before the change."""
        t, x, p = (ca.MX.sym(*s) for s in zip("txp", self._sizes, strict=True))
        delay, state = self.location(t, x, p)
        return ca.Function("at_change", [t, x, p], function.call([t + delay, state, p]))

    @property
    def _sizes(self) -> tuple[int, int, int]:
        return 1, self.change.step.state_size, self.change.step.parameter_count


class StepReplacement:
    """First part of a step, then transitions, each an entry with its end state."""

    def __init__(self, time: float, x: np.ndarray):
        self.time, self.x = time, x
        self.entries: list[tuple[float, float, np.ndarray, int]] = []

    def add(self, length: float, x: np.ndarray, mode: int) -> None:
        self.entries.append((self.time, length, x, mode))
        self.time, self.x = self.time + length, x

    def crossing(self, accepted: int, following: float, reason: str) -> Crossing:
        t, h, columns, modes = zip(*self.entries, strict=True)
        x = np.column_stack(columns)
        return Crossing(accepted, np.array(t), np.array(h), x, np.array(modes), following, reason)
