"""Both sides of a change of forces or contacts, at its own instant.

The instant ``t + δ(t, x, p)`` of a change moves with the parameters, the times of the steps do not.
A measure before it is ``m⁻(t + δ, φ⁻(δ, x))``, after it ``m⁺(t + δ, J(φ⁻(δ, x)))``, with the state
``x`` at the end of the step before the change. In the run itself ``δ`` is zero but for rounding.
"""

from __future__ import annotations

from functools import cached_property

import casadi as ca

from dalembert.analysis.contact.change import ContactChange
from dalembert.analysis.dynamics.transition import Transition
from dalembert.analysis.dynamics.variant import Variant
from dalembert.integrators.step import Step
from dalembert.symbolic.formulas.expression import Expression
from dalembert.symbolic.once import once

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
    def place(self) -> ca.Function:
        """``(t, x, p) → δ, x`` on this side of the change."""
        size = self.change.step.state_size
        t, x = ca.MX.sym("t"), ca.MX.sym("x", size)
        p = ca.MX.sym("p", self.change.step.parameter_count)
        delay, before, after = self.change.located(t, x, p)
        state = after if self.after else before
        return ca.Function("place", [t, x, p], [ca.densify(delay), ca.densify(state)])

    @once
    def measured(self, measure: Expression) -> MovingMeasure:  # type: ignore[override]
        return MovingMeasure(self._at_change(self.variant_at_side.measured(measure).function))

    @cached_property
    def bodies(self) -> ca.Function:
        return self._at_change(self.variant_at_side.held_bodies)

    def _at_change(self, function: ca.Function) -> ca.Function:
        """A ``(t, x, p)`` function on this side as a function of the state before the change."""
        t, x, p = (ca.MX.sym(*s) for s in zip("txp", self._sizes, strict=True))
        delay, state = self.place(t, x, p)
        return ca.Function("there", [t, x, p], function.call([t + delay, state, p]))

    @property
    def _sizes(self) -> tuple[int, int, int]:
        return 1, self.change.step.state_size, self.change.step.parameter_count


class MovingMeasure:
    """A function ``(t, x, p) → m`` with its tangent and adjoint functions."""

    def __init__(self, function: ca.Function):
        self.function = function

    @cached_property
    def tangent(self) -> ca.Function:
        """``(t, x, p, ṫ, ẋ, ṗ) → ṁ``."""
        inputs, rates = self._symbols(""), self._symbols("d")
        rate = self.function.forward(1)(*inputs, self.function(*inputs), *rates)
        return ca.Function("tangent", [*inputs, *rates], [ca.densify(rate)])

    @cached_property
    def adjoint(self) -> ca.Function:
        """``(t, x, p, m̄) → t̄, x̄, p̄``."""
        inputs, weight = self._symbols(""), ca.MX.sym("w")
        weights = self.function.reverse(1)(*inputs, self.function(*inputs), weight)
        return ca.Function("adjoint", [*inputs, weight], [ca.densify(part) for part in weights])

    def tangents(self, count: int) -> ca.Function:
        """``(t, x, p, dx, dp) → dm`` in ``count`` columns."""
        inputs = self._symbols("")
        _, x, p = inputs
        dx, dp = (ca.MX.sym(f"d{i}", s.numel(), count) for i, s in enumerate((x, p)))
        forward = self.function.forward(count)
        changes = forward(*inputs, self.function(*inputs), ca.MX(1, count), dx, dp)
        return ca.Function("tangents", [*inputs, dx, dp], [ca.densify(changes)])

    def _symbols(self, prefix: str) -> list[ca.MX]:
        return [ca.MX.sym(prefix + n, self.function.numel_in(i)) for i, n in enumerate("txp")]
